//! Fuzz input, read as a sequence of choices. At its end every choice is 0 and every slice empty.

use std::ffi::c_int;

use deltarobot::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

use crate::contract::frame;

pub struct Input<'a>(pub &'a [u8]);

impl<'a> Input<'a> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        self.slice(1).first().copied().unwrap_or_default()
    }

    pub fn slice(&mut self, length: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(length.min(self.0.len()));
        self.0 = rest;
        taken
    }

    pub fn bytes<const N: usize>(&mut self) -> [u8; N] {
        [(); N].map(|()| self.byte())
    }

    /// Any int, with a liking for those at the edge of a range.
    pub fn int(&mut self) -> c_int {
        let edge = match self.byte() % 8 {
            0 => 0,
            1 => DP_BUFSIZE as c_int,
            2 => DP_DATA_MAX_SIZE as c_int,
            3 => c_int::MAX,
            4 => c_int::MIN,
            5 => return c_int::from(self.byte()) % (DP_BUFSIZE as c_int + 1),
            6 => return c_int::from(self.byte()) % (DP_DATA_MAX_SIZE as c_int + 1),
            _ => {
                let mut raw = [0; 4];
                raw.fill_with(|| self.byte());
                return c_int::from_le_bytes(raw);
            }
        };
        edge.wrapping_add(c_int::from(self.byte() as i8 % 3))
    }

    /// Bytes as they may come from a line: raw ones, whole frames, and frames with something wrong.
    pub fn line(&mut self) -> Vec<u8> {
        let mut line = Vec::new();
        for _ in 0..self.byte() % 8 {
            let kind = self.byte();
            let count = usize::from(self.byte());
            match kind % 4 {
                0 => line.extend(self.slice(count)),
                // More bytes than the input has, so that a ring overflows without a long input.
                1 => {
                    let pattern = self.slice(usize::from(kind >> 4) + 1);
                    line.extend(pattern.iter().cycle().take(if pattern.is_empty() { 0 } else { count * 2 }));
                }
                wrong => {
                    let opcode = b"ANHMSChsme"[usize::from(kind >> 4) % 10];
                    let start = line.len();
                    line.extend(frame(opcode, self.slice(count % (DP_DATA_MAX_SIZE + 1))));
                    if wrong == 3 {
                        let size = line.len() - start;
                        let at = start + usize::from(self.byte()) % size;
                        match self.byte() {
                            0 => drop(line.remove(at)),
                            byte => line[at] ^= byte,
                        }
                    }
                }
            }
        }
        line
    }
}
