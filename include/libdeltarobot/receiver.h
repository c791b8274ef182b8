/**
 * @file
 * libdeltarobot/receiver.h: a receiver of frames that is smaller and faster than the drop-in ring: it owns the
 * buffer of one frame.
 *
 * Each byte from the line is stored, in an interrupt if need be; what it means is found out later, where messages are
 * fetched:
 *
 *     struct protocol_msg msg;
 *
 *     if (dp_receiver_byte(&receiver, byte))
 *         while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
 *             handle(&msg);
 *
 * Every intact frame is found, as `dp_recv` finds it: behind a byte that begins none, the search goes on with the next
 * one; what may become a frame is waited for.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/receiver.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_RECEIVER_H
#define LIBDELTAROBOT_RECEIVER_H

#include "abi.h"
#include "protocol_ext.h"

LIBDELTAROBOT_NOT_PACKED(receiver);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_receiver_init DP_SIZED_NAME(dp_receiver_init)
#define dp_receiver_byte DP_SIZED_NAME(dp_receiver_byte)
#define dp_receiver_next DP_SIZED_NAME(dp_receiver_next)
#define dp_receiver_idle DP_SIZED_NAME(dp_receiver_idle)
#define dp_receiver_each DP_SIZED_NAME(dp_receiver_each)
#endif

/** Words of a receiver's room. */
#define DP_RECEIVER_WORDS ((DP_DATA_MAX_SIZE + 15 + sizeof(unsigned long)) / sizeof(unsigned long))

#ifdef __cplusplus
extern "C" {
#endif

/** A receiver. All zero is one that has received nothing. */
struct dp_receiver {
  unsigned long opaque[DP_RECEIVER_WORDS];
};

/**
 * Makes an empty receiver of any memory, as setting it to zero does; the library's safety never needs that. Returns
 * `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when receiver is NULL.
 *
 *     struct dp_receiver receiver;
 *     dp_receiver_init(&receiver);
 */
int dp_receiver_init(struct dp_receiver *receiver) DP_SIZED(dp_receiver_init);

/**
 * Takes a received byte. It only stores the byte and compares a count, so that it fits an interrupt;
 * `dp_receiver_next` must not run at the same time.
 *
 * Returns 0, or 1 when `dp_receiver_next` is to be called, at once or a few bytes later: what comes meanwhile is kept
 * as long as there is room. When there is none, -`DP_RC_OVERFLOW` is returned and the byte is not taken: call
 * `dp_receiver_next`, then give it again. Returns -`DP_RC_ERROR_GENERIC` when receiver is NULL.
 *
 *     if (dp_receiver_byte(&receiver, byte))
 *         fetch = 1;
 */
int dp_receiver_byte(struct dp_receiver *receiver, unsigned char byte) DP_SIZED(dp_receiver_byte);

/**
 * Fetches the next message: to be called until it does not return `DP_RC_SUCCESS`.
 *
 * Returns `DP_RC_SUCCESS` and the message, `DP_RC_NO_FRAME` when more bytes are needed, `DP_RC_GARBAGE` when more are
 * needed and some that can't be part of a frame were thrown away, or `DP_RC_ERROR_GENERIC` when a pointer is NULL.
 * Without a message, `opcode` is set to 0xFF and the rest of msg is left as it was.
 *
 *     struct protocol_msg msg;
 *     while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
 *         handle(&msg);
 */
int dp_receiver_next(struct dp_receiver *receiver, struct protocol_msg *msg) DP_SIZED(dp_receiver_next);

/**
 * Fetches the next message when the line has been quiet for longer than a frame takes, as `dp_recv_idle` does: what is
 * incomplete is given up, and what stands behind it delivered.
 *
 * Returns what `dp_recv_idle` does.
 *
 *     if (now_ms() - heard_at >= 10)
 *         while (dp_receiver_idle(&receiver, &msg) == DP_RC_SUCCESS)
 *             handle(&msg);
 */
int dp_receiver_idle(struct dp_receiver *receiver, struct protocol_msg *msg) DP_SIZED(dp_receiver_idle);

/**
 * Takes any number of received bytes, and calls `on_msg` for each message as soon as it is complete. Frames that lie
 * in buf are not copied into the receiver. buf's bytes stay as they are until the call returns.
 *
 * Returns what `dp_process_each` does, receiver in place of data.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     dp_receiver_each(&receiver, in, got, on_msg, NULL);
 */
int dp_receiver_each(struct dp_receiver *receiver, const void *buf, int bytes, dp_msg_func_t on_msg, void *usr)
    DP_SIZED(dp_receiver_each);

#ifdef __cplusplus
}
#endif

#endif
