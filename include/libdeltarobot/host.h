/**
 * @file
 * libdeltarobot/host.h: the host's end of the link: sends requests, retransmits them, reports how they ended.
 *
 * A session does no I/O. A loop around it, from the first request on:
 *
 *     struct dp_host_event event;
 *     char in[64], out[DP_HOST_OUTPUT_MAX];
 *     int got = 0, taken = 0, length;
 *
 *     dp_host_init(&host, NULL);
 *     dp_host_home(&host);
 *     for (;;) {
 *         while (dp_host_poll(&host, now_ms(), &event) == DP_RC_SUCCESS)
 *             handle_event(&event);
 *         if ((length = dp_host_output(&host, out, sizeof out, now_ms())) > 0)
 *             uart_write(&uart, out, length);
 *         if (is_over())
 *             break;
 *         if (taken == got) {
 *             wait_readable(&uart, dp_host_next_deadline(&host, now_ms()));
 *             taken = 0;
 *             got = uart_read(&uart, in, sizeof in);
 *         }
 *         taken += dp_host_receive(&host, in + taken, got - taken, now_ms());
 *     }
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/host.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_HOST_H
#define LIBDELTAROBOT_HOST_H

#include "abi.h"
#include "payload.h"

LIBDELTAROBOT_NOT_PACKED(host);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_host_init DP_SIZED_NAME(dp_host_init)
#define dp_host_home DP_SIZED_NAME(dp_host_home)
#define dp_host_move DP_SIZED_NAME(dp_host_move)
#define dp_host_cancel DP_SIZED_NAME(dp_host_cancel)
#define dp_host_status DP_SIZED_NAME(dp_host_status)
#define dp_host_receive DP_SIZED_NAME(dp_host_receive)
#define dp_host_poll DP_SIZED_NAME(dp_host_poll)
#define dp_host_output DP_SIZED_NAME(dp_host_output)
#define dp_host_next_deadline DP_SIZED_NAME(dp_host_next_deadline)
#define dp_host_busy DP_SIZED_NAME(dp_host_busy)
#define dp_host_get_health DP_SIZED_NAME(dp_host_get_health)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** A request of this kind is going on, or its end was not fetched by `dp_host_poll` yet. */
#define DP_RC_BUSY 5
/** Nothing has happened. */
#define DP_RC_NO_EVENT 6
/** Room for what is to be sent at a time: three requests. */
#define DP_HOST_OUTPUT_MAX 27
/** Words of a session's room. */
#define DP_HOST_WORDS ((DP_DATA_MAX_SIZE / 4) + 56)
/** Event: a message was received; `msg` holds it. Only where the settings ask for these events. */
#define DP_HOST_MESSAGE 1
/** Event: a status report was received; `report` holds it, `state` its state. */
#define DP_HOST_STATUS 2
/** Event: the platform is in another state than before: `state`; `report` is the status report that says so. */
#define DP_HOST_STATE 3
/** Event: a general error was received. */
#define DP_HOST_ERROR 4
/** Event: the controller has accepted the operation `opcode`. */
#define DP_HOST_ACCEPTED 5
/** Event: the request `opcode` has ended as `outcome` says. Comes exactly once for each request. */
#define DP_HOST_ENDED 6
/** Outcome: the request was carried out. */
#define DP_HOST_FINISHED 1
/** Outcome: the controller did not accept the request. */
#define DP_HOST_REFUSED 2
/** Outcome: the controller accepted the operation, and could not carry it out. */
#define DP_HOST_FAILED 3
/** Outcome: the operation was cancelled: before it was ever sent, or the platform stands now. */
#define DP_HOST_CANCELLED 4
/** Outcome: too many answers stayed away, or the operation lasted too long. What the platform does is not known. */
#define DP_HOST_TIMED_OUT 5

/** A session. All zero is one with the default settings. */
struct dp_host {
  unsigned long opaque[DP_HOST_WORDS];
};

/** Settings of a session, times in milliseconds up to 2147483647 (24 days). 0 stands for the default everywhere. */
struct dp_host_settings {
  /** How long an answer is waited for before the request is retransmitted; by default 250. */
  unsigned long ack_ms;
  /**
   * The longest time from sending a request to its answer's arrival: what has not come by then is lost, and what
   * comes sooner is not taken for the answer to a later request. By default 500.
   */
  unsigned long guard_ms;
  /**
   * How long after its ack an operation may take to show in the state: a report of IDLE that comes sooner, with no
   * other state before it, does not end the operation. Not below guard; by default 500.
   */
  unsigned long settle_ms;
  /** During an operation the status is requested when no report came for this long; by default 200. */
  unsigned long poll_ms;
  /** An operation is given up when nothing at all was received for this long; by default 3000. */
  unsigned long silence_ms;
  /** An operation is given up after this long in any case; by default 120000. */
  unsigned long operation_ms;
  /** An incomplete frame is given up when the line was quiet for this long; by default 50. */
  unsigned long gap_ms;
  /**
   * How far each arm may be from the target of a move that IDLE ends, in the displacement's unit; by default 0.25,
   * twice what shipped firmware allows itself.
   */
  float tolerance;
  /** How often a request is sent altogether before it has timed out, 1 to 255; by default 4. */
  int attempts;
  /** Layout of status reports, one of `DP_LAYOUT_*`; by default `DP_LAYOUT_AUTO`. */
  int layout;
  /** Not 0: each received message is an event. */
  int messages;
  /** Not 0: the line may deliver a frame twice, as some radio links do. Operations then keep `guard_ms` apart. */
  int duplicates;
};

/** Something that happened. */
struct dp_host_event {
  /** What: one of `DP_HOST_MESSAGE` to `DP_HOST_ENDED`. */
  int kind;
  /** Of `DP_HOST_ACCEPTED` and `DP_HOST_ENDED`, the request: `DP_OPCODE_HOMING`, `MOVE`, `CANCEL` or `STATUS`. */
  unsigned char opcode;
  /** Of `DP_HOST_ENDED`, one of `DP_HOST_FINISHED` to `DP_HOST_TIMED_OUT`; 0 of others. */
  int outcome;
  /** Of `DP_HOST_STATUS` and `DP_HOST_STATE`, one of `DP_STATUS_*`; -1 of others. */
  int state;
  /** Of `DP_HOST_STATUS` and `DP_HOST_STATE`, the report. Other events leave it alone. */
  struct protocol_msg_status_report report;
  /** Of `DP_HOST_MESSAGE`, the message. Other events may have changed it. */
  struct protocol_msg msg;
};

/** Statistics of a session since it began. Counters wrap at 2^32. */
struct dp_host_health {
  /** Intact frames received. */
  unsigned long frames;
  /** Of these, frames whose payload has the wrong length for the opcode. They are ignored. */
  unsigned long malformed;
  /** Of these, acks and nacks that nothing was waiting for: late, or of another opcode than was asked. */
  unsigned long strays;
  /** Bytes received that belong to no intact frame. */
  unsigned long garbage_bytes;
  /** Frames that were whole but for their checksum. Their bytes are among the garbage. */
  unsigned long checksum_failures;
  /** Answers that did not come in time. */
  unsigned long timeouts;
  /** Requests that were retransmitted because of that. */
  unsigned long retransmissions;
  /** Number of round trips measured: from a request that was sent once to its answer. Times in milliseconds. */
  unsigned long rtt_count;
  /** The last round-trip time. */
  unsigned long rtt_last;
  /** The shortest round-trip time. */
  unsigned long rtt_min;
  /** The longest round-trip time. */
  unsigned long rtt_max;
  /** Sum of the round-trip times: divided by `rtt_count`, their average. */
  unsigned long rtt_sum;
};

/**
 * Begins a session, in any memory. settings are copied; NULL stands for the defaults.
 *
 * Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when host is NULL.
 *
 *     struct dp_host_settings settings = {0};
 *     settings.messages = 1;
 *     dp_host_init(&host, &settings);
 */
int dp_host_init(struct dp_host *host, const struct dp_host_settings *settings) DP_SIZED(dp_host_init);

/**
 * Requests homing. The end comes as an event.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while an operation is going on, or `DP_RC_ERROR_GENERIC` when host is NULL.
 *
 *     if (dp_host_home(&host) == DP_RC_BUSY)
 *         puts("first, DP_HOST_ENDED has to come");
 */
int dp_host_home(struct dp_host *host) DP_SIZED(dp_host_home);

/**
 * Requests a move to a position. The end comes as an event.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while an operation is going on, or `DP_RC_ERROR_GENERIC` when a pointer is
 * NULL, a coordinate is a NaN or infinite, or `DP_DATA_MAX_SIZE` is below 12.
 *
 *     const struct protocol_msg_position target = {1, 2, -3.5f};
 *     if (dp_host_move(&host, &target) == DP_RC_ERROR_GENERIC)
 *         puts("no robot can go there");
 */
int dp_host_move(struct dp_host *host, const struct protocol_msg_position *target) DP_SIZED(dp_host_move);

/**
 * Requests that the operation going on be cancelled. Both requests end: this one when the controller has answered it,
 * the operation when the platform stands. Without an operation it is requested all the same.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while one is being requested, or `DP_RC_ERROR_GENERIC` when host is NULL.
 *
 *     if (stop_is_pressed())
 *         dp_host_cancel(&host);
 */
int dp_host_cancel(struct dp_host *host) DP_SIZED(dp_host_cancel);

/**
 * Requests a status report. It ends with the next report that is received.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while one is being requested, or `DP_RC_ERROR_GENERIC` when host is NULL.
 *
 *     if (now_ms() - asked_at >= 1000 && dp_host_status(&host) == DP_RC_SUCCESS)
 *         asked_at = now_ms();
 */
int dp_host_status(struct dp_host *host) DP_SIZED(dp_host_status);

/**
 * Takes received bytes; `now_ms` is when they came.
 *
 * Returns how many were taken: all, or as many as fit. The rest fits when `dp_host_poll` has no more events. Returns
 * -`DP_RC_ERROR_GENERIC` when host is NULL, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     for (int taken = 0; taken < length; handle_events(&host))
 *         taken += dp_host_receive(&host, in + taken, length - taken, now_ms());
 */
int dp_host_receive(struct dp_host *host, const void *buf, int bytes, unsigned long now_ms) DP_SIZED(dp_host_receive);

/**
 * Fetches the next event. To be called after receiving, and at the latest when `dp_host_next_deadline` says, until
 * there is none; then `dp_host_output` has what is to be sent.
 *
 * Returns `DP_RC_SUCCESS` and the event, `DP_RC_NO_EVENT` when there is none (`kind` is 0 then), or
 * `DP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct dp_host_event event;
 *     while (dp_host_poll(&host, now_ms(), &event) == DP_RC_SUCCESS)
 *         if (event.kind == DP_HOST_ENDED)
 *             printf("%s: outcome %d\n", dp_opcode_name(event.opcode), event.outcome);
 */
int dp_host_poll(struct dp_host *host, unsigned long now_ms, struct dp_host_event *event) DP_SIZED(dp_host_poll);

/**
 * Fetches what is to be sent after `dp_host_poll`: whole frames, `DP_HOST_OUTPUT_MAX` bytes at most, sent at `now_ms`.
 *
 * Returns how many bytes were written, 0 when there is nothing to send or no room for the next frame, or
 * -`DP_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
 *
 *     int length = dp_host_output(&host, out, sizeof out, now_ms());
 *     if (length > 0)
 *         uart_write(&uart, out, length);
 */
int dp_host_output(struct dp_host *host, void *buf, int cap, unsigned long now_ms) DP_SIZED(dp_host_output);

/**
 * Returns how many milliseconds `dp_host_poll` need not be called if nothing is received or requested, as poll(2) takes
 * them: -1 when not at all, or host is NULL. Ask when events and output were fetched.
 *
 *     wait_readable(&uart, dp_host_next_deadline(&host, now_ms()));
 */
long dp_host_next_deadline(const struct dp_host *host, unsigned long now_ms) DP_SIZED(dp_host_next_deadline);

/**
 * Whether an operation is going on: 1, or 0, also when host is NULL.
 *
 *     if (!dp_host_busy(&host))
 *         dp_host_home(&host);
 */
int dp_host_busy(const struct dp_host *host) DP_SIZED(dp_host_busy);

/**
 * Copies the statistics. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct dp_host_health health;
 *     if (dp_host_get_health(&host, &health) == DP_RC_SUCCESS && health.rtt_count > 0)
 *         printf("round trip: %lu ms on average\n", health.rtt_sum / health.rtt_count);
 */
int dp_host_get_health(const struct dp_host *host, struct dp_host_health *health) DP_SIZED(dp_host_get_health);

#ifdef __cplusplus
}
#endif

#endif
