//! The Ozeki line protocol.
#![forbid(unsafe_code)]
