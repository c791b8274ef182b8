/**
 * @file
 * libdeltarobot/controller.h: the controller's end of the link, for firmware: has requests carried out and answered.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/controller.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_CONTROLLER_H
#define LIBDELTAROBOT_CONTROLLER_H

#include "abi.h"
#include "payload.h"

LIBDELTAROBOT_NOT_PACKED(controller);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define dp_controller_init DP_SIZED_NAME(dp_controller_init)
#define dp_controller_receive DP_SIZED_NAME(dp_controller_receive)
#define dp_controller_poll DP_SIZED_NAME(dp_controller_poll)
#define dp_controller_poll_idle DP_SIZED_NAME(dp_controller_poll_idle)
#define dp_controller_report DP_SIZED_NAME(dp_controller_report)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Refuses homing and moving during an operation. Without it they take that one's place, as in shipped firmware. */
#define DP_CONTROLLER_REFUSE_BUSY 1
/** The end of homing and of a move is reported by `h` and `m` (specification), besides the status report. */
#define DP_CONTROLLER_REPORT_END 2
/** An error during an operation is reported by `e` (specification), besides the status report. */
#define DP_CONTROLLER_REPORT_ERROR 4
/** Words of a controller's room. */
#define DP_CONTROLLER_WORDS ((DP_DATA_MAX_SIZE / 4) + 13)

/** A controller. As it keeps pointers, it has to be made by `dp_controller_init`, or all zero, which does nothing. */
struct dp_controller {
  LIBDELTAROBOT_WORD opaque[DP_CONTROLLER_WORDS];
};

/**
 * Begins to home. Returns 0, or anything else to refuse. From then until the end, the state is `DP_STATUS_HOMING`.
 *
 *     int start_homing(void *usr)
 *     {
 *         return motors_home();
 *     }
 */
typedef int (*dp_controller_home_func_t)(void *usr);

/**
 * Begins to move to target, which is free of NaNs, and gone when the function returns. Returns 0, or anything else to
 * refuse. From then until the end, the state is `DP_STATUS_MOVING`.
 *
 *     int start_move(const struct protocol_msg_position *target, void *usr)
 *     {
 *         return motors_move(target->DA, target->DB, target->DC);
 *     }
 */
typedef int (*dp_controller_move_func_t)(const struct protocol_msg_position *target, void *usr);

/**
 * Begins to stop. Returns 0, or anything else to refuse.
 *
 *     int stop(void *usr)
 *     {
 *         return motors_stop();
 *     }
 */
typedef int (*dp_controller_cancel_func_t)(void *usr);

/**
 * Fills in report: the position, NaNs when it is not known, and state and end stops in STAT.
 *
 *     void read_status(struct protocol_msg_status_report *report, void *usr)
 *     {
 *         motors_where(&report->DA, &report->DB, &report->DC);
 *         report->STAT = (unsigned char)(motors_state() | (stop_a_is_pressed() ? DP_BIT_STAT_STOP_A_BIT : 0));
 *     }
 */
typedef void (*dp_controller_read_func_t)(struct protocol_msg_status_report *report, void *usr);

/** The firmware's own functions. `read` and `send` are needed; what one that is NULL would do is refused. */
struct dp_controller_calls {
  /** Begins to home. */
  dp_controller_home_func_t home;
  /** Begins to move. */
  dp_controller_move_func_t move;
  /** Begins to stop. */
  dp_controller_cancel_func_t cancel;
  /** Reads the status. */
  dp_controller_read_func_t read;
  /** Sends bytes, whole frames. Its result is ignored: the protocol leaves lost frames to the host. */
  send_func_t send;
};

/**
 * Makes a controller of any memory.
 *
 * layout is that of status reports, `DP_LAYOUT_*` (`payload.h`); flags is a sum of `DP_CONTROLLER_*`. With 0 for both,
 * it answers like shipped firmware. calls' functions are given usr; calls stays there as long as the controller.
 *
 * Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when controller or calls is NULL, calls has no `read` or `send`,
 * the layout is none of these, or `DP_DATA_MAX_SIZE` is below 16, a status report (13 for `DP_LAYOUT_SPEC`).
 *
 *     static const struct dp_controller_calls calls = {start_homing, start_move, stop, read_status, uart_send};
 *     static struct dp_controller controller;
 *     dp_controller_init(&controller, &calls, &uart, DP_LAYOUT_AUTO, 0);
 */
int dp_controller_init(struct dp_controller *controller, const struct dp_controller_calls *calls, void *usr, int layout,
    int flags) DP_SIZED(dp_controller_init);

/**
 * Takes received bytes. Not for an interrupt that may come during another call on the controller: there, bytes go into
 * a queue of the firmware's own.
 *
 * Returns how many were taken: all, or as many as fit. The rest fits when `dp_controller_poll` has nothing to do.
 * Returns -`DP_RC_ERROR_GENERIC` when controller is NULL, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     int got = uart_read(&uart, in, sizeof in), taken = 0;
 *     while (taken < got) {
 *         taken += dp_controller_receive(&controller, in + taken, got - taken);
 *         while (dp_controller_poll(&controller) == DP_RC_SUCCESS)
 *             ;
 *     }
 */
int dp_controller_receive(struct dp_controller *controller, const void *buf, int bytes) DP_SIZED(dp_controller_receive);

/**
 * Does one thing, in the firmware's main loop: reports the end of the operation, or answers one request.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_NO_FRAME` when there was nothing to do, or `DP_RC_ERROR_GENERIC` when controller is
 * NULL or was not made by `dp_controller_init`.
 *
 *     while (dp_controller_poll(&controller) == DP_RC_SUCCESS)
 *         ;
 */
int dp_controller_poll(struct dp_controller *controller) DP_SIZED(dp_controller_poll);

/**
 * Like `dp_controller_poll`, for a line that has been quiet for longer than a frame takes: what is incomplete is given
 * up, as by `dp_recv_idle`.
 *
 *     if (now_ms() - heard_at >= 10)
 *         dp_controller_poll_idle(&controller);
 */
int dp_controller_poll_idle(struct dp_controller *controller) DP_SIZED(dp_controller_poll_idle);

/**
 * Sends a status report unasked, as shipped firmware does at each encoder step of a move. Returns `DP_RC_SUCCESS`, or
 * `DP_RC_ERROR_GENERIC` when controller is NULL or was not made by `dp_controller_init`.
 *
 *     if (motors_state() == DP_STATUS_MOVING && motors_made_a_step())
 *         dp_controller_report(&controller);
 */
int dp_controller_report(struct dp_controller *controller) DP_SIZED(dp_controller_report);

#ifdef __cplusplus
}
#endif

#endif
