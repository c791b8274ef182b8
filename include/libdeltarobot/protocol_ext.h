/**
 * @file
 * libdeltarobot/protocol_ext.h: what the original's API lacks.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/protocol_ext.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_PROTOCOL_EXT_H
#define LIBDELTAROBOT_PROTOCOL_EXT_H

#include "abi.h"
#include "protocol.h"

LIBDELTAROBOT_NOT_PACKED(protocol_ext);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_process_each DP_SIZED_NAME(dp_process_each)
#define dp_recv_idle DP_SIZED_NAME(dp_recv_idle)
#define dp_init DP_SIZED_NAME(dp_init)
#endif

/** Major version of the library that this header belongs to; dp_version() returns that of the one that is linked. */
#define DP_VERSION_MAJOR 1
/** Its minor version. */
#define DP_VERSION_MINOR 0
/** Its patch level. */
#define DP_VERSION_PATCH 0
/** All of them, as dp_version() spells them. */
#define DP_VERSION_STRING "1.0.0"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Receives a message from `dp_process_each`, gone when this returns, and that one's usr. Any result but 0 stops it.
 *
 *     int on_msg(const struct protocol_msg *msg, void *usr)
 *     {
 *         handle(msg);
 *         return 0;
 *     }
 */
typedef int (*dp_msg_func_t)(const struct protocol_msg *msg, void *usr);

/**
 * Adds any number of received bytes, and calls `on_msg` for each message as soon as it is complete.
 *
 * Does what `dp_process` and `dp_recv` do, but never overflows: the ring is emptied whenever it is full. Messages that
 * are in the ring already come first. buf's bytes stay as they are until the call returns.
 *
 * Returns how many of the bytes were taken: all of them unless `on_msg` stopped it. Nothing is lost then: give the
 * rest to the next call, which goes on with the next message. Returns -`DP_RC_ERROR_GENERIC` when data or `on_msg` is
 * NULL, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     dp_process_each(&ring, in, got, on_msg, NULL);
 */
int dp_process_each(struct protocol_data *data, const void *buf, int bytes, dp_msg_func_t on_msg, void *usr)
    DP_SIZED(dp_process_each);

/**
 * Like `dp_recv`, for a line that has been quiet for longer than a frame takes (37 bytes at 115200 baud: 3.2 ms): what
 * is incomplete by then, most likely noise that looks like the beginning of a frame, is given up, and what stands
 * behind it delivered.
 *
 * Returns `DP_RC_SUCCESS` and the message, `DP_RC_GARBAGE` when bytes were thrown away and the ring is empty now,
 * `DP_RC_NO_FRAME` when it was empty before, or `DP_RC_ERROR_GENERIC` when a pointer is NULL; sets `opcode` as
 * `dp_recv` does.
 *
 *     if (now_ms() - heard_at >= 10)
 *         while (dp_recv_idle(&ring, &msg) == DP_RC_SUCCESS)
 *             handle(&msg);
 */
int dp_recv_idle(struct protocol_data *data, struct protocol_msg *msg) DP_SIZED(dp_recv_idle);

/**
 * Makes an empty ring of any memory, as setting it to zero does; the library's safety never needs that. Returns
 * `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when data is NULL.
 *
 *     struct protocol_data ring;
 *     dp_init(&ring);
 */
int dp_init(struct protocol_data *data) DP_SIZED(dp_init);

/**
 * Returns the library's version, e.g. "1.0.0", a string that lives as long as the program: compare it with the
 * header's, `DP_VERSION_STRING`.
 *
 *     if (strcmp(dp_version(), DP_VERSION_STRING) != 0)
 *         printf("compiled for libdeltarobot %s, running with %s\n", DP_VERSION_STRING, dp_version());
 */
const char *dp_version(void);

#ifdef __cplusplus
}
#endif

#endif
