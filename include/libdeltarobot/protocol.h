/**
 * @file
 * libdeltarobot/protocol.h: frames of the deltarobot message format, specification v1.0.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/protocol.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_PROTOCOL_H
#define LIBDELTAROBOT_PROTOCOL_H

#include "abi.h"

LIBDELTAROBOT_NOT_PACKED(protocol);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_process DP_SIZED_NAME(dp_process)
#define dp_recv DP_SIZED_NAME(dp_recv)
#define dp_send DP_SIZED_NAME(dp_send)
#endif

/** First byte of every frame. */
#define DP_PROTO_FRAME_START '$'
/** Last byte of every frame. */
#define DP_PROTO_FRAME_END ':'

/** All opcodes, see the specification's section "Opcodes". */
#define DP_PROTO_ALL_OPCODES "ANHSMChsme"
/** Either way: accepted. The payload is the opcode that is answered. */
#define DP_OPCODE_ACK ((unsigned char)'A')
/** Either way: refused. The payload is the opcode that is answered. */
#define DP_OPCODE_NACK ((unsigned char)'N')
/** Host to controller: home. */
#define DP_OPCODE_HOMING ((unsigned char)'H')
/** Host to controller: report the status. */
#define DP_OPCODE_STATUS ((unsigned char)'S')
/** Host to controller: move. The payload is a struct protocol_msg_position. */
#define DP_OPCODE_MOVE ((unsigned char)'M')
/** Host to controller: cancel the operation. */
#define DP_OPCODE_CANCEL ((unsigned char)'C')
/** Controller to host: homing has finished. */
#define DP_OPCODE_HOMING_REPL ((unsigned char)'h')
/** Controller to host: the status. The payload is a struct protocol_msg_status_report. */
#define DP_OPCODE_STATUS_REPL ((unsigned char)'s')
/** Controller to host: the move has finished. */
#define DP_OPCODE_MOVE_REPL ((unsigned char)'m')
/** Controller to host: general error. */
#define DP_OPCODE_GENERAL_ERR ((unsigned char)'e')

/** Position of end stop A's bit in STAT (1 = pressed); bits 5 to 7 are reserved. */
#define DP_BIT_STAT_STOP_A_BIT (1 << 2)
/** Position of end stop B's bit in STAT. */
#define DP_BIT_STAT_STOP_B_BIT (1 << 3)
/** Position of end stop C's bit in STAT. */
#define DP_BIT_STAT_STOP_C_BIT (1 << 4)

#ifdef __cplusplus
extern "C" {
#endif

/** The operation completed. */
#define DP_RC_SUCCESS 0
/** A NULL pointer or a size out of range: nothing was done. */
#define DP_RC_ERROR_GENERIC 1
/** No frame is complete yet. */
#define DP_RC_NO_FRAME 2
/** The ring was too full: its oldest bytes, or bytes that it can't hold at all, were lost. */
#define DP_RC_OVERFLOW 3
/** Bytes that can't be part of a frame were thrown away, and no frame is complete yet. */
#define DP_RC_GARBAGE 4
/** State of the platform: idle. */
#define DP_STATUS_IDLE 0
/** State of the platform: homing. */
#define DP_STATUS_HOMING 1
/** State of the platform: moving. */
#define DP_STATUS_MOVING 2
/** State of the platform: at error. */
#define DP_STATUS_ERROR 3
/** The bits of STAT that hold the state. */
#define DP_BIT_STAT_STATUS_BITS 3
/** STAT's state bits: idle. */
#define DP_BIT_STAT_STATUS_IDLE 0
/** STAT's state bits: homing. */
#define DP_BIT_STAT_STATUS_HOMING 1
/** STAT's state bits: moving. */
#define DP_BIT_STAT_STATUS_MOVING 2
/** STAT's state bits: at error. */
#define DP_BIT_STAT_STATUS_ERROR 3
/** An end stop's bit, shifted down: pressed. */
#define DP_BIT_STAT_STOP_PRESSED 1
/** An end stop's bit, shifted down: not pressed. */
#define DP_BIT_STAT_STOP_CLEAR 0

/**
 * A ring buffer for bytes from the wire; all zero is an empty one.
 *
 * The fields can be read at any time. They are never trusted: a ring whose `m_idx` or `m_sz` is out of range counts as
 * empty, so an uninitialised one does no harm.
 */
struct protocol_data {
  /** Storage of the ring. */
  char m_buf[DP_BUFSIZE];
  /** Where the first unread byte is, 0 to `DP_BUFSIZE` - 1. */
  int m_idx;
  /** Number of unread bytes, 0 to `DP_BUFSIZE`. */
  int m_sz;
};

/** One message: what a frame carries. */
struct protocol_msg {
  /** What the message is, one of `DP_OPCODE_*`; 0xFF after a call that received none. */
  unsigned char opcode;
  /** Number of bytes in data, 0 to `DP_DATA_MAX_SIZE`. */
  int data_s;
  /** The payload. Receiving leaves the bytes from `data_s` on as they are. */
  char data[DP_DATA_MAX_SIZE];
  /** 1 in a received message. Ignored when sending. */
  int checksum_ok;
};

/**
 * Writes a whole frame of bytes bytes somewhere; usr is what `dp_send` was given. `dp_send` returns its result.
 * The frame may be changed, and is gone when the function returns.
 *
 *     int uart_send(void *buf, int bytes, void *usr)
 *     {
 *         return uart_write((struct uart *)usr, buf, bytes) == bytes ? 0 : -1;
 *     }
 */
typedef int (*send_func_t)(void *buf, int bytes, void *usr);

/**
 * The payload of a status report as shipped firmware sends it: 16 bytes with the padding. Displacements are in the
 * firmware's own unit, as the specification names none.
 */
struct protocol_msg_status_report {
  /** Displacement of arm A; a NaN when unknown. */
  float DA;
  /** Displacement of arm B; a NaN when unknown. */
  float DB;
  /** Displacement of arm C; a NaN when unknown. */
  float DC;
  /** State and end stops, see `DP_BIT_STAT_*`. */
  unsigned char STAT;
};

/** The payload of a move request: 12 bytes, in the unit of status reports. */
struct protocol_msg_position {
  /** Displacement of arm A. */
  float DA;
  /** Displacement of arm B. */
  float DB;
  /** Displacement of arm C. */
  float DC;
};

/**
 * Adds received bytes at the ring's end.
 *
 * When they do not fit, the oldest bytes make room; of more than `DP_BUFSIZE` bytes the first `DP_BUFSIZE` are taken.
 * Not for an interrupt that may come during another call on the ring: there, put bytes into a queue of your own.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_OVERFLOW` when bytes were lost, or `DP_RC_ERROR_GENERIC` when data is NULL, bytes is
 * negative, or buf is NULL and bytes is not 0.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     if (dp_process(&ring, in, got) == DP_RC_OVERFLOW)
 *         ++losses;
 */
int dp_process(struct protocol_data *data, void *buf, int bytes) DP_SIZED(dp_process);

/**
 * Takes the next message out of the ring.
 *
 * An incomplete frame at the ring's start is waited for, whatever stands behind it; bytes that can't be part of a frame
 * are thrown away.
 *
 * Returns `DP_RC_SUCCESS` and the message, `DP_RC_NO_FRAME` when more bytes are needed, `DP_RC_GARBAGE` when more are
 * needed and some were thrown away, or `DP_RC_ERROR_GENERIC` when a pointer is NULL. Without a message, only `opcode`
 * is set, to 0xFF.
 *
 *     struct protocol_msg msg;
 *     while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
 *         handle(&msg);
 */
int dp_recv(struct protocol_data *data, struct protocol_msg *msg) DP_SIZED(dp_recv);

/**
 * Sends a message, whose opcode is not checked: calls sendfunc once, with the whole frame and usr.
 *
 * Returns what sendfunc returned, or `DP_RC_ERROR_GENERIC` without calling it when msg or sendfunc is NULL or `data_s`
 * is outside 0 to `DP_DATA_MAX_SIZE`.
 *
 *     msg.opcode = DP_OPCODE_HOMING;
 *     msg.data_s = 0;
 *     dp_send(&msg, uart_send, &uart);
 */
int dp_send(struct protocol_msg *msg, send_func_t sendfunc, void *usr) DP_SIZED(dp_send);

#ifdef __cplusplus
}
#endif

#endif
