//! `libdeltarobot/line_protocol.h`: lines of the Ozeki line protocol: checksum, reading, building, receiving.
//!
//! Building a line: `olp_begin_command`, of a device `olp_begin`. Reading those received:
//!
//! ```c
//! int got = uart_read(&uart, in, sizeof in);
//! for (int taken = 0; taken < got;) {
//!     taken += olp_receive(&receiver, in + taken, got - taken, &line);
//!     if (line.kind == OLP_LINE_COMPLETE && olp_parse(line.text, line.length, &message) == OLP_RC_SUCCESS &&
//!         olp_is(&message, "c", 0, "heaterinfo") &&
//!         olp_get_float(&message, "temp", 0, &temperature) == OLP_RC_SUCCESS)
//!         show(temperature);
//! }
//! ```

use core::ffi::{c_char, c_int, c_uint, c_ulong, c_void};
use core::ptr::null;

use super::memory::{bytes_of, int};
use super::sizes::OLP_LINE_MAX;
use super::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::line::{self, Received};

pub mod encoder;
pub mod message;

/// The operation completed.
pub const OLP_RC_SUCCESS: c_int = 0;
/// A NULL pointer or an argument out of range: nothing was done.
pub const OLP_RC_ERROR_GENERIC: c_int = 1;
/// There is no room.
pub const OLP_RC_OVERFLOW: c_int = 3;
/// Not now: something else has to end first.
pub const OLP_RC_BUSY: c_int = 5;
/// Nothing has happened.
pub const OLP_RC_NO_EVENT: c_int = 6;
/// Text is not what it should be: an escape without its digits, a value that is no number, a line feed in a line.
pub const OLP_RC_MALFORMED: c_int = 8;
/// A line is longer than may be sent, or does not fit the buffer.
pub const OLP_RC_TOO_LONG: c_int = 9;
/// A number is beyond what its type holds.
pub const OLP_RC_RANGE: c_int = 10;
/// There is no such parameter.
pub const OLP_RC_NOT_FOUND: c_int = 11;
/// The first parameter of a line is not `c`, or there is none.
pub const OLP_RC_NO_COMMAND: c_int = 12;
/// A name is not of `[A-Za-z0-9_]`, or a parameter is named `s`, as the checksum is.
pub const OLP_RC_NAME: c_int = 13;

/// Bytes of the longest line that a PC sends, its checksum and its line feed counted: a device's serial buffer.
pub const OLP_COMMAND_MAX: c_int = 64;
/// Most decimals that a float is written with.
pub const OLP_DECIMALS_MAX: c_int = 9;

/// The line has no checksum.
pub const OLP_CHECKSUM_NONE: c_int = 0;
/// The line has the right checksum.
pub const OLP_CHECKSUM_RIGHT: c_int = 1;
/// The line has a checksum, and it is wrong: some of the line is not what was sent.
pub const OLP_CHECKSUM_WRONG: c_int = 2;

/// No line has ended yet.
pub const OLP_LINE_NONE: c_int = 0;
/// A line was received.
pub const OLP_LINE_COMPLETE: c_int = 1;
/// A line longer than `OLP_LINE_MAX` has ended, and is lost.
pub const OLP_LINE_OVERLONG: c_int = 2;

/// A line that was read: a view of the text that `olp_parse` was given, which must stay where it is meanwhile.
#[derive(Debug)]
#[repr(C)]
pub struct LineMessage {
    /// The line.
    pub line: *const c_char,
    /// Number of bytes of it, without its end.
    pub length: c_int,
    /// Number of parameters, the command and a checksum counted.
    pub count: c_int,
    /// One of `OLP_CHECKSUM_*`.
    pub checksum: c_int,
    /// The Fletcher-16 of the bytes before `&s=`, or of all of them without a checksum: what an ack repeats.
    pub sum: c_uint,
}

/// A parameter: a view of the line that it stands in. Neither text ends with a zero byte.
#[derive(Debug)]
#[repr(C)]
pub struct LineParam {
    /// The name.
    pub name: *const c_char,
    /// Number of bytes of it.
    pub name_length: c_int,
    /// The value as it was received, encoded: `olp_value_string` decodes it.
    pub value: *const c_char,
    /// Number of bytes of it.
    pub value_length: c_int,
}

/// What `olp_receive` found.
#[derive(Debug)]
#[repr(C)]
pub struct LineText {
    /// One of `OLP_LINE_*`.
    pub kind: c_int,
    /// The line without its end, a zero byte behind it, in the receiver until the next call; NULL: there is none.
    pub text: *const c_char,
    /// Number of bytes of it; 0 when there is none.
    pub length: c_int,
}

/// A line that is being built. Its fields are private.
#[derive(Debug)]
#[repr(C)]
pub struct LineEncoder {
    pub(super) buf: *mut c_char,
    pub(super) cap: c_int,
    pub(super) length: c_int,
    pub(super) error: c_int,
}

const _: () =
    assert!(OLP_COMMAND_MAX as usize == line::COMMAND_MAX && OLP_DECIMALS_MAX as usize == line::DECIMALS_MAX as usize);

/// `unsigned long`s of a receiver, with some room to spare.
pub const OLP_RECEIVER_WORDS: usize = OLP_LINE_MAX / 4 + 3;

/// A receiver of lines up to `OLP_LINE_MAX` bytes. All zero is an empty one.
#[derive(Debug)]
#[repr(C)]
pub struct Receiver {
    opaque: [c_ulong; OLP_RECEIVER_WORDS],
}
state!(Receiver: line::Receiver<{ OLP_LINE_MAX + 1 }>);

/// Makes a receiver empty, as it is when all zero. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` for NULL.
///
/// ```c
/// olp_receiver_init(&receiver);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receiver_init(receiver: *mut Receiver) -> c_int {
    // SAFETY: this is Room's contract.
    match unsafe { Receiver::get(receiver) } {
        Some(receiver) => receiver.clear(),
        None => return OLP_RC_ERROR_GENERIC,
    }
    OLP_RC_SUCCESS
}

/// Takes received bytes up to the end of the next line, and reports in line what they were. Lines end with LF or CR LF;
/// empty ones are passed over. One longer than `OLP_LINE_MAX` is lost: `OLP_LINE_OVERLONG` when its end has come.
///
/// Returns how many bytes were taken: when fewer than there are, it is to be called again with the rest; or
/// -`OLP_RC_ERROR_GENERIC` when receiver or line is NULL, bytes negative, or buf NULL and bytes not 0.
///
/// ```c
/// for (int taken = 0; taken < length;) {
///     taken += olp_receive(&receiver, in + taken, length - taken, &line);
///     if (line.kind == OLP_LINE_COMPLETE)
///         puts(line.text);
/// }
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receive(
    receiver: *mut Receiver,
    buf: *const c_void,
    bytes: c_int,
    line: *mut LineText,
) -> c_int {
    // SAFETY: the objects of one call don't overlap, so that each may be borrowed.
    let (Some(receiver), Some(bytes), Some(line)) =
        (unsafe { (Receiver::get(receiver), bytes_of(buf, bytes), line.as_mut()) })
    else {
        return -OLP_RC_ERROR_GENERIC;
    };
    receiver.release();
    let taken = receiver.take(bytes);
    *line = match receiver.received() {
        Received::Nothing => LineText { kind: OLP_LINE_NONE, text: null(), length: 0 },
        Received::Line(text) => {
            LineText { kind: OLP_LINE_COMPLETE, text: text.as_ptr().cast(), length: int(text.len()) }
        }
        Received::TooLong => LineText { kind: OLP_LINE_OVERLONG, text: null(), length: 0 },
    };
    int(taken)
}
