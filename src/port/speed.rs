//! The standard speeds, which are the only ones that can be asked for in the same way everywhere.

use core::ffi::c_ulong;

/// The system's name of a speed in baud; `None` when it has none.
pub(super) const fn of(baud: c_ulong) -> Option<libc::speed_t> {
    Some(match baud {
        1200 => libc::B1200,
        2400 => libc::B2400,
        4800 => libc::B4800,
        9600 => libc::B9600,
        19_200 => libc::B19200,
        38_400 => libc::B38400,
        57_600 => libc::B57600,
        115_200 => libc::B115200,
        230_400 => libc::B230400,
        #[cfg(any(target_os = "linux", target_os = "android"))]
        _ => return faster(baud),
        #[cfg(not(any(target_os = "linux", target_os = "android")))]
        _ => return None,
    })
}

#[cfg(any(target_os = "linux", target_os = "android"))]
const fn faster(baud: c_ulong) -> Option<libc::speed_t> {
    Some(match baud {
        460_800 => libc::B460800,
        500_000 => libc::B500000,
        576_000 => libc::B576000,
        921_600 => libc::B921600,
        1_000_000 => libc::B1000000,
        1_152_000 => libc::B1152000,
        1_500_000 => libc::B1500000,
        2_000_000 => libc::B2000000,
        2_500_000 => libc::B2500000,
        3_000_000 => libc::B3000000,
        3_500_000 => libc::B3500000,
        4_000_000 => libc::B4000000,
        _ => return None,
    })
}
