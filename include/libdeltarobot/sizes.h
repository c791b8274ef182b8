/**
 * @file
 * libdeltarobot/sizes.h: the sizes that the library was built for. They are part of the structs' layout and of the
 * symbols' names, so a program cannot choose its own: it may define the same ones, before it includes a header.
 *
 * Generated from src/sizes.mk: `make header` renews it; a build for other sizes has its own. A build in the source tree
 * leaves its own in sizes_in_place.h, for programs that include the headers where they lie.
 */
#if !defined(LIBDELTAROBOT_SIZES_H) && !defined(LIBDELTAROBOT_SIZES_IN_PLACE)
#define LIBDELTAROBOT_SIZES_IN_PLACE
#ifdef __has_include
#if __has_include("sizes_in_place.h")
#include "sizes_in_place.h"
#endif
#endif
#endif
#ifndef LIBDELTAROBOT_SIZES_H
#define LIBDELTAROBOT_SIZES_H

#if defined(DP_BUFSIZE) && (DP_BUFSIZE) != 128
#error "libdeltarobot was built with DP_BUFSIZE=128: build it again with the size that this program defines"
#endif
#undef DP_BUFSIZE
/** Bytes that a ring holds. By default 128. */
#define DP_BUFSIZE 128

#if defined(DP_DATA_MAX_SIZE) && (DP_DATA_MAX_SIZE) != 32
#error "libdeltarobot was built with DP_DATA_MAX_SIZE=32: build it again with the size that this program defines"
#endif
#undef DP_DATA_MAX_SIZE
/** Longest payload of a frame in bytes, 1 to 255. By default 32. */
#define DP_DATA_MAX_SIZE 32

#if defined(OLP_LINE_MAX) && (OLP_LINE_MAX) != 255
#error "libdeltarobot was built with OLP_LINE_MAX=255: build it again with the size that this program defines"
#endif
#undef OLP_LINE_MAX
/** Longest line that is received, in bytes without its end: 63, a command, or more; a host needs 80. By default 255. */
#define OLP_LINE_MAX 255

#if defined(OLP_WINDOW_MAX) && (OLP_WINDOW_MAX) != 8
#error "libdeltarobot was built with OLP_WINDOW_MAX=8: build it again with the size that this program defines"
#endif
#undef OLP_WINDOW_MAX
/** Most commands unanswered at a time: the host keeps them to repeat them, a device keeps its answers. By default 8. */
#define OLP_WINDOW_MAX 8

#if defined(OLP_REPLY_MAX) && (OLP_REPLY_MAX) != 128
#error "libdeltarobot was built with OLP_REPLY_MAX=128: build it again with the size that this program defines"
#endif
#undef OLP_REPLY_MAX
/** Longest line that a device sends, in bytes with its end: 64 to 255. By default 128. */
#define OLP_REPLY_MAX 128

#if defined(OLP_DEVICES_MAX) && (OLP_DEVICES_MAX) != 16
#error "libdeltarobot was built with OLP_DEVICES_MAX=16: build it again with the size that this program defines"
#endif
#undef OLP_DEVICES_MAX
/** Devices that a host knows at a time. By default 16. */
#define OLP_DEVICES_MAX 16

#if defined(GX_QUEUE_MAX) && (GX_QUEUE_MAX) != 16
#error "libdeltarobot was built with GX_QUEUE_MAX=16: build it again with the size that this program defines"
#endif
#undef GX_QUEUE_MAX
/** Moves that the motion side queues. By default 16. */
#define GX_QUEUE_MAX 16

#if defined(GX_WINDOW_MAX) && (GX_WINDOW_MAX) != 16
#error "libdeltarobot was built with GX_WINDOW_MAX=16: build it again with the size that this program defines"
#endif
#undef GX_WINDOW_MAX
/** Most moves of a host that may be unfinished at a time. By default 16. */
#define GX_WINDOW_MAX 16

#endif
