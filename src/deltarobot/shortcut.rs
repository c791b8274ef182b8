//! Short ways for what happens most, on hosts: bytes that come one by one, frames that lie in one piece. Each does what the
//! long way in `ring.rs` would have done, or declines and changes nothing.

use super::Opcode;
use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Frame, Payload};
use super::ring::{NoFrame, Ring, int, wrap};
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// What the length byte of a frame has to be below, by opcode: 0 for bytes that are none.
static LIMITS: [u16; 256] = {
    let mut limits = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        if Opcode(byte as u8).is_known() {
            limits[byte] = DP_DATA_MAX_SIZE as u16 + 1;
        }
        byte += 1;
    }
    limits
};

impl Ring {
    /// Adds a byte, if there is room for it.
    #[inline(always)]
    pub(crate) fn push(&mut self, byte: u8) -> bool {
        let start = self.start.cast_unsigned() as usize;
        let used = self.used.cast_unsigned() as usize;
        if start < DP_BUFSIZE
            && used < DP_BUFSIZE
            && let Some(place) = self.bytes.get_mut(wrap(start.wrapping_add(used)))
        {
            *place = byte;
            self.used = self.used.wrapping_add(1);
            true
        } else {
            false
        }
    }

    /// Finds that a frame is waited for, or takes a small frame.
    #[inline(always)]
    pub(crate) fn shortcut(&mut self) -> Option<Result<Frame<'_>, NoFrame>> {
        let start = self.start.cast_unsigned() as usize;
        let used = self.used.cast_unsigned() as usize;
        if start > const { DP_BUFSIZE.wrapping_sub(FRAME_HEAD) } {
            return None;
        }
        let unread = self.bytes.get(start..)?;
        let &[first, opcode, length] = unread.first_chunk()?;
        if first != FRAME_START {
            if used != 1 {
                return None;
            }
            (self.start, self.used) = (int(wrap(start.wrapping_add(1))), 0);
            return Some(Err(NoFrame::Garbage));
        }
        let limit = usize::from(*LIMITS.get(usize::from(opcode))?);
        let payload = usize::from(length);
        if payload >= limit {
            return (used == 1 || used == 2 && limit != 0).then_some(Err(NoFrame::Waiting));
        }
        // In one comparison: the head is there, the frame is not.
        if used.wrapping_sub(FRAME_HEAD) < payload.wrapping_add(FRAME_OVERHEAD.wrapping_sub(FRAME_HEAD)) {
            return Some(Err(NoFrame::Waiting));
        }
        let size = payload.wrapping_add(FRAME_OVERHEAD);
        if payload <= 3
            && let Some(window) = unread.first_chunk::<8>()
            && used.wrapping_sub(size) <= DP_BUFSIZE.wrapping_sub(size)
        {
            let (body, behind) = window.split_at_checked(payload.wrapping_add(FRAME_HEAD))?;
            let mut sum = FRAME_END;
            for byte in body {
                sum = sum.wrapping_add(*byte);
            }
            if *behind.first_chunk()? == [sum, FRAME_END] {
                (self.start, self.used) = (int(wrap(start.wrapping_add(size))), int(used.wrapping_sub(size)));
                let payload = Payload { ring: &self.bytes, begin: start.wrapping_add(FRAME_HEAD), length: payload };
                return Some(Ok(Frame { opcode: Opcode(opcode), payload }));
            }
        }
        (used == 1 || used == 2).then_some(Err(NoFrame::Waiting))
    }
}
