/*
 * Both ends of the GX protocol over the lines of channel.h: each run is one line quality, one pair of settings, a
 * user's random moves, and in some runs a machine that stops, a host that is started anew, or a motion side that is
 * switched off and on: one that takes moves in order only. To those that take moves from any host, there may have been
 * another one before.
 *
 * What has to hold in each run, however much is lost:
 *   - the motion side takes each move at most once, in the order of the requests, to the positions that were requested;
 *   - every request ends exactly once, in order and in bounded time;
 *   - as finished only if it was carried out, as refused or dropped only if it was not begun;
 *   - when all have finished, the machine is where the host believes it to be.
 *
 * There are no checksums, so damage can make another command or notice of one: see gx_witness.h.
 *
 * Usage: gx_channel [RUNS [FIRST_SEED]]
 */
#include "libdeltarobot/gx_host.h"

#include "machine.h"

enum {
    RUNS = 3000,
    MOVE_MS = 8000,    /* what the session is told to put up with */
    BOUND_MS = 400000 /* by when a run has to be over */
};

static struct gx_host hosts[2], *host = hosts;
static struct gx_host_settings host_settings;

static long finished, refused, failed, dropped, timed_out, lost, deviated, restarts;
static long commands, repeats, bytes_down;

/* --- the user --- */

static struct {
    int told, bad; /* requests ended, and those of them otherwise than finished */
    int32_t at[GX_AXES]; /* where it believes the axes to be, once all have finished */
    int known;
} user;

static int host_cut; /* whether a host was started anew, in the middle of a notice perhaps */

static struct gx_host_health health(void)
{
    struct gx_host_health copy;
    memset(&copy, 0xA5, sizeof copy);
    CHECK_INT(gx_host_get_health(host, &copy), GX_RC_SUCCESS);
    return copy;
}

static void user_requests(void)
{
    Request *request = &requests[requested];
    int i, rc, big = below(8) == 0;

    if (requested == REQUESTS)
        return;
    memset(request, 0, sizeof *request);
    request->axes = below(30) == 0 ? 0 : 1 + (int)below(below(6) == 0 ? 63 : 7);
    if (motion_settings.axes == 7 && below(25) != 0)
        request->axes &= 7;
    request->velocity = below(5) == 0 || request->axes == 0 ? (int)below(GX_VELOCITY_MAX + 1) : -1;
    for (i = 0; i < GX_AXES; ++i) {
        int32_t from = requested ? requests[requested - 1].target[i] : 0;
        request->target[i] = from;
        if (request->axes >> i & 1) {
            if (below(300) == 0)
                request->target[i] = below(2) ? GX_POSITION_MAX : GX_POSITION_MIN;
            else if (from > GX_POSITION_MAX - 4000 || from < GX_POSITION_MIN + 4000)
                request->target[i] = 0;
            else
                request->target[i] = from + (big ? (int32_t)below(7000) - 3500 : (int32_t)below(141) - 70);
        }
    }
    rc = gx_host_move(host, request->target, request->axes, request->velocity);
    HOLDS((rc == GX_RC_BUSY) == (requested - user.told >= GX_WINDOW_MAX), "room or not");
    requested += rc == GX_RC_SUCCESS;
    HOLDS(gx_host_unfinished(host) == requested - user.told, "how many are unfinished");
}

static void user_acts(void)
{
    int times = 1 + (int)below(below(3) == 0 ? GX_WINDOW_MAX + 2 : 4);
    while (times-- > 0)
        user_requests();
    if (below(8) == 0)
        CHECK_INT(gx_host_report(host, below(2) ? 0 : 30 + (int)below(400)), GX_RC_SUCCESS);
}

static void move_ended(const struct gx_host_event *event)
{
    Request *request = &requests[user.told];
    int i;

    HOLDS(user.told < requested, "an end too many");
    if (user.told >= requested)
        return;
    ++user.told;
    switch (event->outcome) {
    case GX_HOST_FINISHED:
        ++finished;
        HOLDS(event->code == 0, "a code");
        HOLDS(request->axes ? request->done : request->accepted, "reported as finished, and was not");
        for (i = 0; i < GX_AXES; ++i)
            if (request->axes >> i & 1) {
                user.at[i] = request->target[i];
                user.known |= 1 << i;
            }
        return;
    case GX_HOST_REFUSED:
        ++refused;
        HOLDS(!request->accepted, "reported as refused, and was accepted");
        HOLDS(event->code == GX_FAULT_AXIS && motion_settings.axes == 7 && request->axes & ~7, "refused, and why");
        break;
    case GX_HOST_FAILED:
        ++failed;
        HOLDS(request->stopped && !request->done, "failed, and was not stopped");
        HOLDS(event->code == GX_FAULT_STOPPED || event->code == 99, "the code of the stop");
        break;
    case GX_HOST_DROPPED:
        ++dropped;
        HOLDS(!request->started && (!request->accepted || request->stopped), "reported as dropped, and was begun");
        break;
    case GX_HOST_TIMED_OUT:
        ++timed_out;
        break;
    case GX_HOST_LOST:
        ++lost;
        break;
    case GX_HOST_DEVIATED:
        ++deviated;
        HOLDS(0, "deviated, and nothing was damaged");
        break;
    default:
        HOLDS(0, "no outcome");
    }
    ++user.bad;
}

/* --- faults --- */

static void begin_host(void)
{
    memset(host, 0xA5, sizeof *host);
    CHECK_INT(gx_host_init(host, &host_settings), GX_RC_SUCCESS);
    gx_notices_init(&to_host.notices);
    numbers.next = user.told;
}

static void fault_happens(void)
{
    switch (below(4)) {
    case 0:
        /* By default it would take the moves that come next, as from any host. */
        if (motion_settings.only_in_order) {
            stop_machine();
            init_motion();
        }
        break;
    case 1:
        stop_machine();
        CHECK_INT(gx_motion_stop(motion, below(2) ? 0 : 99), GX_RC_SUCCESS);
        break;
    case 2:
        /* What was requested before is nobody's any more. */
        user.told = requested;
        ++machine.faults;
        ++restarts;
        host_cut = 1;
        begin_host();
        break;
    default:
        machine.slow = !machine.slow;
        break;
    }
}

/* --- a run --- */

static void command_sent(const struct gx_item *item)
{
    unsigned place = (item->number.value - numbers.first) & GX_NUMBER_MAX;

    remember(&to_motion, item);
    ++commands;
    if (item->kind == GX_REPORTING) {
        if (item->number.format) {
            numbers.first = (item->number.value + 1u) & GX_NUMBER_MAX;
            numbers.count = 0;
            numbers.next = user.told;
        }
        return;
    }
    HOLDS(item->kind == GX_MOVE || item->kind == GX_STEP, "an unknown command");
    HOLDS(item->number.format != 0, "a move without number");
    HOLDS(place <= numbers.count, "a number was left out");
    if (place == numbers.count) {
        HOLDS(numbers.next < requested, "a command that nobody requested");
        numbers.request[item->number.value] = numbers.next++;
        ++numbers.count;
    } else {
        HOLDS(item->kind == GX_MOVE, "sent again in short form");
    }
}

static void host_sent(const unsigned char *bytes, int size)
{
    struct gx_commands reader;
    struct gx_item item;
    int taken = 0;

    bytes_down += size;
    gx_commands_init(&reader);
    while (taken < size) {
        taken += gx_commands_receive(&reader, bytes + taken, size - taken, &item);
        if (CHECK(item.kind != GX_NONE && item.kind != GX_MALFORMED))
            command_sent(&item);
    }
    transmit(&down, bytes, size);
}

static int host_receives(const unsigned char *bytes, int count)
{
    int taken = gx_host_receive(host, bytes, count, clock_ms());
    read_beside(&to_host, bytes, taken);
    return taken;
}

static void host_tells(void)
{
    struct gx_host_event event;
    while (gx_host_poll(host, clock_ms(), &event) == GX_RC_SUCCESS)
        if (event.kind == GX_HOST_ENDED)
            move_ended(&event);
        else
            HOLDS(event.kind != GX_HOST_DRIFT, "off the plan, and nothing was damaged");
}

static int host_output(void *out, int cap)
{
    return gx_host_output(host, out, cap, clock_ms());
}

/* What another host, which numbers as it pleases, was told and has not fetched: the numbers this one begins with. */
static void leave_notices(void)
{
    int i;
    for (i = 0; i < 2; ++i) {
        unsigned char out[GX_ENCODED_MAX];
        struct gx_number number;
        int size;
        number.value = (uint16_t)((host_settings.first_number + i * 5461) & GX_NUMBER_MAX);
        number.format = host_settings.ascii ? GX_ASCII : GX_BINARY;
        size = gx_write_completed(&number, out, sizeof out);
        if (CHECK(size > 0) && below(3) != 0)
            motion_sent(out, size);
    }
}

static void choose(unsigned long run)
{
    static const Quality QUALITIES[] = {
        {0, 0, 0, 0, 0, 0, 0, 0},        /* a good line */
        {0, 0, 0, 0, 0, 100, 0, 0},      /* a slow one */
        {0, 0, 0, 1000, 0, 20, 0, 0},    /* whole pieces lost */
        {0, 0, 0, 3000, 0, 100, 0, 0},   /* many of them */
        {20, 0, 0, 0, 0, 20, 0, 0},      /* single bytes lost */
        {0, 20, 0, 0, 0, 5, 0, 0},       /* flips alone */
        {100, 100, 0, 300, 0, 100, 0, 0} /* everything */
    };

    begin_run(run, QUALITIES, sizeof QUALITIES / sizeof *QUALITIES, 3000);
    start_witness(&to_motion);
    start_witness(&to_host);
    memset(&requests, 0, sizeof requests);
    memset(&user, 0, sizeof user);
    memset(&machine, 0, sizeof machine);
    memset(&host_settings, 0, sizeof host_settings);
    memset(&motion_settings, 0, sizeof motion_settings);
    memset(numbers.request, 0xFF, sizeof numbers.request);
    machine.last = -1;
    machine.slow = below(4) == 0;
    host_settings.move_ms = MOVE_MS;
    host_settings.gap_ms = HOST_GAP_MS;
    host_settings.ascii = below(3) == 0;
    host_settings.window = below(3) == 0 ? 1 : below(2) ? 0 : 1 + (int)below(GX_WINDOW_MAX);
    host_settings.first_number = below(2) ? 0 : GX_NUMBER_MAX - (int)below(5500);
    if (below(4) == 0)
        host_settings.answer_ms = 40;
    if (below(4) == 0)
        host_settings.probe_ms = 100;
    motion_settings.gap_ms = MOTION_GAP_MS;
    motion_settings.only_in_order = numbers_count = (int)below(2);
    motion_settings.axes = below(4) == 0 ? 7 : 0;
    requested = silenced = host_cut = 0;
    init_motion();
    begin_host();
    if (!motion_settings.only_in_order && below(4) == 0)
        leave_notices();
}

static void run_once(unsigned long run)
{
    unsigned long next_act = 0, next_fault;
    unsigned char out[GX_ENCODED_MAX];
    int faulty, i, size;

    choose(run);
    faulty = below(3) == 0;
    next_fault = faulty ? below(3000) : 0;
    for (;;) {
        unsigned long next;

        if (now >= next_act) {
            user_acts();
            next_act = now + 1 + below(below(4) == 0 ? 2000 : 100);
        }
        if (faulty && now >= next_fault) {
            fault_happens();
            next_fault = now + 300 + below(8000);
        }
        MOVE_AT_TIMES(host, hosts);
        MOVE_AT_TIMES(motion, motions);
        arrive(&down, 1 + (int)below(100), motion_receives, motion_does);
        arrive(&up, 1 + (int)below(100), host_receives, host_tells);
        while ((size = least_output(host_output, out)) > 0)
            host_sent(out, size);
        idle_beside();
        HOLDS(now < BOUND_MS, "a request does not end");
        if (wrong || (user.told == REQUESTS && !up.count && !down.count && !machine.count &&
                      gx_motion_unfinished(motion) == 0 && gx_host_unfinished(host) == 0))
            break;

        next = next_act;
        earlier_deadline(&next, gx_host_next_deadline(host, clock_ms()));
        earlier_deadline(&next, gx_motion_next_deadline(motion, clock_ms()));
        if (machine.count)
            earlier(&next, machine.ends);
        if (faulty)
            earlier(&next, next_fault);
        go_on(next);
    }
    repeats += (long)health().repeats;
    for (i = 0; i < GX_AXES && user.bad == 0 && machine.faults == 0; ++i)
        if (user.known >> i & 1)
            HOLDS(user.at[i] == machine.at[i], "the machine is elsewhere");
    if (!is_damaged() && !quality.lose_piece && !quality.until && !machine.faults && motion_settings.axes == 0)
        HOLDS(user.bad == 0, "a good line, and something did not finish");
    /* What is left of a notice at a new host may be another one. */
    end_run(run, is_damaged() || host_cut);
}

int main(int argc, char **argv)
{
    run_all(argc, argv, RUNS, run_once, 40);
    printf("%ld finished, %ld refused, %ld failed, %ld dropped, %ld timed out, %ld lost, %ld deviated; %ld new hosts\n", finished,
           refused, failed, dropped, timed_out, lost, deviated, restarts);
    printf("%ld commands in %ld bytes, %ld repeats\n", commands, bytes_down, repeats);
    return check_summary("gx_channel");
}
