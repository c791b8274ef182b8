//! A buffer of fixed size that ends with a zero byte, as C's strings do.

use core::ffi::c_ulong;

/// Writes one part behind the other. What does not fit is left out.
pub(super) struct Text<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl<'a> Text<'a> {
    /// Writes behind the first `length` bytes, which stay.
    pub(super) const fn new(buffer: &'a mut [u8], length: usize) -> Self {
        Self { buffer, length }
    }

    pub(super) fn put(&mut self, part: &[u8]) {
        // The last place is the zero byte's.
        for byte in part {
            let Some([place, next, ..]) = self.buffer.get_mut(self.length..) else { return };
            *place = *byte;
            *next = 0;
            self.length = self.length.wrapping_add(1);
        }
    }

    pub(super) fn put_number(&mut self, number: c_ulong) {
        if let rest @ 1.. = number / 10 {
            self.put_number(rest);
        }
        if let Ok(digit) = u8::try_from(number % 10) {
            self.put(&[b'0'.wrapping_add(digit)]);
        }
    }

    pub(super) const fn length(&self) -> usize {
        self.length
    }
}

#[cfg(test)]
mod tests {
    use super::Text;
    use core::ffi::CStr;

    #[test]
    fn parts_stand_behind_each_other_and_what_does_not_fit_is_left_out() {
        let mut buffer = [0x7F; 12];
        let mut text = Text::new(&mut buffer, 0);
        text.put(b"at ");
        text.put_number(0);
        text.put(b", ");
        text.put_number(1_234_567);
        assert_eq!(text.length(), 11);
        assert_eq!(CStr::from_bytes_until_nul(&buffer), Ok(c"at 0, 12345"));
        let mut text = Text::new(&mut buffer, 4);
        text.put(b"!");
        assert_eq!(CStr::from_bytes_until_nul(&buffer), Ok(c"at 0!"));
        Text::new(&mut buffer, 99).put(b"!");
        assert_eq!(CStr::from_bytes_until_nul(&buffer), Ok(c"at 0!"));
    }
}
