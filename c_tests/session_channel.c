/*
 * The host session against controllers, over a line that loses, flips, delays, duplicates and splits bytes, in
 * simulated time: seeded runs, each of which is one line quality, one kind of controller and a user's random requests.
 *
 * What has to hold in each run, however bad the line:
 *   - a request is reported as finished only if the platform did it after it was requested;
 *   - every request ends exactly once, and in bounded time.
 *
 * The checksum has 8 bits, so a damaged frame passes for another one now and then, and nothing holds for what it says.
 * Such frames are known here: each message that an end understood is compared with those that the other has sent. A run
 * in which a frame was forged is counted, and what went wrong in it reported, but it proves nothing either way.
 *
 * Usage: session_channel [RUNS [FIRST_SEED]]
 */
#include "libdeltarobot/host.h"

#include "platform.h"

enum {
    RUNS = 3000,
    OPERATION_MS = 15000,   /* what the session is told to put up with */
    BOUND_MS = 25000,       /* by when any request has to have ended */
    REQUESTS = 8
};

static unsigned long clock_start; /* what the session is told is that much more than now, and wraps */
static struct dp_host host;

static long finished, refused, failed, cancelled, timed_out, forged_frames, forged_runs, forged_wrong, frames, repeats, garbage;
static int wrong;

/* A breach of what has to hold. Told at the end of the run, when it is known whether a frame was forged. */
#define HOLDS(condition, what)                                                                                        \
    do {                                                                                                              \
        if (!(condition) && !wrong) {                                                                                 \
            wrong = 1;                                                                                                \
            wrong_text = what;                                                                                        \
            wrong_at = now;                                                                                           \
        }                                                                                                             \
    } while (0)
static const char *wrong_text;
static unsigned long wrong_at;

static unsigned long clock_ms(void)
{
    return (clock_start + now) & 0xFFFFFFFFul;
}

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
        if (was_sent(&up, event->msg.opcode, event->msg.data, event->msg.data_s))
            return;
        forged = 1;
        ++forged_frames;
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
        rc = dp_host_home(&host);
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
        rc = dp_host_move(&host, &target);
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
        rc = dp_host_cancel(&host);
        HOLDS((rc == DP_RC_BUSY) == (user.cancels > user.cancel_ends), "busy with a cancel request or not");
        if (rc == DP_RC_SUCCESS) {
            ++user.cancels;
            user.cancel_at = now;
        }
    }
    if (below(6) == 0) {
        rc = dp_host_status(&host);
        HOLDS((rc == DP_RC_BUSY) == (user.statuses > user.status_ends), "busy with a status request or not");
        if (rc == DP_RC_SUCCESS) {
            ++user.statuses;
            user.status_at = now;
        }
    }
    HOLDS(dp_host_busy(&host) == is_pending(), "busy or not");
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

static void host_runs(void)
{
    unsigned char bytes[256], *rest = bytes;
    struct dp_host_event event;
    int length = arrived(&up, bytes, 1 + (int)below(200)), taken;

    do {
        taken = dp_host_receive(&host, rest, length, clock_ms());
        HOLDS(taken >= 0 && taken <= length, "took more than it was given");
        rest += taken;
        length -= taken;
        while (dp_host_poll(&host, clock_ms(), &event) == DP_RC_SUCCESS) {
            look_at(&event);
            /* A user who does not wait for the loop. */
            if (event.kind == DP_HOST_ENDED && below(2) && !is_pending() && user.operations < REQUESTS)
                request_operation();
        }
    } while (length > 0);
    length = dp_host_output(&host, bytes, below(4) == 0 ? 17 : DP_HOST_OUTPUT_MAX, clock_ms());
    if (length > 0) {
        /* Frame by frame, so that each has its own fate. */
        for (rest = bytes; length > 0; length -= rest[2] + WIRE_OVERHEAD, rest += rest[2] + WIRE_OVERHEAD) {
            plant.sendings += rest[1] == user.opcode;
            transmit(&down, rest, rest[2] + WIRE_OVERHEAD);
        }
    }
}

static void choose(unsigned long run)
{
    struct dp_host_settings settings;
    static const Quality QUALITIES[] = {
        {0, 0, 0, 0, 0, 0, 0, 0},              /* a good line */
        {0, 0, 0, 0, 0, 1000, 0, 20},          /* whole frames lost */
        {0, 0, 0, 0, 0, 3000, 1000, ONE_WAY_MS}, /* many of them, others doubled and late */
        {0, 0, 30, 30, 30, 0, 0, 20},          /* single bytes */
        {0, 0, 200, 200, 200, 300, 300, ONE_WAY_MS}, /* everything */
        {0, 0, 0, 300, 0, 0, 0, 5}             /* flips alone */
    };

    seed = run * 2654435761ul % 0xFFFFFFFFul + 1;
    now = 1;
    clock_start = below(4) == 0 ? 0xFFFFFFFFul - below(20000) : below(1000000);
    quality = QUALITIES[below(sizeof QUALITIES / sizeof *QUALITIES)];
    if (below(4) == 0) {
        quality.from = below(20000);
        quality.until = quality.from + below(12000);
    }
    memset(&down, 0, sizeof down);
    memset(&up, 0, sizeof up);
    memset(&plant, 0, sizeof plant);
    memset(&user, 0, sizeof user);
    memset(&settings, 0, sizeof settings);
    plant.firmware = below(2) != 0;
    controller_flags = plant.firmware ? 0 : DP_CONTROLLER_TELL_END | DP_CONTROLLER_TELL_ERROR;
    if (below(3) == 0)
        controller_flags |= DP_CONTROLLER_REFUSE_BUSY;
    reset_controller();
    settings.operation_ms = OPERATION_MS;
    settings.messages = 1;
    settings.doubles = quality.repeat_frame != 0;
    settings.layout = below(2) ? DP_LAYOUT_AUTO : plant.firmware ? DP_LAYOUT_FIRMWARE : DP_LAYOUT_SPEC;
    if (below(3) == 0)
        settings.ack_ms = 40;
    memset(&host, 0xA5, sizeof host);
    CHECK_INT(dp_host_init(&host, &settings), DP_RC_SUCCESS);
    forged = wrong = 0;
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
    const struct dp_host_health *health;
    unsigned long next_act = 0, next_fault;
    int faulty;

    choose(run);
    faulty = below(3) == 0;
    next_fault = faulty ? below(8000) : 0;
    for (;;) {
        long deadline;
        unsigned long next;

        if (now >= next_act) {
            user_acts();
            next_act = now + 1 + below(1200);
        }
        if (faulty && now >= next_fault) {
            fault_happens();
            next_fault = now + 500 + below(8000);
        }
        controller_runs();
        host_runs();
        HOLDS(nothing_overdue(), "a request does not end");
        if (wrong || (user.operations == REQUESTS && all_ended() && !up.count && !down.count && !is_running()) ||
            (user.operations == REQUESTS && all_ended() && plant.stuck))
            break;

        /* To the next thing that happens. The session is not looked at unless it says so, or something has come. */
        deadline = dp_host_next_deadline(&host, clock_ms());
        HOLDS(deadline >= -1, "a deadline");
        next = next_act;
        if (deadline >= 0 && now + (unsigned long)deadline < next)
            next = now + (unsigned long)deadline;
        if (up.count && up.due[up.head] < next)
            next = up.due[up.head];
        if (down.count && down.due[down.head] < next)
            next = down.due[down.head];
        if (is_running() && now + 10 < next)
            next = now + 10;
        if (faulty && next_fault < next)
            next = next_fault;
        if (next <= now)
            next = now + 1;
        now = next;
    }
    health = dp_host_get_health(&host);
    frames += (long)health->frames;
    repeats += (long)health->repeats;
    garbage += (long)health->garbage_bytes;
    CHECK_INT(health->overflows == 0 || DP_BUFSIZE < 400, 1);
    /* Where no byte is damaged, no frame is: or else this test would not know what it knows. */
    CHECK(!forged || quality.lose_byte || quality.flip_bit || quality.repeat_byte);
    forged_runs += forged;
    if (forged)
        forged_wrong += wrong;
    else if (!CHECK(!wrong))
        fprintf(stderr, "    run %lu, %lu ms: %s\n", run, wrong_at, wrong_text);
}

int main(int argc, char **argv)
{
    unsigned long runs = argc > 1 ? strtoul(argv[1], NULL, 10) : RUNS;
    unsigned long first = argc > 2 ? strtoul(argv[2], NULL, 10) : 1, run;

    for (run = first; run < first + runs && DP_DATA_MAX_SIZE >= 16; ++run)
        run_once(run);
    printf("%lu runs: %ld finished, %ld refused, %ld failed, %ld cancelled, %ld timed out\n", runs, finished, refused,
           failed, cancelled, timed_out);
    printf("%ld frames, %ld repeats, %ld bytes of garbage; %ld frames forged, in %ld runs, of which %ld went wrong\n",
           frames, repeats, garbage, forged_frames, forged_runs, forged_wrong);
    return check_summary("session_channel");
}
