/**
 * @file
 * ContouringProtocol.h: vector moves of the GX binary vector protocol, packed and unpacked. It takes the place of
 * the header that came with the proposal; libdeltarobot/gx.h has what that lacks.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/contouring_protocol.rs by `make header`.
 */
#ifndef CONTOURINGPROTOCOL_H
#define CONTOURINGPROTOCOL_H

#include "libdeltarobot/abi.h"

LIBDELTAROBOT_NOT_PACKED(contouring_protocol);

#include <stdint.h>
/* Programs written for the posted header may use u_int8_t and the like. */
#if defined(__AVR__) || defined(_WIN32)
typedef uint8_t u_int8_t;
typedef uint16_t u_int16_t;
typedef uint32_t u_int32_t;
#else
#include <sys/types.h>
#endif

/* Bits of axisMask. (They were lost from the post; bit i is axisPosition[i].) */
enum
{
  CPMask_x = 1,
  CPMask_y = 2,
  CPMask_z = 4,
  CPMask_a = 8,
  CPMask_b = 16,
  CPMask_c = 32,
  CPMask_velocity = 64
};

/* Indices of axisPosition. */
enum
{
  CPAxis_x = 0,
  CPAxis_y,
  CPAxis_z,
  CPAxis_a,
  CPAxis_b,
  CPAxis_c
};

#ifdef __cplusplus
extern "C" {
#endif

/** Done. The numbers of these codes are those of `GX_RC_*` in libdeltarobot/gx.h. */
#define CPResult_ok 0
/** A pointer is NULL, or the mask is empty. */
#define CPResult_error 1
/** The buffer does not hold what it should: start byte, mask, high bits and length are looked at. */
#define CPResult_malformed 8
/** A value does not fit, or the mask has bits that mean nothing. */
#define CPResult_range 10

/** A packed vector move. */
typedef struct {
  /** How many of the bytes there are: 3 to 28, or 0 when packing failed. */
  uint8_t length;
  /** The bytes, as they are sent. */
  uint8_t bytes[28];
} CPPackedVectorCommandBuffer;

/** A vector move. */
typedef struct {
  /** The feed rate along the vector, in steps per second: 0 to 16383. */
  uint16_t targetVelocity;
  /** Which of the values are valid: `CPMask_*`. */
  uint8_t axisMask;
  /** x, y, z, a, b, c in steps, -134217728 to 134217727; deltas with PackCPShortVectorCommand, and there only. */
  int32_t axisPosition[6];
} CPVectorCommand;

/** A value of 7 bits: one byte with the high bit set. */
typedef uint8_t CPPacked7[1];

/** A value of 14 bits: two of them, the less significant first. */
typedef uint8_t CPPacked14[2];

/** A value of 28 bits: four of them, the least significant first. */
typedef uint8_t CPPacked28[4];

/**
 * Packs a vector of positions: the long form. Values that axisMask does not flag are not looked at. The posted code
 * packed only the lowest bits of values that do not fit, and added to a length that nobody had set.
 *
 * Returns 0; or, the buffer's length being 0 then, `CPResult_range` when a flagged value or the mask does not fit,
 * `CPResult_error` when the mask is empty or a pointer is NULL.
 *
 *     CPVectorCommand command = {500, CPMask_x | CPMask_velocity, {1000, 0, 0, 0, 0, 0}};
 *     CPPackedVectorCommandBuffer buffer;
 *     if (PackCPVectorCommand(&buffer, &command) == CPResult_ok)
 *         uart_write(&uart, buffer.bytes, buffer.length);
 */
int PackCPVectorCommand(CPPackedVectorCommandBuffer *buffer, CPVectorCommand *command);

/**
 * Unpacks a vector of positions: the long form. Values that are not in it stay as they were, the velocity too. The
 * posted code got positions from 2097152 and below 0 wrong, and took any bytes for a command.
 *
 * Returns 0; or, the command left as it was, `CPResult_malformed` when the buffer does not hold a long form and
 * nothing else, `CPResult_error` when a pointer is NULL.
 *
 *     CPVectorCommand command;
 *     if (UnpackCPVectorCommand(&buffer, &command) == CPResult_ok && (command.axisMask & CPMask_x) != 0)
 *         printf("x to %ld\n", (long)command.axisPosition[CPAxis_x]);
 */
int UnpackCPVectorCommand(CPPackedVectorCommandBuffer *buffer, CPVectorCommand *command);

/**
 * Packs a vector of deltas: the short form. axisPosition holds how far each axis shall go on, -63 to 63 steps, not
 * where to. Returns what PackCPVectorCommand does.
 *
 *     CPVectorCommand deltas = {0, CPMask_x | CPMask_y, {10, -10, 0, 0, 0, 0}};
 *     if (PackCPShortVectorCommand(&buffer, &deltas) == CPResult_ok)
 *         uart_write(&uart, buffer.bytes, buffer.length);
 */
int PackCPShortVectorCommand(CPPackedVectorCommandBuffer *buffer, CPVectorCommand *command);

/**
 * Unpacks a vector of deltas, the short form, and adds them to the positions: axisPosition holds where the axes are
 * before the call, and where they shall go after it. Values that are not in it stay as they were, the velocity too. The
 * posted code took any bytes for a command, and let the sum overflow.
 *
 * Returns 0; or, the command left as it was, `CPResult_range` when a sum is no position (28 bits), and else, of the
 * short form, what UnpackCPVectorCommand does.
 *
 *     if (UnpackCPShortVectorCommand(&buffer, &command) == CPResult_ok)
 *         printf("x to %ld\n", (long)command.axisPosition[CPAxis_x]);
 */
int UnpackCPShortVectorCommand(CPPackedVectorCommandBuffer *buffer, CPVectorCommand *command);

#ifdef __cplusplus
}
#endif

#endif
