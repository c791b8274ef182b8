/**
 * @file
 * libdeltarobot/gx_motion.h: the motion side of the GX protocol, for firmware: takes commands, queues the moves,
 * reports how they end, reports the position.
 *
 * It does no I/O. The firmware's main loop calls:
 *
 *     struct gx_motion_event event;
 *     struct gx_vector target;
 *     int length;
 *
 *     taken += gx_motion_receive(&motion, in + taken, got - taken, now_ms());
 *     while (gx_motion_poll(&motion, now_ms(), &event) == GX_RC_SUCCESS)
 *         if (event.kind == GX_MOTION_STOP && motors_stop() == 0)
 *             gx_motion_stop(&motion, 0);
 *     motors_count(steps);
 *     gx_motion_set_position(&motion, steps);
 *     if (motors_have_arrived())
 *         gx_motion_done(&motion);
 *     if (motors_state() == 0 && gx_motion_next(&motion, &target, NULL) == GX_RC_SUCCESS)
 *         motors_start(target.mask, target.axes, target.velocity);
 *     if ((length = gx_motion_output(&motion, out, sizeof out, now_ms())) > 0)
 *         uart_write(&uart, out, length);
 *
 * From power-up on, moves are taken as the proposal has it, with any number or none, until a host begins a session,
 * which makes up for what the line loses, delays or splits: see gx_motion_receive. Set only_in_order where only such
 * hosts drive the machine. Commands have no checksum: a flipped bit can make another move of one, which is carried out;
 * the host finds that afterwards.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/gx_motion.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_GX_MOTION_H
#define LIBDELTAROBOT_GX_MOTION_H

#include "abi.h"
#include "gx.h"

LIBDELTAROBOT_NOT_PACKED(gx_motion);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define gx_motion_init GX_SIZED_NAME(gx_motion_init)
#define gx_motion_receive GX_SIZED_NAME(gx_motion_receive)
#define gx_motion_poll GX_SIZED_NAME(gx_motion_poll)
#define gx_motion_next GX_SIZED_NAME(gx_motion_next)
#define gx_motion_done GX_SIZED_NAME(gx_motion_done)
#define gx_motion_stop GX_SIZED_NAME(gx_motion_stop)
#define gx_motion_set_position GX_SIZED_NAME(gx_motion_set_position)
#define gx_motion_output GX_SIZED_NAME(gx_motion_output)
#define gx_motion_next_deadline GX_SIZED_NAME(gx_motion_next_deadline)
#define gx_motion_unfinished GX_SIZED_NAME(gx_motion_unfinished)
#define gx_motion_get_health GX_SIZED_NAME(gx_motion_get_health)
#endif

/** Words of a struct gx_motion. A queued move takes fewer bytes on AVR, where structs have no padding. */
#ifdef __AVR__
#define GX_MOTION_WORDS ((175 + 30 * GX_QUEUE_MAX) / sizeof(unsigned long))
#else
#define GX_MOTION_WORDS ((192 + 32 * GX_QUEUE_MAX) / sizeof(unsigned long))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Event: a move was queued, for `gx_motion_next` to fetch. */
#define GX_MOTION_QUEUED 1
/** Event: a move that was queued before came again. There is nothing to do. */
#define GX_MOTION_REPEATED 2
/** Event: a command was refused: code. */
#define GX_MOTION_REFUSED 3
/** Event: a host has begun a session; its request for position reports holds too. */
#define GX_MOTION_BEGUN 4
/** Event: a host has asked for position reports, without beginning a session: period. There is nothing to do. */
#define GX_MOTION_REPORTING 5
/** Event: a host wants the machine to hold, that is, to pause. `gx_motion_next` hands out no moves. */
#define GX_MOTION_HOLD 6
/** Event: a host wants the machine to go on. */
#define GX_MOTION_RESUME 7

/**
 * Event: the machine is to stop for good, as a host wants it (code is `GX_FAULT_STOPPED`) or is silent
 * (`GX_FAULT_SILENT`). No moves are handed out until `gx_motion_stop` is called, as soon as the machine stands.
 */
#define GX_MOTION_STOP 8

/** A motion side. All zero is a new one with default settings. Its contents are private. */
struct gx_motion {
  unsigned long opaque[GX_MOTION_WORDS];
};

/** Settings of a motion side. 0 stands for the default everywhere. */
struct gx_motion_settings {
  /** Milliseconds of silence after which an incomplete command is given up, with an error notice; by default 1000. */
  unsigned long gap_ms;
  /**
   * The machine is to stop (`GX_MOTION_STOP`) when nothing has come for this many milliseconds while there are moves
   * to carry out; `gx_host.h` then sends something every `probe_ms`, by default 1000. 0: it is not to stop.
   */
  unsigned long host_ms;
  /** The axes there are, bit 0 being x: commands for others are refused, and none reported. By default all six. */
  int axes;
  /**
   * Not 0: moves are taken in sessions only, for a machine that only hosts with sessions drive: when it was switched
   * off and on, or reset, it takes nothing from a host that did not notice, for the rest of the session. By default
   * moves are taken with any number, or none, until a host begins a session.
   */
  int only_in_order;
};

/** Something that happened. */
struct gx_motion_event {
  /** What: one of `GX_MOTION_QUEUED` to `GX_MOTION_STOP`. */
  int kind;
  /** The number of the command, 0 to 16383; -1 when it has none, and from `GX_MOTION_REPORTING` on. */
  int number;
  /** Of `GX_MOTION_REFUSED` and `GX_MOTION_STOP`, why: `GX_FAULT_*`; 0 of others. */
  int code;
  /** Of `GX_MOTION_REPORTING`, the time between two reports in milliseconds, 0 if they are off; 0 of others. */
  int period;
};

/** Counters of a motion side since it began; they wrap. */
struct gx_motion_health {
  /** Moves queued. */
  unsigned long moves;
  /** Moves that were queued before and came again: not carried out twice. */
  unsigned long repeats;
  /** Moves refused, with an error notice or without. */
  unsigned long refused;
  /** Malformed commands. */
  unsigned long malformed;
  /** Position reports sent. */
  unsigned long reports;
};

/**
 * Begins a motion side. settings are copied; NULL stands for the defaults, which memory that is all zero has too.
 * Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when motion is NULL.
 *
 *     struct gx_motion_settings settings = {0};
 *     settings.axes = 1 | 2 | 4;
 *     gx_motion_init(&motion, &settings);
 */
int gx_motion_init(struct gx_motion *motion, const struct gx_motion_settings *settings) GX_SIZED(gx_motion_init);

/**
 * Takes received bytes; `now_ms` is when they came.
 *
 * Moves are queued whatever number they have or none, until a host begins a session: by two numbered requests for
 * position reports in a row, the second number 5461 behind the first (modulo 16384), which is answered by both
 * numbers. From there on each move has to carry the next number: what was taken before is not carried out twice, and
 * what comes out of order (`GX_FAULT_ORDER`) or without a number (`GX_FAULT_NUMBERLESS`) is refused; ends are reported
 * with a check of where the move led (`GX_CONFIRMED`). One more numbered request begins a new session. Behind
 * `gx_motion_stop`, moves are refused until one begins (`GX_FAULT_CLOSED`); ESC ESC lets them be taken as they come
 * again.
 *
 * Returns how many bytes were taken: all, or fewer when events or output have to be fetched first; give it the rest
 * then. Returns -`GX_RC_ERROR_GENERIC` when motion is NULL, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     for (int taken = 0; taken < got; serve(&motion))
 *         taken += gx_motion_receive(&motion, in + taken, got - taken, now_ms());
 */
int gx_motion_receive(struct gx_motion *motion, const void *buf, int bytes, unsigned long now_ms)
    GX_SIZED(gx_motion_receive);

/**
 * Fetches the next event. To be called after receiving, and when `gx_motion_next_deadline` says, until there is none.
 * Returns `GX_RC_SUCCESS` and the event, `GX_RC_NO_EVENT` when there is none (kind is 0 then), or
 * `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct gx_motion_event event;
 *     while (gx_motion_poll(&motion, now_ms(), &event) == GX_RC_SUCCESS)
 *         printf("event %d\n", event.kind);
 */
int gx_motion_poll(struct gx_motion *motion, unsigned long now_ms, struct gx_motion_event *event)
    GX_SIZED(gx_motion_poll);

/**
 * Fetches the next move to carry out; what only sets the velocity is none, and ends in its turn. Firmware that plans
 * ahead may fetch more before the first is done. move receives the target: its mask flags the axes to be moved, and the
 * velocity if one was ever set; the other axes hold where they are to stay, as far as that is known. number, unless it
 * is NULL, receives the move's number, or -1 when it has none or its session is over.
 *
 * Returns `GX_RC_SUCCESS`, `GX_RC_NO_EVENT` when there is none, or `GX_RC_ERROR_GENERIC` when motion or move is NULL.
 *
 *     struct gx_vector target;
 *     if (motors_state() == 0 && gx_motion_next(&motion, &target, NULL) == GX_RC_SUCCESS)
 *         motors_start(target.mask, target.axes, target.velocity);
 */
int gx_motion_next(struct gx_motion *motion, struct gx_vector *move, int *number) GX_SIZED(gx_motion_next);

/**
 * Says that the oldest of the moves fetched has been carried out. Its number, if it has one, is reported to the host.
 * Returns `GX_RC_SUCCESS`, `GX_RC_NO_EVENT` when none was fetched, or `GX_RC_ERROR_GENERIC` when motion is NULL.
 *
 *     if (motors_have_arrived())
 *         gx_motion_done(&motion);
 */
int gx_motion_done(struct gx_motion *motion) GX_SIZED(gx_motion_done);

/**
 * Says that the machine has stopped: what was fetched or queued is dropped, which the host hears by an error notice of
 * the oldest move that has a number. code is that notice's: 0 stands for `GX_FAULT_STOPPED`; 64 to 127 are the
 * firmware's own. A host with a session has to begin a new one. `gx_motion_set_position` has to be called before moves
 * by deltas are taken; if the host wanted the stop, before this call: the position is reported then, and the velocity
 * in force.
 *
 * Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when motion is NULL or code is another.
 *
 *     if (stop_is_pressed() && motors_stop() == 0)
 *         gx_motion_stop(&motion, 0);
 */
int gx_motion_stop(struct gx_motion *motion, int code) GX_SIZED(gx_motion_stop);

/**
 * Says where the machine is: position reports give this, and moves by deltas begin here on axes that no move has
 * positioned yet. position holds `GX_AXES` values in steps, x first. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC`
 * when a pointer is NULL or a value is not a position (28 bits): nothing changes then.
 *
 *     int32_t steps[GX_AXES];
 *     motors_count(steps);
 *     gx_motion_set_position(&motion, steps);
 */
int gx_motion_set_position(struct gx_motion *motion, const int32_t *position) GX_SIZED(gx_motion_set_position);

/**
 * Fetches the bytes to send: whole notices and reports, as many as fit; `now_ms` is when they leave. To be called
 * after `gx_motion_poll`. Room for `GX_ENCODED_MAX` bytes is always enough for one.
 *
 * Returns how many bytes were written, 0 when there is nothing to send or no room for the next notice, or
 * -`GX_RC_ERROR_GENERIC` when motion is NULL, cap is negative, or buf is NULL and cap is not 0.
 *
 *     if ((length = gx_motion_output(&motion, out, sizeof out, now_ms())) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_motion_output(struct gx_motion *motion, void *buf, int cap, unsigned long now_ms) GX_SIZED(gx_motion_output);

/**
 * How long `gx_motion_poll` and `gx_motion_output` have nothing to do if nothing is received or done. To be called
 * when all events and output were fetched. Returns milliseconds, or -1 when they need not be called at all or motion
 * is NULL.
 *
 *     wait_readable(&uart, gx_motion_next_deadline(&motion, now_ms()));
 */
long gx_motion_next_deadline(const struct gx_motion *motion, unsigned long now_ms) GX_SIZED(gx_motion_next_deadline);

/**
 * How many moves are queued or being carried out; 0 also when motion is NULL.
 *
 *     if (gx_motion_unfinished(&motion) == 0)
 *         motors_stop();
 */
int gx_motion_unfinished(const struct gx_motion *motion) GX_SIZED(gx_motion_unfinished);

/**
 * Copies out what was seen. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct gx_motion_health health;
 *     if (gx_motion_get_health(&motion, &health) == GX_RC_SUCCESS)
 *         printf("%lu moves, %lu refused\n", health.moves, health.refused);
 */
int gx_motion_get_health(const struct gx_motion *motion, struct gx_motion_health *health)
    GX_SIZED(gx_motion_get_health);

#ifdef __cplusplus
}
#endif

#endif
