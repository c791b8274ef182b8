/*
 * The library is written in Rust (src/protocol.rs). This file stands where the original's source stood, so that
 * programs that compile or include it go on building: it compiles to nothing, and libdeltarobot.a brings the functions.
 */
#ifndef PROTOCOL_C_NO_INCLUDE
#include "libdeltarobot/protocol.h"
#endif

/* A translation unit without any declaration is not C. */
struct protocol_data;
