/*
 * The host session against controllers over the lines of channel.h: each run is one line quality, one kind of
 * controller and a user's random requests.
 *
 * What has to hold in each run, however bad the line:
 *   - a request is reported as finished only if the platform did it after it was requested;
 *   - every request ends exactly once, and in bounded time.
 *
 * Usage: session_channel [RUNS [FIRST_SEED]]
 */
#include "libdeltarobot/host.h"

#include "platform.h"

enum {
    RUNS = 3000,
    OPERATION_MS = 15000, /* what the session is told to put up with */
    BOUND_MS = 25000,     /* by when any request has to have ended */
    REQUESTS = 8
};

static struct dp_host hosts[2], *host = hosts;

static long finished, refused, failed, cancelled, timed_out;
static long forged_frames, frames, retransmissions, garbage;

/* --- the user --- */

static struct {
    unsigned char opcode; /* of the operation requested */
    int operations, operation_ends, cancels, cancel_ends, statuses, status_ends;
    unsigned long operation_at, cancel_at, status_at;
} user;

static int is_pending(void)
{
    return user.operations > user.operation_ends;
}

static void operation_ended(const struct dp_host_event *event)
{
    ++user.operation_ends;
    HOLDS(user.operation_ends == user.operations, "an operation ended twice");
    HOLDS(event->opcode == user.opcode, "another operation ended than was requested");
    switch (event->outcome) {
    case DP_HOST_FINISHED:
        ++finished;
        if (user.opcode == DP_OPCODE_HOMING)
            HOLDS(plant.homings > 0, "homing was reported finished, and was not");
        else
            HOLDS(plant.arrivals > 0, "a move was reported finished, and was not");
        break;
    case DP_HOST_REFUSED:
        ++refused;
        HOLDS(plant.nacks > 0, "refused without a nack");
        break;
    case DP_HOST_FAILED:
        ++failed;
        HOLDS(plant.faults > 0, "failed without a fault");
        break;
    case DP_HOST_CANCELLED:
        ++cancelled;
        HOLDS(user.cancels > 0, "cancelled without a request");
        HOLDS(plant.sendings == 0 || !is_running(), "cancelled, and runs");
        break;
    case DP_HOST_TIMED_OUT:
        ++timed_out;
        break;
    default:
        HOLDS(0, "no outcome");
    }
}

static void look_at(const struct dp_host_event *event)
{
    switch (event->kind) {
    case DP_HOST_MESSAGE:
        forged_frames += !was_sent(&from_controller, event->msg.opcode, event->msg.data, event->msg.data_s);
        break;
    case DP_HOST_ENDED:
        if (event->opcode == DP_OPCODE_CANCEL) {
            ++user.cancel_ends;
            HOLDS(user.cancel_ends == user.cancels, "a cancel request ended twice");
        } else if (event->opcode == DP_OPCODE_STATUS) {
            ++user.status_ends;
            HOLDS(user.status_ends == user.statuses, "a status request ended twice");
        } else {
            operation_ended(event);
        }
        break;
    default:
        break;
    }
}

static void request_operation(void)
{
    int i, rc;
    float before[3];
    memcpy(before, plant.wanted, sizeof before);

    plant.homings = plant.arrivals = plant.faults = plant.nacks = plant.sendings = 0;
    if (plant.state == DP_STATUS_ERROR)
        ++plant.faults;
    if (below(3) == 0 || !plant.known) {
        user.opcode = DP_OPCODE_HOMING;
        rc = dp_host_home(host);
    } else {
        struct protocol_msg_position target;
        user.opcode = DP_OPCODE_MOVE;
        /* Now and then to where it is, or was told to go before. */
        for (i = 0; i < 3; ++i)
            plant.wanted[i] = below(10) == 0 ? plant.at[i] : (float)((int)below(400) - 200) / 4;
        if (below(10) == 0)
            memcpy(plant.wanted, before, sizeof before);
        target.DA = plant.wanted[0];
        target.DB = plant.wanted[1];
        target.DC = plant.wanted[2];
        rc = dp_host_move(host, &target);
    }
    HOLDS(rc == DP_RC_SUCCESS, "a request was not taken");
    ++user.operations;
    user.operation_at = now;
}

static void user_acts(void)
{
    int rc;
    if (user.operations < REQUESTS && !is_pending() && below(3) != 0) {
        request_operation();
        return;
    }
    if (is_pending() && below(4) == 0) {
        rc = dp_host_cancel(host);
        HOLDS((rc == DP_RC_BUSY) == (user.cancels > user.cancel_ends), "busy with a cancel request or not");
        if (rc == DP_RC_SUCCESS) {
            ++user.cancels;
            user.cancel_at = now;
        }
    }
    if (below(6) == 0) {
        rc = dp_host_status(host);
        HOLDS((rc == DP_RC_BUSY) == (user.statuses > user.status_ends), "busy with a status request or not");
        if (rc == DP_RC_SUCCESS) {
            ++user.statuses;
            user.status_at = now;
        }
    }
    HOLDS(dp_host_busy(host) == is_pending(), "busy or not");
}

static void fault_happens(void)
{
    switch (below(4)) {
    case 0:
        reset_controller();
        break;
    case 1:
        stand(DP_STATUS_ERROR);
        ++plant.faults;
        break;
    case 2:
        /* Nobody could tell an error that was cleared unseen from the end of homing, if not by the position. */
        if (plant.state == DP_STATUS_ERROR) {
            stand(DP_STATUS_IDLE);
            plant.known = 0;
        }
        break;
    default:
        plant.stuck = !plant.stuck;
        break;
    }
}

/* --- a run --- */

static int host_receives(const unsigned char *bytes, int count)
{
    return dp_host_receive(host, bytes, count, clock_ms());
}

static void host_tells(void)
{
    struct dp_host_event event;
    while (dp_host_poll(host, clock_ms(), &event) == DP_RC_SUCCESS) {
        look_at(&event);
        /* A user who does not wait for the loop. */
        if (event.kind == DP_HOST_ENDED && below(2) && !is_pending() && user.operations < REQUESTS)
            request_operation();
    }
}

static void host_runs(void)
{
    unsigned char bytes[DP_HOST_OUTPUT_MAX], *frame = bytes;
    int length;

    arrive(&up, 1 + (int)below(200), host_receives, host_tells);
    length = dp_host_output(host, bytes, below(4) == 0 ? 17 : DP_HOST_OUTPUT_MAX, clock_ms());
    /* Frame by frame, so that each has its own fate. */
    while (frame < bytes + length) {
        int size = frame[2] + WIRE_OVERHEAD;
        plant.sendings += frame[1] == user.opcode;
        send_frame(&down, &from_host, frame, size);
        frame += size;
    }
}

static void choose(unsigned long run)
{
    struct dp_host_settings settings;
    static const Quality QUALITIES[] = {
        {0, 0, 0, 0, 0, 0, 0, 0},                    /* a good line */
        {0, 0, 0, 1000, 0, 20, 0, 0},                /* whole frames lost */
        {0, 0, 0, 3000, 1000, ONE_WAY_MS, 0, 0},     /* many of them, others doubled and late */
        {30, 30, 30, 0, 0, 20, 0, 0},                /* single bytes */
        {200, 200, 200, 300, 300, ONE_WAY_MS, 0, 0}, /* everything */
        {0, 300, 0, 0, 0, 5, 0, 0}                   /* flips alone */
    };

    begin_run(run, QUALITIES, sizeof QUALITIES / sizeof *QUALITIES, 20000);
    memset(&from_host, 0, sizeof from_host);
    memset(&from_controller, 0, sizeof from_controller);
    memset(&plant, 0, sizeof plant);
    memset(&user, 0, sizeof user);
    memset(&settings, 0, sizeof settings);
    plant.firmware = below(2) != 0;
    plant.unpadded = below(2) != 0;
    controller_flags = plant.firmware ? 0 : DP_CONTROLLER_REPORT_END | DP_CONTROLLER_REPORT_ERROR;
    if (below(3) == 0)
        controller_flags |= DP_CONTROLLER_REFUSE_BUSY;
    reset_controller();
    settings.operation_ms = OPERATION_MS;
    settings.messages = 1;
    settings.duplicates = quality.repeat_piece != 0;
    settings.layout = below(2) ? DP_LAYOUT_AUTO : plant.firmware ? DP_LAYOUT_FIRMWARE : DP_LAYOUT_SPEC;
    if (below(3) == 0)
        settings.ack_ms = 40;
    memset(host, 0xA5, sizeof *host);
    CHECK_INT(dp_host_init(host, &settings), DP_RC_SUCCESS);
}

static int all_ended(void)
{
    return user.operations == user.operation_ends && user.cancels == user.cancel_ends &&
           user.statuses == user.status_ends;
}

static int nothing_overdue(void)
{
    return (user.operations == user.operation_ends || now - user.operation_at <= BOUND_MS) &&
           (user.cancels == user.cancel_ends || now - user.cancel_at <= BOUND_MS) &&
           (user.statuses == user.status_ends || now - user.status_at <= BOUND_MS);
}

static void run_once(unsigned long run)
{
    struct dp_host_health health;
    unsigned long next_act = 0, next_fault;
    int faulty;

    choose(run);
    faulty = below(3) == 0;
    next_fault = faulty ? below(8000) : 0;
    for (;;) {
        unsigned long next;

        if (now >= next_act) {
            user_acts();
            next_act = now + 1 + below(1200);
        }
        if (faulty && now >= next_fault) {
            fault_happens();
            next_fault = now + 500 + below(8000);
        }
        MOVE_AT_TIMES(host, hosts);
        MOVE_AT_TIMES(controller, controllers);
        controller_runs();
        host_runs();
        HOLDS(nothing_overdue(), "a request does not end");
        if (wrong || (user.operations == REQUESTS && all_ended() && !up.count && !down.count && !is_running()) ||
            (user.operations == REQUESTS && all_ended() && plant.stuck))
            break;

        next = next_act;
        earlier_deadline(&next, dp_host_next_deadline(host, clock_ms()));
        if (is_running())
            earlier(&next, now + 10);
        if (faulty)
            earlier(&next, next_fault);
        go_on(next);
    }
    CHECK_INT(dp_host_get_health(host, &health), DP_RC_SUCCESS);
    frames += (long)health.frames;
    retransmissions += (long)health.retransmissions;
    garbage += (long)health.garbage_bytes;
    end_run(run, is_damaged());
}

int main(int argc, char **argv)
{
    run_all(argc, argv, DP_DATA_MAX_SIZE < 16 ? 0 : RUNS, run_once, 10);
    printf("%ld finished, %ld refused, %ld failed, %ld cancelled, %ld timed out\n", finished, refused, failed,
           cancelled, timed_out);
    printf("%ld frames, %ld of them forged, %ld retransmissions, %ld bytes of garbage\n", frames, forged_frames, retransmissions,
           garbage);
    return check_summary("session_channel");
}
