/* A program that includes the original's source file, as some did. */
#include "libdeltarobot/protocol.h"

#define PROTOCOL_C_NO_INCLUDE
#include "libdeltarobot/src/protocol.c"

#include "consumer.c"
