/**
 * @file
 * libdeltarobot/gx_host.h: the host's end of the GX protocol: numbers moves, sends them in their shortest form,
 * again where something was lost, and reports how they ended.
 *
 * A session does no I/O. A loop around it:
 *
 *     struct gx_host_event event;
 *     char in[64], out[GX_ENCODED_MAX];
 *     int got = 0, taken = 0, length;
 *
 *     gx_host_init(&host, NULL);
 *     for (;;) {
 *         while (gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
 *             handle_event(&event);
 *         while (path_goes_on() && gx_host_move(&host, next_position(), 1 | 2, 500) == GX_RC_SUCCESS)
 *             go_on();
 *         while ((length = gx_host_output(&host, out, sizeof out, now_ms())) > 0)
 *             uart_write(&uart, out, length);
 *         if (is_over())
 *             break;
 *         if (taken == got) {
 *             wait_readable(&uart, gx_host_next_deadline(&host, now_ms()));
 *             taken = 0;
 *             got = uart_read(&uart, in, sizeof in);
 *         }
 *         taken += gx_host_receive(&host, in + taken, got - taken, now_ms());
 *     }
 *
 * It needs a motion side that keeps numbers in order, as gx_motion.h does in a session; one that only sends them back
 * is driven if `echo` is set, else moves end as timed out, and are not sent.
 *
 * Whatever the line loses, delays or splits, when the machine stops, and when the host is begun again, a move is
 * reported as finished only if it was carried out, once and in order, and as refused or dropped only if it was not.
 * The same holds when the motion side is switched off and on, or reset, if it has only_in_order set (gx_motion.h):
 * moves are reported as lost then. Else it carries out again what is sent again, and moves by deltas from where it
 * believes to be.
 *
 * Commands have no checksum: a flipped bit can make another move of one, and so can lost bytes (in binary a mask or
 * several in a row, in ASCII any digit). It is carried out, and reported as GX_HOST_DEVIATED; the next corrects it.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/gx_host.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_GX_HOST_H
#define LIBDELTAROBOT_GX_HOST_H

#include "abi.h"
#include "gx.h"

LIBDELTAROBOT_NOT_PACKED(gx_host);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define gx_host_init GX_SIZED_NAME(gx_host_init)
#define gx_host_move GX_SIZED_NAME(gx_host_move)
#define gx_host_report GX_SIZED_NAME(gx_host_report)
#define gx_host_control GX_SIZED_NAME(gx_host_control)
#define gx_host_receive GX_SIZED_NAME(gx_host_receive)
#define gx_host_poll GX_SIZED_NAME(gx_host_poll)
#define gx_host_output GX_SIZED_NAME(gx_host_output)
#define gx_host_next_deadline GX_SIZED_NAME(gx_host_next_deadline)
#define gx_host_unfinished GX_SIZED_NAME(gx_host_unfinished)
#define gx_host_get_health GX_SIZED_NAME(gx_host_get_health)
#endif

/** Words of a struct gx_host. */
#define GX_HOST_WORDS ((272 + 32 * GX_WINDOW_MAX) / sizeof(unsigned long))

#ifdef __cplusplus
extern "C" {
#endif

/** Event: the oldest move has ended as outcome says: once for each move, in the order of the requests. */
#define GX_HOST_ENDED 1
/** Event: a position report: position. */
#define GX_HOST_REPORT 2
/** Event: an error notice: code, number. What is to be done about it, the session does. */
#define GX_HOST_ERROR 3
/** Event: a session has begun. */
#define GX_HOST_BEGUN 4
/** Event: a position report that does not fit what was requested: position. The next move corrects that. */
#define GX_HOST_DRIFT 5
/** Event: the status: number more moves fit into the motion side's queue, and it holds if code is not 0. */
#define GX_HOST_STATUS 6
/** Event: the machine was stopped at position, with the velocity in force, and has forgotten all moves. */
#define GX_HOST_STOPPED 7
/** Event: what `gx_host_control` asked for got no answer, or is not known there: code, `GX_CONTROL_*`. */
#define GX_HOST_UNANSWERED 8
/** Outcome: the move was carried out. */
#define GX_HOST_FINISHED 1
/** Outcome: the motion side did not accept the move. It was not carried out. */
#define GX_HOST_REFUSED 2
/** Outcome: the motion side accepted the move, and has stopped before it was carried out to its end. */
#define GX_HOST_FAILED 3
/** Outcome: it was not begun: one before it was refused or has failed, or the session ended before it was sent. */
#define GX_HOST_DROPPED 4
/** Outcome: no answer for too long, or the move lasted too long. Whether it was carried out is not known. */
#define GX_HOST_TIMED_OUT 5
/** Outcome: the motion side was restarted or has left the session. Whether the move was carried out is not known. */
#define GX_HOST_LOST 6
/** Outcome: a damaged command was carried out, says the check. The next names all axes, which corrects that. */
#define GX_HOST_DEVIATED 7

/** A host session. All zero is a new session with default settings. Its contents are private. */
struct gx_host {
  unsigned long opaque[GX_HOST_WORDS];
};

/** Settings of a host session, times in milliseconds. 0 stands for the default everywhere. */
struct gx_host_settings {
  /** How long an answer may take to come; by default 250. What asks for one is not sent again sooner. */
  unsigned long answer_ms;
  /** When no move ends for this long, the newest one is sent again, as something may be lost; by default 1000. */
  unsigned long probe_ms;
  /** A session is given up when a move takes longer than this from its turn on; by default 120000. */
  unsigned long move_ms;
  /** A notice is complete when the line was quiet for this long, or another one has begun; by default 50. */
  unsigned long gap_ms;
  /** How often something is sent without an answer, or a session begun in vain; by default 8. Below 0: no limit. */
  int attempts;
  /**
   * Most moves that are sent and unfinished at a time: 1 to `GX_WINDOW_MAX`, the default. More than the motion side
   * queues are refused by it, and sent again.
   */
  int window;
  /** Not 0: commands are sent in ASCII, without short forms; position reports come in ASCII too. */
  int ascii;
  /** The number that the first session begins with, 0 to 16383. */
  int first_number;
  /** Every so manieth move is sent in positions, 1 to 255, so that nothing drifts; by default every 16th. */
  int absolute_every;
  /**
   * Not 0: the motion side only sends numbers back, as the proposal has it. Then without a session one move at a
   * time is sent, in positions; again after `probe_ms`, which should be longer than a move lasts.
   */
  int echo;
};

/** Something that happened. */
struct gx_host_event {
  /** What: one of `GX_HOST_ENDED` to `GX_HOST_UNANSWERED`. */
  int kind;
  /** Of `GX_HOST_ENDED`, one of `GX_HOST_FINISHED` to `GX_HOST_DEVIATED`; 0 of others. */
  int outcome;
  /** Of an error notice, and of `GX_HOST_ENDED` if one is the reason: `GX_FAULT_*`; see `GX_HOST_*`; else 0. */
  int code;
  /** Of `GX_HOST_ERROR`, the number that the notice names; of `GX_HOST_STATUS`, see there; else -1. */
  int number;
  /** Of `GX_HOST_REPORT`, `GX_HOST_DRIFT` and `GX_HOST_STOPPED`; other events leave it alone. */
  struct gx_vector position;
};

/** Counters of a host session since it began; they wrap. */
struct gx_host_health {
  /** Moves sent, each counted once. */
  unsigned long moves;
  /** Moves sent again. */
  unsigned long repeats;
  /** Notices that moves were carried out. */
  unsigned long completions;
  /** Error notices. */
  unsigned long errors;
  /** Notices of numbers that nothing unfinished has: late, or sent again. */
  unsigned long strays;
  /** Position reports. */
  unsigned long reports;
  /** Malformed notices. */
  unsigned long malformed;
  /** Answers that did not come in time. */
  unsigned long timeouts;
  /** Sessions begun. */
  unsigned long sessions;
  /** Ends and reports that did not fit what was requested. */
  unsigned long deviations;
};

/**
 * Begins a session. settings are copied; NULL stands for the defaults, which memory that is all zero has too. Returns
 * `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL.
 *
 *     struct gx_host_settings settings = {0};
 *     settings.window = 4;
 *     gx_host_init(&host, &settings);
 */
int gx_host_init(struct gx_host *host, const struct gx_host_settings *settings) GX_SIZED(gx_host_init);

/**
 * Requests a move behind those requested before; its end comes as an event. target holds `GX_AXES` positions in steps,
 * x first, of which those count that axes, a mask, flags; the other axes stay. velocity is in steps per second, 0 to
 * 16383, and holds from this move on; -1: that of the move before. Without any axis, only the velocity is set.
 *
 * Returns `GX_RC_SUCCESS`, `GX_RC_BUSY` when the ends of `GX_WINDOW_MAX` moves were not fetched yet, or
 * `GX_RC_ERROR_GENERIC` when a pointer is NULL, a value or mask is out of range, or there is neither axis nor velocity.
 *
 *     const int32_t target[GX_AXES] = {1000, 2000, 0, 0, 0, 0};
 *     if (gx_host_move(&host, target, 1 | 2, 500) == GX_RC_BUSY)
 *         puts("first, events have to be fetched");
 */
int gx_host_move(struct gx_host *host, const int32_t *target, int axes, int velocity) GX_SIZED(gx_host_move);

/**
 * Requests position reports each `period_ms` milliseconds, 1 to 16383, or none any more: 0. They come as events, and
 * are asked for again when they stay away. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL or the
 * period is out of range.
 *
 *     if (gx_host_report(&host, 100) != GX_RC_SUCCESS)
 *         puts("no such period");
 */
int gx_host_report(struct gx_host *host, int period_ms) GX_SIZED(gx_host_report);

/**
 * Asks for something past the queue, `GX_CONTROL_QUERY` to `GX_CONTROL_STOP`, in place of what was asked for before,
 * until the answer comes: `GX_HOST_STATUS`, or of a stop `GX_HOST_STOPPED`; else `GX_HOST_UNANSWERED`. On a stop, moves
 * end as failed or dropped, or as lost where it is not known which of them ended.
 *
 * Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL or control is none of these.
 *
 *     if (stop_is_pressed())
 *         gx_host_control(&host, GX_CONTROL_STOP);
 */
int gx_host_control(struct gx_host *host, int control) GX_SIZED(gx_host_control);

/**
 * Takes received bytes; `now_ms` is when they came. Returns how many bytes were taken: all, or fewer when events have
 * to be fetched first by `gx_host_poll`; give it the rest then. Returns -`GX_RC_ERROR_GENERIC` when host is NULL,
 * bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     for (int taken = 0; taken < got; handle_events(&host))
 *         taken += gx_host_receive(&host, in + taken, got - taken, now_ms());
 */
int gx_host_receive(struct gx_host *host, const void *buf, int bytes, unsigned long now_ms) GX_SIZED(gx_host_receive);

/**
 * Fetches the next event. To be called after receiving, and when `gx_host_next_deadline` says, until there is none;
 * then `gx_host_output`. Returns `GX_RC_SUCCESS` and the event, `GX_RC_NO_EVENT` when there is none (kind is 0 then),
 * or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct gx_host_event event;
 *     while (gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
 *         if (event.kind == GX_HOST_ENDED)
 *             printf("the oldest move: outcome %d\n", event.outcome);
 */
int gx_host_poll(struct gx_host *host, unsigned long now_ms, struct gx_host_event *event) GX_SIZED(gx_host_poll);

/**
 * Fetches the bytes to send: whole commands, as many as fit; `now_ms` is when they leave. To be called after
 * `gx_host_poll`. Room for `GX_ENCODED_MAX` bytes is always enough for one.
 *
 * Returns how many bytes were written, 0 when there is nothing to send or no room for the next command, or
 * -`GX_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
 *
 *     if ((length = gx_host_output(&host, out, sizeof out, now_ms())) > 0)
 *         uart_write(&uart, out, length);
 */
int gx_host_output(struct gx_host *host, void *buf, int cap, unsigned long now_ms) GX_SIZED(gx_host_output);

/**
 * How long `gx_host_poll` has nothing to do if nothing is received or requested, as poll(2) takes it. To be called
 * when all events and output were fetched. Returns milliseconds, or -1 when it need not be called at all or host is
 * NULL.
 *
 *     wait_readable(&uart, gx_host_next_deadline(&host, now_ms()));
 */
long gx_host_next_deadline(const struct gx_host *host, unsigned long now_ms) GX_SIZED(gx_host_next_deadline);

/**
 * How many moves were requested whose ends were not fetched yet; 0 also when host is NULL.
 *
 *     if (gx_host_unfinished(&host) == 0)
 *         puts("all moves have ended");
 */
int gx_host_unfinished(const struct gx_host *host) GX_SIZED(gx_host_unfinished);

/**
 * Copies out how the link does. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct gx_host_health health;
 *     if (gx_host_get_health(&host, &health) == GX_RC_SUCCESS)
 *         printf("%lu moves, %lu repeats\n", health.moves, health.repeats);
 */
int gx_host_get_health(const struct gx_host *host, struct gx_host_health *health) GX_SIZED(gx_host_get_health);

#ifdef __cplusplus
}
#endif

#endif
