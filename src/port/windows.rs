//! COM ports of Windows, over kernel32.

use core::ffi::{CStr, c_char, c_int, c_long, c_void};
use core::mem::MaybeUninit;
use core::ptr;

use super::{Cause, SerialSettings, is_near};

/// The system's number of an error.
pub(super) type Error = u32;

/// The outputs besides the data, data terminal ready and request to send: what sets them. One more clears them.
pub(crate) const DTR: u32 = 5;
pub(crate) const RTS: u32 = 3;

/// `DCB`: how a port is set. The fields that are not named are those for software flow control.
#[derive(Default)]
#[repr(C)]
struct State {
    length: u32,
    baud: u32,
    flags: u32,
    limits: [u16; 3],
    byte_size: u8,
    parity: u8,
    stop_bits: u8,
    characters: [u8; 5],
    reserved: u16,
}

const BINARY: u32 = 1;
const DTR_ON: u32 = 1 << 4;
const RTS_ON: u32 = 1 << 12;

/// `COMMTIMEOUTS`, in milliseconds: between bytes, of a read for each byte and in all, and of a write likewise.
type Timeouts = [u32; 5];

/// `HANDLE`
type Handle = *mut c_void;

#[link(name = "kernel32")]
unsafe extern "system" {
    fn CreateFileA(
        name: *const c_char,
        access: u32,
        share: u32,
        security: *const c_void,
        creation: u32,
        flags: u32,
        template: Handle,
    ) -> Handle;
    fn CloseHandle(file: Handle) -> c_int;
    fn GetCommState(file: Handle, state: *mut State) -> c_int;
    fn SetCommState(file: Handle, state: *const State) -> c_int;
    fn SetCommTimeouts(file: Handle, timeouts: *const Timeouts) -> c_int;
    fn ClearCommError(file: Handle, errors: *mut u32, status: *mut c_void) -> c_int;
    fn PurgeComm(file: Handle, flags: u32) -> c_int;
    fn EscapeCommFunction(file: Handle, function: u32) -> c_int;
    fn FlushFileBuffers(file: Handle) -> c_int;
    fn ReadFile(file: Handle, out: *mut c_void, room: u32, got: *mut u32, overlapped: *mut c_void) -> c_int;
    fn WriteFile(file: Handle, bytes: *const c_void, count: u32, put: *mut u32, overlapped: *mut c_void) -> c_int;
    fn FormatMessageA(
        flags: u32,
        source: *const c_void,
        message: u32,
        language: u32,
        out: *mut c_char,
        room: u32,
        arguments: *const c_void,
    ) -> u32;
    fn GetLastError() -> u32;
    fn GetTickCount64() -> u64;
}

const ERROR_FILE_NOT_FOUND: Error = 2;
const ERROR_ACCESS_DENIED: Error = 5;
const ERROR_NOT_READY: Error = 21;
const ERROR_BAD_COMMAND: Error = 22;
const ERROR_GEN_FAILURE: Error = 31;
const ERROR_SHARING_VIOLATION: Error = 32;
const ERROR_SEM_TIMEOUT: Error = 121;
const ERROR_FILENAME_EXCED_RANGE: Error = 206;
const ERROR_NO_SUCH_DEVICE: Error = 433;
const ERROR_OPERATION_ABORTED: Error = 995;
const ERROR_IO_DEVICE: Error = 1117;
const ERROR_DEVICE_NOT_CONNECTED: Error = 1167;
const ERROR_DEVICE_REMOVED: Error = 1617;

/// Opens a port for this program alone, by a name such as `COM5`, `COM10` or `\\.\COM10`.
pub(super) fn open(device: &CStr, settings: &SerialSettings) -> Result<c_int, Cause> {
    const READ_WRITE: u32 = 0xC000_0000;
    const EXISTING: u32 = 3;
    let mut path = [MaybeUninit::<u8>::uninit(); 260];
    let name = device.to_bytes_with_nul();
    // Ports beyond COM9 are found only among the devices.
    let prefix: &[u8] = if name.iter().any(|byte| matches!(byte, b'\\' | b'/')) { b"" } else { br"\\.\" };
    if name.len().saturating_add(prefix.len()) > path.len() {
        return Err(Cause::System(ERROR_FILENAME_EXCED_RANGE));
    }
    for (place, byte) in path.iter_mut().zip(prefix.iter().chain(name)) {
        place.write(*byte);
    }
    // SAFETY: the path was written up to its zero byte, the last of the name.
    let file = unsafe { CreateFileA(path.as_ptr().cast(), READ_WRITE, 0, ptr::null(), EXISTING, 0, ptr::null_mut()) };
    if file.addr() == usize::MAX {
        return Err(match last_error() {
            ERROR_ACCESS_DENIED | ERROR_SHARING_VIOLATION => Cause::InUse,
            error => Cause::System(error),
        });
    }
    // Handles have 32 significant bits, so that programs of 32 and 64 bits can share them.
    #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "see above")]
    let handle = file.addr() as c_int;
    set_up(handle, settings).inspect_err(|_| close(handle))?;
    Ok(handle)
}

fn set_up(handle: c_int, asked: &SerialSettings) -> Result<(), Cause> {
    // Closing drops both lines, whatever is asked for.
    let SerialSettings { baud, dtr, rts, keep_lines: _ } = *asked;
    let mut state = state(handle).map_err(|_| Cause::NoSerialPort)?;
    state.baud = baud;
    state.flags = BINARY;
    for (line, on) in [(DTR_ON, dtr), (RTS_ON, rts)] {
        if on >= 0 {
            state.flags |= line;
        }
    }
    (state.byte_size, state.parity, state.stop_bits) = (8, 0, 0);
    // SAFETY: it reads one DCB.
    success(unsafe { SetCommState(file(handle), &raw const state) }).map_err(|error| match cause_of(error) {
        // What drivers say of a speed that they don't have differs.
        Cause::Disconnected if error != ERROR_GEN_FAILURE => Cause::Disconnected,
        _ => Cause::NotTaken(baud),
    })?;
    let now = self::state(handle).map_err(cause_of)?;
    if !is_near(now.baud, baud) || (now.byte_size, now.parity, now.stop_bits) != (8, 0, 0) {
        return Err(Cause::NotTaken(baud));
    }
    discard(handle)
}

fn state(handle: c_int) -> Result<State, Error> {
    let mut state = State { length: 28, ..State::default() };
    // SAFETY: it writes one DCB, for which there is room.
    success(unsafe { GetCommState(file(handle), &raw mut state) })?;
    Ok(state)
}
const _: () = assert!(size_of::<State>() == 28);

/// Sends what was written, and closes a port.
pub(super) fn close(handle: c_int) {
    // SAFETY: the port forgets the handle.
    unsafe { CloseHandle(file(handle)) };
}

/// Discards what was received.
pub(crate) fn discard(handle: c_int) -> Result<(), Cause> {
    const RECEIVED: u32 = 8;
    // SAFETY: it takes no pointer to memory.
    success(unsafe { PurgeComm(file(handle), RECEIVED) }).map_err(cause_of)
}

/// Waits until all was sent.
pub(crate) fn drain(handle: c_int) -> Result<(), Cause> {
    // SAFETY: it takes no pointer to memory.
    success(unsafe { FlushFileBuffers(file(handle)) }).map_err(cause_of)
}

/// Sets one line, and leaves the other alone.
pub(crate) fn set_line(handle: c_int, line: u32, on: bool) -> Result<(), Cause> {
    let function = line.wrapping_add(u32::from(!on));
    // SAFETY: it takes no pointer to memory.
    success(unsafe { EscapeCommFunction(file(handle), function) }).map_err(|error| match cause_of(error) {
        Cause::System(_) => Cause::NoLines,
        cause => cause,
    })
}

/// Waits for bytes, and reads those that are there.
pub(crate) fn read(handle: c_int, out: &mut [MaybeUninit<u8>], timeout_ms: c_long) -> Result<usize, Cause> {
    if out.is_empty() {
        return Ok(0);
    }
    let room = u32::try_from(out.len()).unwrap_or(u32::MAX);
    // The largest numbers in front ask for those bytes that are there, or else for the first one in time.
    let (per_byte, wait) = match u32::try_from(timeout_ms) {
        Ok(0) => (0, 0),
        Ok(wait) => (u32::MAX, wait),
        // For ever, but a driver may not wake up who waits when its device is gone.
        Err(_) => (u32::MAX, 1000),
    };
    set_timeouts(handle, [per_byte, wait], 0)?;
    loop {
        let mut got = 0;
        // SAFETY: `out` is writable for its length, and so is `got`.
        let result =
            success(unsafe { ReadFile(file(handle), out.as_mut_ptr().cast(), room, &raw mut got, ptr::null_mut()) });
        result.map_err(cause_of)?;
        if got > 0 {
            return usize::try_from(got).map_err(|_| Cause::Disconnected);
        }
        // Not every driver reports a lost device when it is read.
        // SAFETY: it writes one number; NULL says that nothing else is wanted.
        success(unsafe { ClearCommError(file(handle), &raw mut got, ptr::null_mut()) }).map_err(cause_of)?;
        if timeout_ms >= 0 {
            return Ok(0);
        }
    }
}

/// Writes all bytes, or as many as there is room for in time.
pub(crate) fn write(handle: c_int, bytes: &[u8], timeout_ms: c_long) -> Result<usize, Cause> {
    // SAFETY: it takes no pointer.
    let now = || unsafe { GetTickCount64() };
    let deadline = u64::try_from(timeout_ms).ok().map(|timeout| now().saturating_add(timeout));
    let mut rest = bytes;
    while !rest.is_empty() {
        // 0 would mean for ever.
        let left = deadline.map_or(0, |end| u32::try_from(end.saturating_sub(now())).unwrap_or(u32::MAX).max(1));
        set_timeouts(handle, [0, 0], left)?;
        let mut put = 0;
        let count = u32::try_from(rest.len()).unwrap_or(u32::MAX);
        // SAFETY: `rest` is readable for its length, and `put` writable.
        let result =
            success(unsafe { WriteFile(file(handle), rest.as_ptr().cast(), count, &raw mut put, ptr::null_mut()) });
        rest = usize::try_from(put).ok().and_then(|put| rest.get(put..)).unwrap_or_default();
        match result {
            Ok(()) | Err(ERROR_SEM_TIMEOUT) => (),
            Err(error) => return Err(cause_of(error)),
        }
        if deadline.is_some_and(|end| now() >= end) {
            break;
        }
    }
    Ok(bytes.len().wrapping_sub(rest.len()))
}

/// Sets how long each byte and all of a read, and a write may take.
fn set_timeouts(handle: c_int, [read_per_byte, read]: [u32; 2], write: u32) -> Result<(), Cause> {
    let timeouts = [u32::MAX, read_per_byte, read, 0, write];
    // SAFETY: it reads one COMMTIMEOUTS.
    success(unsafe { SetCommTimeouts(file(handle), &raw const timeouts) }).map_err(cause_of)
}

/// The system's text for an error, without the full stop at its end.
pub(super) fn text(error: Error, out: &mut [u8]) -> &[u8] {
    /// Of the system's messages, without what would be filled in, in one line.
    const FLAGS: u32 = 0x1000 | 0x200 | 0xFF;
    let room = u32::try_from(out.len()).unwrap_or(0);
    // SAFETY: it writes at most as many bytes as there is room for.
    let length = unsafe { FormatMessageA(FLAGS, ptr::null(), error, 0, out.as_mut_ptr().cast(), room, ptr::null()) };
    let mut text = usize::try_from(length).ok().and_then(|length| out.get(..length)).unwrap_or_default();
    while let [rest @ .., b' ' | b'.' | b'\r' | b'\n'] = text {
        text = rest;
    }
    text
}

/// What an error of a port that was open means.
const fn cause_of(error: Error) -> Cause {
    match error {
        ERROR_FILE_NOT_FOUND
        | ERROR_ACCESS_DENIED
        | ERROR_NOT_READY
        | ERROR_BAD_COMMAND
        | ERROR_GEN_FAILURE
        | ERROR_NO_SUCH_DEVICE
        | ERROR_OPERATION_ABORTED
        | ERROR_IO_DEVICE
        | ERROR_DEVICE_NOT_CONNECTED
        | ERROR_DEVICE_REMOVED => Cause::Disconnected,
        _ => Cause::System(error),
    }
}

/// The `HANDLE` behind its 32 bits, extended by their sign.
fn file(handle: c_int) -> Handle {
    #[expect(clippy::cast_sign_loss, reason = "an address")]
    ptr::without_provenance_mut(handle as isize as usize)
}

fn success(result: c_int) -> Result<(), Error> {
    if result == 0 { Err(last_error()) } else { Ok(()) }
}

fn last_error() -> Error {
    // SAFETY: it takes no pointer.
    unsafe { GetLastError() }
}
