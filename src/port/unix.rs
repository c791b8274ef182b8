//! Terminal devices of Unix, over libc.
#![allow(clippy::cast_sign_loss, reason = "libc gives some of ioctl's requests other types than ioctl takes")]

use core::ffi::{CStr, c_char, c_int, c_long, c_short, c_ulong};
use core::mem::MaybeUninit;

use super::{Cause, SerialSettings};

/// The system's number of an error.
pub(super) type Error = c_int;

/// The outputs besides the data: data terminal ready, and request to send.
pub(crate) use libc::{TIOCM_DTR as DTR, TIOCM_RTS as RTS};

/// Opens a device for both directions. It waits for no carrier, does not become this program's controlling terminal,
/// and is not inherited by programs that this one starts.
pub(super) fn open(device: &CStr, settings: &SerialSettings) -> Result<c_int, Cause> {
    let flags = libc::O_RDWR | libc::O_NOCTTY | libc::O_NONBLOCK | libc::O_CLOEXEC;
    // SAFETY: a `CStr` ends with a zero byte.
    let fd = retry(|| unsafe { libc::open(device.as_ptr(), flags) }).map_err(|error| match error {
        libc::EBUSY => Cause::InUse,
        // A directory or a running program, whatever may be wrong with it besides.
        libc::EISDIR | libc::ETXTBSY => Cause::NoSerialPort,
        _ => Cause::System(error),
    })?;
    set_up(fd, settings).inspect_err(|_| {
        // SAFETY: the descriptor was opened above, and nobody else knows it.
        unsafe { libc::close(fd) };
    })?;
    Ok(fd)
}

/// Claims a device, and only then changes it: another program may be using it.
fn set_up(fd: c_int, asked: &SerialSettings) -> Result<(), Cause> {
    let SerialSettings { baud, dtr, rts, keep_lines } = *asked;
    let mut settings = settings_of(fd).map_err(|error| match error {
        libc::ENOTTY | libc::EINVAL | libc::ENODEV | libc::EOPNOTSUPP => Cause::NoSerialPort,
        _ => cause_of(error),
    })?;
    // SAFETY: flock takes no pointer.
    success(unsafe { libc::flock(fd, libc::LOCK_EX | libc::LOCK_NB) })
        .map_err(|error| if error == libc::EWOULDBLOCK { Cause::InUse } else { cause_of(error) })?;
    let lines = lines(fd);
    if lines.is_ok() {
        // Not on a pseudo-terminal: were this program killed, it would stay closed to others for as long as its other
        // end is open. SAFETY: this request takes no argument.
        unsafe { libc::ioctl(fd, libc::TIOCEXCL as _) };
    }
    make_raw(&mut settings);
    if keep_lines != 0 {
        settings.c_cflag &= !libc::HUPCL;
    }
    let taken = terminal::set_speed(fd, &mut settings, baud).and_then(|()| settings_of(fd));
    match taken {
        // A call succeeds when one of the settings was taken.
        Ok(now) if settings.c_cflag & FRAMING == now.c_cflag & FRAMING && terminal::has_speed(&now, baud) => Ok(()),
        Ok(_) | Err(libc::EINVAL) => Err(Cause::NotTaken(baud)),
        Err(error) => Err(cause_of(error)),
    }
    .and_then(|()| match lines {
        // Both at once, as some boards take one of them alone for a reset.
        Ok(before) => set_lines(fd, with(with(before, DTR, dtr), RTS, rts), before),
        Err(_) => Ok(()),
    })
    .and_then(|()| discard(fd))
    .inspect_err(|_| release(fd))
}

/// Sends what was written, and closes a device.
pub(super) fn close(fd: c_int) {
    release(fd);
    // SAFETY: close takes no pointer; the port forgets the descriptor.
    unsafe { libc::close(fd) };
}

/// Lets others in, even where a child process has the file open too.
fn release(fd: c_int) {
    // SAFETY: these take no pointer.
    unsafe {
        libc::ioctl(fd, libc::TIOCNXCL as _);
        libc::flock(fd, libc::LOCK_UN);
    }
}

/// How a terminal is set.
fn settings_of(fd: c_int) -> Result<terminal::Settings, Error> {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: there is room for the settings.
    success(unsafe { terminal::get(fd, settings.as_mut_ptr()) })?;
    // SAFETY: it succeeded, so it has written them.
    Ok(unsafe { settings.assume_init() })
}

/// Sets everything but the speed. A read ends with the first byte.
fn make_raw(settings: &mut terminal::Settings) {
    settings.c_iflag &= !(libc::IGNBRK | libc::BRKINT | libc::PARMRK | libc::ISTRIP | libc::INPCK);
    settings.c_iflag &= !(libc::INLCR | libc::IGNCR | libc::ICRNL | libc::IXON | libc::IXOFF | libc::IXANY);
    settings.c_oflag &= !libc::OPOST;
    settings.c_lflag &= !(libc::ECHO | libc::ECHONL | libc::ICANON | libc::ISIG | libc::IEXTEN);
    settings.c_cflag &= !FRAMING;
    settings.c_cflag |= libc::CS8 | libc::CLOCAL | libc::CREAD;
    for (place, value) in [(libc::VMIN, 1), (libc::VTIME, 0)] {
        if let Some(place) = settings.c_cc.get_mut(place) {
            *place = value;
        }
    }
}

/// What has to be as asked for bytes to pass, besides the speed.
const FRAMING: libc::tcflag_t = libc::CSIZE | libc::CSTOPB | libc::PARENB | libc::CRTSCTS;

/// How a terminal is set in Linux: by the kernel's own interface, as the C library's knows only the standard speeds.
#[cfg(all(
    any(target_os = "linux", target_os = "android"),
    not(any(target_arch = "powerpc", target_arch = "powerpc64"))
))]
mod terminal {
    use super::super::is_near;
    use super::{Error, c_int, c_ulong, success};
    pub(super) use libc::termios2 as Settings;

    /// Writes one termios2.
    pub(super) unsafe fn get(fd: c_int, settings: *mut Settings) -> c_int {
        // SAFETY: there is room for what this request writes.
        unsafe { libc::ioctl(fd, libc::TCGETS2, settings) }
    }

    pub(super) fn set_speed(fd: c_int, settings: &mut Settings, baud: c_ulong) -> Result<(), Error> {
        // A speed has a code, for the sake of programs that know only these, or is given as a number. No code for
        // receiving stands for that of sending.
        settings.c_cflag = settings.c_cflag & !(libc::CBAUD | libc::CIBAUD) | super::code(baud).unwrap_or(libc::BOTHER);
        settings.c_ospeed = libc::speed_t::try_from(baud).map_err(|_| libc::EINVAL)?;
        settings.c_ispeed = settings.c_ospeed;
        // SAFETY: this request reads one termios2.
        success(unsafe { libc::ioctl(fd, libc::TCSETS2, &raw const *settings) }).map(drop)
    }

    pub(super) fn has_speed(settings: &Settings, baud: c_ulong) -> bool {
        is_near(settings.c_ospeed.into(), baud)
    }
}

/// How a terminal is set in the words of POSIX.
#[cfg(not(all(
    any(target_os = "linux", target_os = "android"),
    not(any(target_arch = "powerpc", target_arch = "powerpc64"))
)))]
mod terminal {
    use super::super::is_near;
    use super::{Error, c_int, c_ulong, success};
    pub(super) use libc::{tcgetattr as get, termios as Settings};

    pub(super) fn set_speed(fd: c_int, settings: &mut Settings, baud: c_ulong) -> Result<(), Error> {
        let code = super::code(baud);
        #[cfg(target_vendor = "apple")]
        let code = code.or(Some(libc::B9600));
        let code = code.ok_or(libc::EINVAL)?;
        // SAFETY: these and the next read and write the settings alone.
        success(unsafe { libc::cfsetispeed(settings, code) | libc::cfsetospeed(settings, code) })?;
        // SAFETY: see above.
        success(unsafe { libc::tcsetattr(fd, libc::TCSANOW, settings) })?;
        #[cfg(target_vendor = "apple")]
        if super::code(baud).is_none() {
            /// IOKit's request for any speed, `_IOW('T', 2, speed_t)`.
            const IOSSIOSPEED: c_ulong = 0x8008_5402;
            // SAFETY: this request reads one speed_t.
            success(unsafe { libc::ioctl(fd, IOSSIOSPEED, &raw const baud) })?;
        }
        Ok(())
    }

    pub(super) fn has_speed(settings: &Settings, baud: c_ulong) -> bool {
        // SAFETY: this reads the settings alone.
        let speed = unsafe { libc::cfgetospeed(settings) };
        match super::code(baud) {
            Some(code) => is_near(speed.into(), code.into()),
            // The request has set it or failed; what is reported of it afterwards differs.
            None => true,
        }
    }
}

/// The system's code of a speed, which in BSD is the number itself; `None` when it has none.
#[cfg(any(target_os = "freebsd", target_os = "netbsd", target_os = "openbsd", target_os = "dragonfly"))]
fn code(baud: c_ulong) -> Option<libc::speed_t> {
    libc::speed_t::try_from(baud).ok()
}

/// The system's code of a speed; `None` when it has none.
#[cfg(not(any(target_os = "freebsd", target_os = "netbsd", target_os = "openbsd", target_os = "dragonfly")))]
fn code(baud: c_ulong) -> Option<libc::speed_t> {
    const CODES: &[(c_ulong, libc::speed_t)] = &[
        (1200, libc::B1200),
        (2400, libc::B2400),
        (4800, libc::B4800),
        (9600, libc::B9600),
        (19_200, libc::B19200),
        (38_400, libc::B38400),
        (57_600, libc::B57600),
        (115_200, libc::B115200),
        (230_400, libc::B230400),
        #[cfg(any(target_os = "linux", target_os = "android"))]
        (460_800, libc::B460800),
        #[cfg(any(target_os = "linux", target_os = "android"))]
        (921_600, libc::B921600),
        #[cfg(any(target_os = "linux", target_os = "android"))]
        (1_000_000, libc::B1000000),
    ];
    CODES.iter().find(|(speed, _)| *speed == baud).map(|(_, code)| *code)
}

/// Discards what was received.
pub(crate) fn discard(fd: c_int) -> Result<(), Cause> {
    // SAFETY: tcflush takes no pointer.
    success(unsafe { libc::tcflush(fd, libc::TCIFLUSH) }).map(drop).map_err(cause_of)
}

/// Waits until all was sent.
pub(crate) fn drain(fd: c_int) -> Result<(), Cause> {
    // SAFETY: tcdrain takes no pointer.
    retry(|| unsafe { libc::tcdrain(fd) }).map(drop).map_err(cause_of)
}

/// Sets one line, and leaves the other alone.
pub(crate) fn set_line(fd: c_int, line: c_int, on: bool) -> Result<(), Cause> {
    let before = lines(fd).map_err(|error| match error {
        libc::ENOTTY | libc::EINVAL => Cause::NoLines,
        _ => cause_of(error),
    })?;
    set_lines(fd, with(before, line, if on { 1 } else { -1 }), before)
}

/// The lines as they are; an error on what has none, such as a pseudo-terminal.
fn lines(fd: c_int) -> Result<c_int, Error> {
    let mut lines: c_int = 0;
    // SAFETY: this request writes one int.
    success(unsafe { libc::ioctl(fd, libc::TIOCMGET as _, &raw mut lines) })?;
    Ok(lines)
}

/// These lines, of which one is set as [`SerialSettings`] say.
const fn with(lines: c_int, line: c_int, on: c_int) -> c_int {
    match on {
        0 => lines,
        1.. => lines | line,
        _ => lines & !line,
    }
}

fn set_lines(fd: c_int, lines: c_int, before: c_int) -> Result<(), Cause> {
    if lines == before {
        return Ok(());
    }
    // SAFETY: this request reads one int.
    success(unsafe { libc::ioctl(fd, libc::TIOCMSET as _, &raw const lines) }).map(drop).map_err(cause_of)
}

/// Waits for bytes, and reads those that are there.
pub(crate) fn read(fd: c_int, out: &mut [MaybeUninit<u8>], timeout_ms: c_long) -> Result<usize, Cause> {
    if out.is_empty() || !wait(fd, libc::POLLIN, Deadline::after(timeout_ms).left())? {
        return Ok(0);
    }
    // SAFETY: `out` is writable for its length.
    let got = unsafe { libc::read(fd, out.as_mut_ptr().cast(), out.len()) };
    match usize::try_from(got).map_err(|_| errno()) {
        // There was something to read, so nothing is the end.
        Ok(0) => Err(Cause::Disconnected),
        Ok(got) => Ok(got),
        Err(libc::EAGAIN | libc::EINTR) => Ok(0),
        Err(error) => Err(cause_of(error)),
    }
}

/// Writes all bytes, or as many as there is room for in time.
pub(crate) fn write(fd: c_int, bytes: &[u8], timeout_ms: c_long) -> Result<usize, Cause> {
    let deadline = Deadline::after(timeout_ms);
    let mut rest = bytes;
    while !rest.is_empty() {
        // SAFETY: `rest` is readable for its length.
        let written = unsafe { libc::write(fd, rest.as_ptr().cast(), rest.len()) };
        match usize::try_from(written).map_err(|_| errno()) {
            Ok(written @ 1..) => rest = rest.get(written..).unwrap_or_default(),
            Err(libc::EINTR) => (),
            // No device should take nothing without saying so, but none keeps us here beyond the deadline.
            Ok(0) | Err(libc::EAGAIN) => {
                let left = deadline.left();
                if left == 0 || (!wait(fd, libc::POLLOUT, left)? && deadline.left() == 0) {
                    break;
                }
            }
            Err(error) => return Err(cause_of(error)),
        }
    }
    Ok(bytes.len().wrapping_sub(rest.len()))
}

/// Waits for one of poll(2)'s events. Returns whether it came; not when the time is over or a signal was handled.
fn wait(fd: c_int, events: c_short, timeout_ms: c_int) -> Result<bool, Cause> {
    let mut polled = libc::pollfd { fd, events, revents: 0 };
    // SAFETY: the pointer is to as many pollfds as the count says, one.
    match success(unsafe { libc::poll(&raw mut polled, 1, timeout_ms) }) {
        Ok(0) | Err(libc::EINTR) => Ok(false),
        // Even if the device is gone: there may be something left to read.
        Ok(_) if polled.revents & events != 0 => Ok(true),
        Ok(_) => Err(Cause::Disconnected),
        Err(error) => Err(Cause::System(error)),
    }
}

/// When waiting has to end, in milliseconds of a clock that nobody sets.
struct Deadline(Option<i64>);

impl Deadline {
    #[allow(clippy::useless_conversion, reason = "c_long has 32 bits elsewhere")]
    fn after(timeout_ms: c_long) -> Self {
        Self((timeout_ms >= 0).then(|| now().saturating_add(i64::from(timeout_ms))))
    }

    /// Milliseconds that are left, as poll(2) takes them.
    fn left(&self) -> c_int {
        self.0.map_or(-1, |end| c_int::try_from(end.saturating_sub(now()).max(0)).unwrap_or(c_int::MAX))
    }
}

#[allow(clippy::useless_conversion, reason = "time_t and long have 32 bits elsewhere")]
fn now() -> i64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: this writes one timespec. It can't fail: every Unix has this clock.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
    i64::from(now.tv_sec).wrapping_mul(1000).wrapping_add(i64::from(now.tv_nsec) / 1_000_000)
}

/// The system's text for an error.
pub(super) fn text(error: Error, out: &mut [u8]) -> &[u8] {
    // SAFETY: it writes a string of at most that length.
    unsafe { libc::strerror_r(error, out.as_mut_ptr().cast::<c_char>(), out.len()) };
    out.split(|byte| *byte == 0).next().unwrap_or_default()
}

/// What an error of a device that was open means.
const fn cause_of(error: Error) -> Cause {
    match error {
        libc::EIO | libc::ENXIO | libc::ENODEV | libc::EPIPE => Cause::Disconnected,
        _ => Cause::System(error),
    }
}

/// Calls until no signal interrupts it.
fn retry(mut call: impl FnMut() -> c_int) -> Result<c_int, Error> {
    loop {
        match success(call()) {
            Err(libc::EINTR) => (),
            result => return result,
        }
    }
}

fn success(result: c_int) -> Result<c_int, Error> {
    if result < 0 { Err(errno()) } else { Ok(result) }
}

fn errno() -> Error {
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
