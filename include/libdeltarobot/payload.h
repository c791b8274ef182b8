/**
 * @file
 * libdeltarobot/payload.h: building, reading and printing the messages of the specification.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/payload.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_PAYLOAD_H
#define LIBDELTAROBOT_PAYLOAD_H

#include "abi.h"
#include "protocol.h"

LIBDELTAROBOT_NOT_PACKED(payload);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_build DP_SIZED_NAME(dp_build)
#define dp_build_ack DP_SIZED_NAME(dp_build_ack)
#define dp_build_nack DP_SIZED_NAME(dp_build_nack)
#define dp_build_move DP_SIZED_NAME(dp_build_move)
#define dp_build_status_report DP_SIZED_NAME(dp_build_status_report)
#define dp_msg_check DP_SIZED_NAME(dp_msg_check)
#define dp_read_answer DP_SIZED_NAME(dp_read_answer)
#define dp_read_move DP_SIZED_NAME(dp_read_move)
#define dp_read_status_report DP_SIZED_NAME(dp_read_status_report)
#define dp_msg_format DP_SIZED_NAME(dp_msg_format)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Reading a status report: one of more than 13 bytes has the floats first. 13 bytes may be either layout (firmware
 * like the shipped one sends so many on AVR); the reading counts in which more is plausible: STAT, when its reserved
 * bits (5 to 7) are alike; each float that is zero or of a magnitude from 1.1e-19 to 3.6e19; and twice as much each
 * that is unknown, 0x7F800001 or 0x7FC00000 with either sign. Of equal ones it is floats first. A session of `host.h`
 * takes the layout of the last report that was clear (of 14 bytes or more, or better by two), unless this one is too.
 * Writing one: as `DP_LAYOUT_FIRMWARE`.
 */
#define DP_LAYOUT_AUTO 0

/** Status reports as in specification v1.0: STAT, DA, DB, DC; exactly 13 bytes. */
#define DP_LAYOUT_SPEC 1
/** Status reports as shipped firmware sends them: DA, DB, DC, STAT, 3 bytes, written as 0; read from 13 bytes on. */
#define DP_LAYOUT_FIRMWARE 2
/** Size of a buffer that the text of any message fits in. */
#define DP_MSG_TEXT_MAX 96

/**
 * Builds a message without payload: `DP_OPCODE_HOMING`, `STATUS`, `CANCEL`, `HOMING_REPL`, `MOVE_REPL`, `GENERAL_ERR`.
 *
 * Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` and leaves msg alone when it is NULL or opcode none of these.
 *
 *     if (dp_build(&msg, DP_OPCODE_STATUS) == DP_RC_SUCCESS)
 *         dp_send(&msg, uart_send, &uart);
 */
int dp_build(struct protocol_msg *msg, unsigned char opcode) DP_SIZED(dp_build);

/**
 * Builds an acknowledgement of the request with the opcode answered, which is not checked. Returns `DP_RC_SUCCESS`, or
 * `DP_RC_ERROR_GENERIC` when msg is NULL.
 *
 *     struct protocol_msg answer;
 *     dp_build_ack(&answer, msg.opcode);
 *     dp_send(&answer, uart_send, &uart);
 */
int dp_build_ack(struct protocol_msg *msg, unsigned char answered) DP_SIZED(dp_build_ack);

/**
 * Builds a refusal, as `dp_build_ack` builds an acknowledgement.
 *
 *     struct protocol_msg answer;
 *     dp_build_nack(&answer, DP_OPCODE_MOVE);
 *     dp_send(&answer, uart_send, &uart);
 */
int dp_build_nack(struct protocol_msg *msg, unsigned char answered) DP_SIZED(dp_build_nack);

/**
 * Builds a request to move to a position. Its floats are copied bit by bit, NaNs too. Returns `DP_RC_SUCCESS`, or
 * `DP_RC_ERROR_GENERIC` and leaves msg alone when a pointer is NULL or `DP_DATA_MAX_SIZE` below 12.
 *
 *     const struct protocol_msg_position target = {1, 2, -3.5f};
 *     if (dp_build_move(&msg, &target) == DP_RC_SUCCESS)
 *         dp_send(&msg, uart_send, &uart);
 */
int dp_build_move(struct protocol_msg *msg, const struct protocol_msg_position *target) DP_SIZED(dp_build_move);

/**
 * Builds a status report in a layout, `DP_LAYOUT_*`. Floats are copied bit by bit, reserved bits of STAT cleared.
 *
 * Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when a pointer is NULL, the layout is none of these, or
 * `DP_DATA_MAX_SIZE` is below the 16 or 13 bytes that it takes: msg is left as it was.
 *
 *     const struct protocol_msg_status_report report = {1, 2, -3.5f, DP_STATUS_IDLE | DP_BIT_STAT_STOP_A_BIT};
 *     if (dp_build_status_report(&msg, &report, DP_LAYOUT_FIRMWARE) == DP_RC_SUCCESS)
 *         dp_send(&msg, uart_send, &uart);
 */
int dp_build_status_report(struct protocol_msg *msg, const struct protocol_msg_status_report *report, int layout)
    DP_SIZED(dp_build_status_report);

/**
 * Whether a message is one of the specification's, with a known opcode and a payload of its length. Returns
 * `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when it is not or msg is NULL.
 *
 *     while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
 *         if (dp_msg_check(&msg) == DP_RC_SUCCESS)
 *             handle(&msg);
 */
int dp_msg_check(const struct protocol_msg *msg) DP_SIZED(dp_msg_check);

/**
 * Reads from an ack or a nack which opcode it answers. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, answered left
 * as it was, when msg is neither or not 1 byte long, or a pointer is NULL.
 *
 *     unsigned char answered;
 *     if (msg.opcode == DP_OPCODE_NACK && dp_read_answer(&msg, &answered) == DP_RC_SUCCESS)
 *         printf("refused: %s\n", dp_opcode_name(answered));
 */
int dp_read_answer(const struct protocol_msg *msg, unsigned char *answered) DP_SIZED(dp_read_answer);

/**
 * Reads from a request to move where to; the floats, copied bit by bit, may be NaNs. Returns `DP_RC_SUCCESS`, or
 * `DP_RC_ERROR_GENERIC`, target left as it was, when msg is no such request or not 12 bytes long, or a pointer is NULL.
 *
 *     struct protocol_msg_position target;
 *     if (dp_read_move(&msg, &target) == DP_RC_SUCCESS)
 *         motors_move(target.DA, target.DB, target.DC);
 */
int dp_read_move(const struct protocol_msg *msg, struct protocol_msg_position *target) DP_SIZED(dp_read_move);

/**
 * Reads a status report of a layout, `DP_LAYOUT_*`. The floats are copied bit by bit: an unknown position is a NaN, a
 * signalling one from shipped firmware. Reserved bits of STAT are cleared.
 *
 * Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, report left as it was, when msg is no status report or of a
 * length that the layout does not have, the layout is none of these, or a pointer is NULL.
 *
 *     struct protocol_msg_status_report report;
 *     if (dp_read_status_report(&msg, DP_LAYOUT_AUTO, &report) == DP_RC_SUCCESS)
 *         is_idle = (report.STAT & DP_BIT_STAT_STATUS_BITS) == DP_STATUS_IDLE;
 */
int dp_read_status_report(const struct protocol_msg *msg, int layout, struct protocol_msg_status_report *report)
    DP_SIZED(dp_read_status_report);

/**
 * Returns the name of an opcode for logs, a string that lives as long as the program: `ACK`, `NACK`, `HOMING!`,
 * `STATUS?`, `MOVE!`, `CANCEL!`, `HOMING_REPLY`, `STATUS_REPLY`, `MOVE_REPLY`, `GENERAL_ERROR` or `UNKNOWN_OPCODE`.
 *
 *     printf("%s, %d bytes\n", dp_opcode_name(msg.opcode), msg.data_s);
 */
const char *dp_opcode_name(unsigned char opcode);

/**
 * Writes a message as a line of text without a line's end, such as `STATUS_REPLY: IDLE  DA=0  DB=0  DC=-3.5 STP_A`.
 *
 * snprintf's rules: of a text that does not fit, as much as does is written, always a zero byte behind it; with cap 0
 * nothing is written and buf may be NULL. No text reaches `DP_MSG_TEXT_MAX`. Numbers are written as `%g` writes them.
 * Status reports are read as `DP_LAYOUT_AUTO`; a payload of the wrong length is not shown.
 *
 * Returns the length of the whole text without the zero byte, or -`DP_RC_ERROR_GENERIC` when msg is NULL, cap is
 * negative, or buf is NULL and cap is not 0.
 *
 *     char text[DP_MSG_TEXT_MAX];
 *     if (dp_msg_format(&msg, text, sizeof text) > 0)
 *         puts(text);
 */
int dp_msg_format(const struct protocol_msg *msg, char *buf, int cap) DP_SIZED(dp_msg_format);

#ifdef __cplusplus
}
#endif

#endif
