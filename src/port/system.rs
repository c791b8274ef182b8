//! The system's functions for a terminal device, made safe. An error is its number, `errno`.

use core::ffi::{CStr, c_char, c_int, c_short};
use core::mem::MaybeUninit;

/// The number of an error.
pub(super) type Errno = c_int;

/// An opened file.
pub(super) type Descriptor = c_int;

/// How a terminal device is set.
pub(super) use terminal::Settings;

/// Opens a device for both directions. It does not wait for a carrier, and does not become the terminal that controls
/// this program; programs started by this one don't inherit it.
pub(super) fn open(device: &CStr) -> Result<Descriptor, Errno> {
    loop {
        // SAFETY: the name is a string.
        let fd =
            unsafe { libc::open(device.as_ptr(), libc::O_RDWR | libc::O_NOCTTY | libc::O_NONBLOCK | libc::O_CLOEXEC) };
        match success(fd) {
            Err(libc::EINTR) => (),
            result => return result,
        }
    }
}

pub(super) fn close(fd: Descriptor) {
    // SAFETY: no memory is touched.
    unsafe { libc::close(fd) };
}

/// Keeps others away: by a lock, and where that is possible also those who don't ask for locks, unless they are root.
pub(super) fn claim(fd: Descriptor) -> Result<(), Errno> {
    // SAFETY: no memory is touched.
    success(unsafe { libc::flock(fd, libc::LOCK_EX | libc::LOCK_NB) })?;
    // A pseudo-terminal would stay closed to others if this program were killed, for as long as its other end is open.
    if has_modem_lines(fd) {
        // SAFETY: this request takes no argument.
        unsafe { libc::ioctl(fd, libc::TIOCEXCL) };
    }
    Ok(())
}

/// Whether it is more than a pseudo-terminal.
fn has_modem_lines(fd: Descriptor) -> bool {
    let mut lines: c_int = 0;
    // SAFETY: the argument of this request is an int.
    success(unsafe { libc::ioctl(fd, libc::TIOCMGET, &raw mut lines) }).is_ok()
}

/// Lets others in: also where the device stays opened by another descriptor, or the file by a child process.
pub(super) fn release(fd: Descriptor) {
    // SAFETY: these take no memory.
    unsafe {
        libc::ioctl(fd, libc::TIOCNXCL);
        libc::flock(fd, libc::LOCK_UN);
    }
}

/// Changes settings to 8 data bits, no parity, one stop bit, no flow control, no regard for the modem's lines, and
/// bytes passed on as they are. A read ends with the first byte.
pub(super) fn make_raw(settings: &mut Settings, speed: libc::speed_t) {
    settings.c_iflag &= !(libc::IGNBRK | libc::BRKINT | libc::PARMRK | libc::ISTRIP | libc::INPCK);
    settings.c_iflag &= !(libc::INLCR | libc::IGNCR | libc::ICRNL | libc::IXON | libc::IXOFF | libc::IXANY);
    settings.c_oflag &= !libc::OPOST;
    settings.c_lflag &= !(libc::ECHO | libc::ECHONL | libc::ICANON | libc::ISIG | libc::IEXTEN);
    settings.c_cflag &= !(libc::CSIZE | libc::PARENB | libc::CSTOPB | libc::CRTSCTS);
    settings.c_cflag |= libc::CS8 | libc::CLOCAL | libc::CREAD;
    for (place, value) in [(libc::VMIN, 1), (libc::VTIME, 0)] {
        if let Some(place) = settings.c_cc.get_mut(place) {
            *place = value;
        }
    }
    terminal::set_speed(settings, speed);
}

/// Whether a device took the settings that it was asked to take: a call is successful when one of them was taken.
pub(super) fn are_alike(asked: &Settings, got: &Settings) -> bool {
    let lines = libc::CSIZE | libc::CSTOPB | libc::PARENB | libc::CRTSCTS;
    asked.c_cflag & lines == got.c_cflag & lines && terminal::speed(asked) == terminal::speed(got)
}

/// How a terminal is set: as Linux itself knows it. The C library's functions for speeds come in versions that mean
/// different numbers, and a static library can't choose between them.
#[cfg(all(
    any(target_os = "linux", target_os = "android"),
    not(any(target_arch = "powerpc", target_arch = "powerpc64"))
))]
mod terminal {
    use super::{Descriptor, Errno, MaybeUninit, success};

    pub(in super::super) type Settings = libc::termios2;

    pub(in super::super) fn settings(fd: Descriptor) -> Result<Settings, Errno> {
        let mut settings = MaybeUninit::<Settings>::uninit();
        // SAFETY: the argument of this request is memory of that type.
        success(unsafe { libc::ioctl(fd, libc::TCGETS2, settings.as_mut_ptr()) })?;
        // SAFETY: that was successful, so they were written.
        Ok(unsafe { settings.assume_init() })
    }

    pub(in super::super) fn apply(fd: Descriptor, settings: &Settings) -> Result<(), Errno> {
        // SAFETY: the argument of this request is settings.
        success(unsafe { libc::ioctl(fd, libc::TCSETS2, settings) }).map(drop)
    }

    pub(super) fn set_speed(settings: &mut Settings, speed: libc::speed_t) {
        // No speed for receiving is the same as for sending.
        settings.c_cflag = settings.c_cflag & !(libc::CBAUD | libc::CIBAUD) | speed;
    }

    pub(super) const fn speed(settings: &Settings) -> libc::speed_t {
        settings.c_cflag & libc::CBAUD
    }
}

/// How a terminal is set, in the words of POSIX.
#[cfg(not(all(
    any(target_os = "linux", target_os = "android"),
    not(any(target_arch = "powerpc", target_arch = "powerpc64"))
)))]
mod terminal {
    use super::{Descriptor, Errno, MaybeUninit, success};

    pub(in super::super) type Settings = libc::termios;

    pub(in super::super) fn settings(fd: Descriptor) -> Result<Settings, Errno> {
        let mut settings = MaybeUninit::uninit();
        // SAFETY: they are written to memory of that type.
        success(unsafe { libc::tcgetattr(fd, settings.as_mut_ptr()) })?;
        // SAFETY: that was successful, so they were written.
        Ok(unsafe { settings.assume_init() })
    }

    pub(in super::super) fn apply(fd: Descriptor, settings: &Settings) -> Result<(), Errno> {
        // SAFETY: the settings are initialised.
        success(unsafe { libc::tcsetattr(fd, libc::TCSANOW, settings) }).map(drop)
    }

    pub(super) fn set_speed(settings: &mut Settings, speed: libc::speed_t) {
        // SAFETY: the settings are initialised. These fail on speeds that are none of the system's; `speed` is one.
        unsafe {
            libc::cfsetispeed(settings, speed);
            libc::cfsetospeed(settings, speed);
        }
    }

    pub(super) fn speed(settings: &Settings) -> (libc::speed_t, libc::speed_t) {
        // SAFETY: the settings are initialised.
        unsafe { (libc::cfgetispeed(settings), libc::cfgetospeed(settings)) }
    }
}
pub(super) use terminal::{apply, settings};

/// Throws away what was received.
pub(super) fn discard(fd: Descriptor) -> Result<(), Errno> {
    // SAFETY: no memory is touched.
    success(unsafe { libc::tcflush(fd, libc::TCIFLUSH) }).map(drop)
}

/// Waits until all was sent.
pub(super) fn drain(fd: Descriptor) -> Result<(), Errno> {
    loop {
        // SAFETY: no memory is touched.
        match success(unsafe { libc::tcdrain(fd) }) {
            Err(libc::EINTR) => (),
            result => return result.map(drop),
        }
    }
}

/// Reads what is there.
pub(super) fn read(fd: Descriptor, out: &mut [MaybeUninit<u8>]) -> Result<&[u8], Errno> {
    // SAFETY: at most as many bytes are written as there is room for.
    let got = unsafe { libc::read(fd, out.as_mut_ptr().cast(), out.len()) };
    let got = usize::try_from(got).map_err(|_| errno())?;
    let got = out.get(..got).unwrap_or_default();
    // SAFETY: these were written.
    Ok(unsafe { core::slice::from_raw_parts(got.as_ptr().cast(), got.len()) })
}

/// Writes what there is room for, and tells how many bytes that were.
pub(super) fn write(fd: Descriptor, bytes: &[u8]) -> Result<usize, Errno> {
    // SAFETY: the bytes are initialised.
    let put = unsafe { libc::write(fd, bytes.as_ptr().cast(), bytes.len()) };
    usize::try_from(put).map_err(|_| errno())
}

/// Waits until reading (`POLLIN`) or writing (`POLLOUT`) is possible or the device is gone, at most so many
/// milliseconds, or for ever if negative. Returns what happened, 0 if nothing did.
pub(super) fn wait(fd: Descriptor, events: c_short, timeout_ms: c_int) -> Result<c_short, Errno> {
    let mut polled = libc::pollfd { fd, events, revents: 0 };
    // SAFETY: it is one.
    success(unsafe { libc::poll(&raw mut polled, 1, timeout_ms) })?;
    Ok(polled.revents)
}

/// Milliseconds of a clock that nobody sets.
#[allow(clippy::useless_conversion, reason = "time_t and long have 32 bits elsewhere")]
pub(super) fn now() -> i64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: it is written to memory of that type. It can't fail: every Unix has this clock.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
    i64::from(now.tv_sec).wrapping_mul(1000).wrapping_add(i64::from(now.tv_nsec) / 1_000_000)
}

/// The system's text for an error.
pub(super) fn text(error: Errno, out: &mut [u8]) -> &[u8] {
    // SAFETY: a string of at most that length is written.
    unsafe { libc::strerror_r(error, out.as_mut_ptr().cast::<c_char>(), out.len()) };
    out.split(|byte| *byte == 0).next().unwrap_or_default()
}

fn success(result: c_int) -> Result<c_int, Errno> {
    if result < 0 { Err(errno()) } else { Ok(result) }
}

fn errno() -> Errno {
    #[cfg(any(target_os = "android", target_os = "netbsd", target_os = "openbsd"))]
    use libc::__errno as location;
    #[cfg(not(any(
        target_vendor = "apple",
        target_os = "freebsd",
        target_os = "android",
        target_os = "netbsd",
        target_os = "openbsd"
    )))]
    use libc::__errno_location as location;
    #[cfg(any(target_vendor = "apple", target_os = "freebsd"))]
    use libc::__error as location;
    // SAFETY: it points to this thread's error number.
    unsafe { *location() }
}
