//! The sizes that are fixed when the library is built.
//!
//! They come from the environment of the build, `DP_BUFSIZE` and `DP_DATA_MAX_SIZE`, and are part of
//! the layout of the C structs. So they are part of the symbols' names too: a program compiled
//! for other sizes does not link (see [`crate::ffi`]).

include!(concat!(env!("OUT_DIR"), "/sizes.rs"));

const _: () = assert!(
    1 <= DP_DATA_MAX_SIZE && DP_DATA_MAX_SIZE <= 255,
    "DP_DATA_MAX_SIZE must be between 1 and 255: the length field of a frame is one byte"
);
const _: () = assert!(
    DP_BUFSIZE >= crate::deltarobot::FRAME_MAX,
    "DP_BUFSIZE is too small: the ring must hold one maximal frame, DP_DATA_MAX_SIZE + 5 bytes"
);
const _: () = assert!(
    DP_BUFSIZE as u128 <= core::ffi::c_int::MAX as u128,
    "DP_BUFSIZE is too large: it must fit the target's int"
);

/// Whether code may be spent on speed: on hosts, yes; where flash is counted in bytes, the plain way must do.
pub(crate) const FAST: bool = cfg!(target_pointer_width = "64");
