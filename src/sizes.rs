//! The sizes that are fixed when the library is built.
//!
//! They come from the environment of the build, by default as `src/sizes.mk` says. They are part of the layout of the C
//! structs, so they are part of the symbols' names too: a program compiled for other sizes does not link.

include!(concat!(env!("OUT_DIR"), "/sizes.rs"));

// One by one: a build that is refused says all that is wrong.
const _: () = assert!(1 <= DP_DATA_MAX_SIZE && DP_DATA_MAX_SIZE <= 255, "DP_DATA_MAX_SIZE must be between 1 and 255");
const _: () = assert!(
    DP_BUFSIZE >= DP_DATA_MAX_SIZE + 5,
    "DP_BUFSIZE is too small: the ring must hold one maximal frame, DP_DATA_MAX_SIZE + 5 bytes"
);
const _: () = assert!(DP_BUFSIZE as u128 <= core::ffi::c_int::MAX as u128, "DP_BUFSIZE is too large for an int");
const _: () = assert!(
    63 <= OLP_LINE_MAX && OLP_LINE_MAX <= 32_000,
    "OLP_LINE_MAX must be between 63, the longest command, and 32000: a 16-bit int must hold it"
);
const _: () = assert!(1 <= OLP_WINDOW_MAX && OLP_WINDOW_MAX <= 64, "OLP_WINDOW_MAX must be between 1 and 64");
const _: () = assert!(64 <= OLP_REPLY_MAX && OLP_REPLY_MAX <= 255, "OLP_REPLY_MAX must be between 64 and 255");
const _: () = assert!(1 <= OLP_DEVICES_MAX && OLP_DEVICES_MAX <= 255, "OLP_DEVICES_MAX must be between 1 and 255");
const _: () = assert!(1 <= GX_QUEUE_MAX && GX_QUEUE_MAX <= 255, "GX_QUEUE_MAX must be between 1 and 255");
const _: () = assert!(1 <= GX_WINDOW_MAX && GX_WINDOW_MAX <= 255, "GX_WINDOW_MAX must be between 1 and 255");
