/**
 * @file
 * libdeltarobot/gx.h: commands and notices of the GX binary vector protocol.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/gx.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_GX_H
#define LIBDELTAROBOT_GX_H

#include "abi.h"

LIBDELTAROBOT_NOT_PACKED(gx);

#include <stdint.h>

/* Bits of a vector's mask: 1 << i flags axes[i], which are x, y, z, a, b, c. */
#define GX_MASK_AXES 0x3F
#define GX_MASK_VELOCITY 0x40

/* Positions in steps: 28 bits. */
#define GX_POSITION_MIN (-134217728)
#define GX_POSITION_MAX 134217727

/** Words of a struct gx_commands and a struct gx_notices. */
#define GX_RECEIVER_WORDS (48 / sizeof(unsigned long))
/** Words of a struct gx_contour. */
#define GX_CONTOUR_WORDS (64 / sizeof(unsigned long))

#ifdef __cplusplus
extern "C" {
#endif

/** Done. */
#define GX_RC_SUCCESS 0
/** An argument was NULL or none of its values: nothing was done. */
#define GX_RC_ERROR_GENERIC 1
/** The room is too small. */
#define GX_RC_OVERFLOW 3
/** There is no room until something was fetched. */
#define GX_RC_BUSY 5
/** Nothing has happened, or nothing is there. */
#define GX_RC_NO_EVENT 6
/** A value does not fit where it has to go. */
#define GX_RC_RANGE 10
/** It starts from a position that is not known. */
#define GX_RC_NOT_FOUND 11
/** Written with packed bytes. */
#define GX_BINARY 1
/** Written as text. */
#define GX_ASCII 2
/** Nothing is complete. */
#define GX_NONE 0
/** Command: go to the positions in vector (long form or ASCII); without axes, set the velocity of those to come. */
#define GX_MOVE 1
/** Command: go on by the deltas in vector, each -64 to 63 steps (short form). */
#define GX_STEP 2
/** Command: report the position each period milliseconds. */
#define GX_REPORTING 3
/** A command or notice that is none; code says what is wrong with it. */
#define GX_MALFORMED 4
/** Notice: the command with this number was carried out. */
#define GX_COMPLETED 5
/** Notice: the command, with this number if it had one, was not; code says why. */
#define GX_REFUSED 6
/** Notice: the position is that in vector; with a velocity, which is in force, the machine was stopped there. */
#define GX_POSITION 7
/** Notice, in sessions: the move whose number ends in these seven bits was carried out; code is its `gx_check`. */
#define GX_CONFIRMED 8
/** Command, an extension: what code asks for past the queue, one of `GX_CONTROL_*`. */
#define GX_CONTROL 9
/** Notice, an extension: period more moves fit into the queue, and the machine holds if code is not 0. */
#define GX_STATUS 10
/** The status. */
#define GX_CONTROL_QUERY 0
/** To hold now: to pause, in the middle of a move too. */
#define GX_CONTROL_HOLD 1
/** To go on. */
#define GX_CONTROL_RESUME 2
/** To stop now, and to forget all moves. */
#define GX_CONTROL_STOP 3
/** What is received and none of these. */
#define GX_CONTROL_UNKNOWN 127
/** No command begins like that. */
#define GX_FAULT_UNKNOWN 1
/** No number from 0 to 16383. Text behind it is skipped; `!`, `*` or `~` begins a command without a number. */
#define GX_FAULT_NUMBER 2
/** Another began before this was complete, or the line fell silent. */
#define GX_FAULT_INTERRUPTED 3
/** A byte that has no place there. */
#define GX_FAULT_SYNTAX 4
/** It names no axis and no velocity. */
#define GX_FAULT_EMPTY 5
/** It names an axis, or the velocity, twice. */
#define GX_FAULT_REPEATED 6
/** A value does not fit. */
#define GX_FAULT_RANGE 7
/** A step leads out of the positions that there are, or starts where the position is not known. */
#define GX_FAULT_LIMIT 8
/** There is no room for another command. */
#define GX_FAULT_BUSY 9
/** The number is not the next of its session. */
#define GX_FAULT_ORDER 16
/** A session is over, or none has begun and moves are taken in sessions only. */
#define GX_FAULT_CLOSED 17
/** A move without a number where numbers are in order. */
#define GX_FAULT_NUMBERLESS 18
/** The machine does not have that axis. */
#define GX_FAULT_AXIS 19
/** The machine has stopped before this move was finished; those behind it are dropped. */
#define GX_FAULT_STOPPED 20
/** The machine has stopped as its host was silent. */
#define GX_FAULT_SILENT 21
/** Codes from here to 127 are the firmware's own. */
#define GX_FAULT_OWN 64
/** The axes: x, y, z, a, b, c. */
#define GX_AXES 6
/** The largest delta that is written, either way. */
#define GX_DELTA_MAX 63
/** The largest velocity, in steps per second. */
#define GX_VELOCITY_MAX 16383
/** The largest number of a command. */
#define GX_NUMBER_MAX 16383
/** The longest period of position reports, in milliseconds. */
#define GX_PERIOD_MAX 16383
/** Room that any one command or notice fits in, in bytes. */
#define GX_ENCODED_MAX 96

/** Receives commands: the motion side's. All zero is a new one. Its contents are private. */
struct gx_commands {
  unsigned long opaque[GX_RECEIVER_WORDS];
};

/** The number of a command. */
struct gx_number {
  /** 0 to 16383. */
  uint16_t value;
  /** How it is written: `GX_BINARY` or `GX_ASCII`; 0: there is none. */
  unsigned char format;
};

/** Axes and velocity: a target, the deltas of a step, or a position. */
struct gx_vector {
  /** Along the vector, in steps per second: 0 to 16383. */
  uint16_t velocity;
  /** Which of the values mean something: bit i is `axes[i]`, bit 6 `velocity`. */
  unsigned char mask;
  /** x, y, z, a, b, c in steps: positions are -134217728 to 134217727. */
  int32_t axes[GX_AXES];
};

/** What a receiver has found: a command, a notice, a malformed one, or nothing. */
struct gx_item {
  /** What it is: `GX_NONE`, `GX_MOVE` ... */
  int kind;
  /** The number of the command; its format is 0 when it has none. */
  struct gx_number number;
  /** `GX_BINARY` or `GX_ASCII`: how the command or notice was written. */
  unsigned char format;
  /** Of `GX_MALFORMED`: `GX_FAULT_*`. Of `GX_REFUSED`: one of these, or the controller's own, 0 to 127. */
  unsigned char code;
  /** Of `GX_REPORTING`: milliseconds between two reports, 0 to 16383; 0: none are wanted. */
  uint16_t period;
  /** Positions; of `GX_STEP` deltas, to be added to them. Values that its mask does not flag are 0. */
  struct gx_vector vector;
};

/** Receives notices: the host's. All zero is a new one. Its contents are private. */
struct gx_notices {
  unsigned long opaque[GX_RECEIVER_WORDS];
};

/** Writes a path as the shortest stream of commands. All zero is a path of no axis. Its contents are private. */
struct gx_contour {
  unsigned long opaque[GX_CONTOUR_WORDS];
};

/**
 * Makes a receiver of commands of any memory. Zeroed memory is one too. Returns `GX_RC_SUCCESS`, or
 * `GX_RC_ERROR_GENERIC` when commands is NULL.
 *
 *     struct gx_commands commands;
 *     gx_commands_init(&commands);
 */
int gx_commands_init(struct gx_commands *commands);

/**
 * Takes received bytes up to the end of a command, which item receives; if none ends there, all of them, and item is
 * `GX_NONE`. A malformed command is one `GX_MALFORMED`, with its number if that was complete. To be called as long as
 * bytes are left: it may take none of them and report that what came before is malformed.
 *
 * Returns the number of bytes taken, or -`GX_RC_ERROR_GENERIC` when a pointer is NULL (buf may be if bytes is 0) or
 * bytes is negative.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     for (int taken = 0; taken < got; handle_item(&item))
 *         taken += gx_commands_receive(&commands, in + taken, got - taken, &item);
 */
int gx_commands_receive(struct gx_commands *commands, const void *buf, int bytes, struct gx_item *item);

/**
 * To be called when the line has been quiet for longer than a command takes: a command that is incomplete is given up
 * and item is `GX_MALFORMED`. Else item is `GX_NONE`. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer
 * is NULL.
 *
 *     if (now_ms() - heard_at >= 20 && gx_commands_idle(&commands, &item) == GX_RC_SUCCESS)
 *         handle_item(&item);
 */
int gx_commands_idle(struct gx_commands *commands, struct gx_item *item);

/**
 * Makes a receiver of notices of any memory, as `gx_commands_init` makes one of commands.
 *
 *     struct gx_notices notices;
 *     gx_notices_init(&notices);
 */
int gx_notices_init(struct gx_notices *notices);

/**
 * Takes received bytes up to the end of a notice, which item receives: see `gx_commands_receive`. A packed number is a
 * whole notice, but may begin an error notice too: it is reported when the next byte has come, or by
 * `gx_notices_idle`. Returns what `gx_commands_receive` does.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     for (int taken = 0; taken < got; handle_item(&item))
 *         taken += gx_notices_receive(&notices, in + taken, got - taken, &item);
 */
int gx_notices_receive(struct gx_notices *notices, const void *buf, int bytes, struct gx_item *item);

/**
 * To be called when the line has been quiet for longer than a notice takes: reports the completion that could have
 * become an error notice, and anything else that is incomplete as `GX_MALFORMED`. Else item is `GX_NONE`. Returns
 * `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     if (now_ms() - heard_at >= 20 && gx_notices_idle(&notices, &item) == GX_RC_SUCCESS)
 *         handle_item(&item);
 */
int gx_notices_idle(struct gx_notices *notices, struct gx_item *item);

/**
 * Takes a position, whose mask flags the axes that are known, along where an item leads, if it does: to the values of
 * `GX_MOVE` and `GX_POSITION`, on by those of `GX_STEP`. Velocities are taken over too.
 *
 * Returns `GX_RC_SUCCESS`; or, position left as it was, `GX_RC_RANGE` when a step leads out of the positions there are,
 * `GX_RC_NOT_FOUND` when an axis it names is not known, `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     if (gx_follow(&position, &item) == GX_RC_SUCCESS && (position.mask & 1) != 0)
 *         printf("x is at %ld\n", (long)position.axes[0]);
 */
int gx_follow(struct gx_vector *position, const struct gx_item *item);

/**
 * The check in the confirmation of the move with this number, for its host to compare. target is where all axes are to
 * be after it, and the velocity then in force; its mask flags those that the session has named up to this move.
 * Returns 0 to 126, or -`GX_RC_ERROR_GENERIC` when target is NULL or number is none.
 *
 *     if (item.kind == GX_CONFIRMED && item.code != gx_check(&target, 5462))
 *         puts("the machine is elsewhere");
 */
int gx_check(const struct gx_vector *target, int number);

/**
 * Writes a vector of positions: `GX_BINARY`, the long form, or `GX_ASCII`. number goes in front of it unless it is
 * NULL or its format is 0.
 *
 * Returns its length in bytes, at most `GX_ENCODED_MAX`; or -`GX_RC_RANGE` when a value or the mask does not fit,
 * -`GX_RC_OVERFLOW` when the room is too small, -`GX_RC_ERROR_GENERIC` when target is NULL or has an empty mask, a
 * format is none, buf is NULL or cap negative. The room's contents are then not to be used.
 *
 *     const struct gx_vector target = {500, 1 | GX_MASK_VELOCITY, {1000, 0, 0, 0, 0, 0}};
 *     if ((length = gx_write_move(GX_BINARY, NULL, &target, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_move(int format, const struct gx_number *number, const struct gx_vector *target, void *buf, int cap);

/**
 * Writes the short form, always binary: deltas of -63 to 63 steps an axis. Returns what `gx_write_move` does.
 *
 *     const struct gx_vector deltas = {0, 1 | 2, {10, -10, 0, 0, 0, 0}};
 *     if ((length = gx_write_step(NULL, &deltas, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_step(const struct gx_number *number, const struct gx_vector *deltas, void *buf, int cap);

/**
 * Writes the shortest command, always binary, that leads from a position to a target: the short form if it can, and no
 * axis that stays where it is. The mask of from flags the axes that are known; NULL: none. Returns what
 * `gx_write_move` does.
 *
 *     if ((length = gx_write_shortest(NULL, &target, &position, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_shortest(const struct gx_number *number, const struct gx_vector *target, const struct gx_vector *from,
    void *buf, int cap);

/**
 * Writes a request for position reports each period milliseconds, 0 to 16383; 0: none. Returns what `gx_write_move`
 * does.
 *
 *     if ((length = gx_write_reporting(GX_BINARY, NULL, 100, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_reporting(int format, const struct gx_number *number, int period, void *buf, int cap);

/**
 * Writes the notice that the command with this number was carried out, in the number's format. Returns what
 * `gx_write_move` does, -`GX_RC_ERROR_GENERIC` also without a number.
 *
 *     if ((length = gx_write_completed(&item.number, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_completed(const struct gx_number *number, void *buf, int cap);

/**
 * Writes the notice that a command was not carried out: with its number, if it had one, in the format of the command.
 * code is 0 to 127: `GX_FAULT_*` or the firmware's own. Without a number it begins with a line end: behind a packed
 * number of the notice before, it would be about that command. Returns what `gx_write_move` does.
 *
 *     if ((length = gx_write_refused(item.format, &item.number, GX_FAULT_BUSY, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_refused(int format, const struct gx_number *number, int code, void *buf, int cap);

/**
 * Writes a position report; a velocity, the one in force, says that the machine was stopped. Returns what
 * `gx_write_move` does.
 *
 *     if ((length = gx_write_position(GX_BINARY, &position, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_position(int format, const struct gx_vector *position, void *buf, int cap);

/**
 * Writes what a host asks for past the queue, one of `GX_CONTROL_*`. Returns what `gx_write_move` does.
 *
 *     if ((length = gx_write_control(GX_BINARY, NULL, GX_CONTROL_HOLD, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_control(int format, const struct gx_number *number, int control, void *buf, int cap);

/**
 * Writes the notice that a session's move was carried out, with its `gx_check`. Returns what `gx_write_move` does.
 *
 *     if ((length = gx_write_confirmed(&item.number, gx_check(&target, item.number.value), out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_confirmed(const struct gx_number *number, int check, void *buf, int cap);

/**
 * Writes the status of a motion side: free more moves fit into its queue, at most 255, and it holds if held is not 0.
 * Returns what `gx_write_move` does.
 *
 *     if ((length = gx_write_status(GX_BINARY, 16, 0, out, sizeof out)) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_write_status(int format, int free, int held, void *buf, int cap);

/**
 * Begins a path of the axes that the mask flags (other bits are ignored), where is not known. Any memory will do.
 * Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when contour is NULL or the mask flags no axis.
 *
 *     struct gx_contour contour;
 *     gx_contour_init(&contour, 1 | 2 | 4);
 *     gx_contour_start(&contour, &position);
 */
int gx_contour_init(struct gx_contour *contour, unsigned char mask);

/**
 * Sets where the machine is, and its velocity, as far as the mask of start says so; NULL: neither is known, as after
 * an error notice. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when contour is NULL.
 *
 *     if (item.kind == GX_REFUSED)
 *         gx_contour_start(&contour, NULL);
 */
int gx_contour_start(struct gx_contour *contour, const struct gx_vector *start);

/**
 * Writes the shortest command to the next position of a path; `gx_follow` along these commands gives the positions
 * back, repeated ones too. position holds six values, of which those of the path's axes count; velocity is 0 to 16383,
 * or negative: as before. Returns what `gx_write_move` does; when that is negative, the path still ends where it did.
 *
 *     for (int i = 0; i < path_length; ++i)
 *         if ((length = gx_contour_segment(&contour, NULL, path[i], -1, out, sizeof out)) > 0)
 *             uart_write(&uart, out, length);
 */
int gx_contour_segment(struct gx_contour *contour, const struct gx_number *number, const int32_t *position,
    int velocity, void *buf, int cap);

#ifdef __cplusplus
}
#endif

#endif
