//! The GX binary vector protocol.
#![forbid(unsafe_code)]
