/*
 * Both ends of the GX protocol over a line that loses, flips, delays and splits bytes, in simulated time: seeded runs,
 * each of which is one line quality, one pair of settings, a user's random moves, and in some runs a machine that
 * stops, a host that is started anew, or a motion side that is switched off and on: one that takes moves in order only.
 * To those that take moves from any host, there may have been another one before.
 *
 * What has to hold in each run, however much is lost:
 *   - the motion side takes each move at most once, in the order of the requests, to the positions that were requested;
 *   - every request ends exactly once, in order and in bounded time;
 *   - as finished only if it was carried out, as refused or dropped only if it was not begun;
 *   - when all have finished, the machine is where the host believes it to be.
 *
 * There are no checksums, so damage can make another command or notice of one, and nothing holds for what follows. That
 * is known here: both ends' bytes are read once more beside them, and what was read is compared with what was sent. A
 * run in which something was forged is counted, and what went wrong in it reported, but it proves nothing either way.
 *
 * Usage: gx_channel [RUNS [FIRST_SEED]]
 */
#include "libdeltarobot/gx_host.h"
#include "libdeltarobot/gx_motion.h"

#include "check.h"
#include "wire.h"

#include <stdlib.h>

enum {
    RUNS = 3000,
    REQUESTS = 60,
    MOVE_MS = 8000,         /* what the session is told to put up with */
    BOUND_MS = 400000,      /* by when a run has to be over */
    QUEUE = 16384,
    SENT = 512,
    MOTION_GAP_MS = 300,
    HOST_GAP_MS = 20
};

static unsigned long seed, now, clock_start;
static struct gx_host host;
static struct gx_motion motion;
static struct gx_host_settings host_settings;
static struct gx_motion_settings motion_settings;

static long finished, refused, failed, dropped, timed_out, lost, restarts;
static long forged_runs, forged_wrong, commands, repeats, bytes_down;
static int wrong, forged, silenced, host_cut;
static const char *wrong_text;
static unsigned long wrong_at;

/* A breach of what has to hold. Told at the end of the run, when it is known whether anything was forged. */
#define HOLDS(condition, what)                                                                                        \
    do {                                                                                                              \
        if (!(condition) && !wrong) {                                                                                 \
            wrong = 1;                                                                                                \
            wrong_text = what;                                                                                        \
            wrong_at = now;                                                                                           \
        }                                                                                                             \
    } while (0)

static unsigned below(unsigned limit)
{
    return wire_random(&seed) % limit;
}

static unsigned long clock_ms(void)
{
    return (clock_start + now) & 0xFFFFFFFFul;
}

/* --- the line --- */

typedef struct {
    unsigned lose_byte, flip_bit, lose_frame, delay; /* per 10000; delay in ms */
    unsigned long from, until;                        /* when the line is cut */
} Quality;

typedef struct {
    unsigned char bytes[QUEUE];
    unsigned long due[QUEUE];
    unsigned head, count;
    unsigned long last_due;
    struct gx_item sent[SENT]; /* what the last frames say */
    unsigned next_sent, next_read;
} Line;

static Line down, up;
static Quality quality;

static int chance(unsigned per_10000)
{
    return per_10000 != 0 && below(10000) < per_10000;
}

static void transmit(Line *line, const unsigned char *bytes, int length)
{
    unsigned long due = now + (quality.delay ? below(quality.delay) : 0);
    int i;

    if ((now >= quality.from && now < quality.until) || chance(quality.lose_frame))
        return;
    if (due < line->last_due)
        due = line->last_due;
    for (i = 0; i < length; ++i) {
        unsigned char byte = bytes[i];
        if (quality.delay && below(16) == 0 && due < now + quality.delay)
            due += below(3);
        if (chance(quality.lose_byte))
            continue;
        if (chance(quality.flip_bit))
            byte = (unsigned char)(byte ^ 1u << below(8));
        if (line->count == QUEUE)
            abort();
        line->bytes[(line->head + line->count) % QUEUE] = byte;
        line->due[(line->head + line->count) % QUEUE] = due;
        ++line->count;
        line->last_due = due;
    }
}

static int arrived(Line *line, unsigned char *out, int cap)
{
    int length = 0;
    while (length < cap && line->count > 0 && line->due[line->head] <= now) {
        out[length++] = line->bytes[line->head];
        line->head = (line->head + 1) % QUEUE;
        --line->count;
    }
    return length;
}

static void remember(Line *line, const struct gx_item *item)
{
    line->sent[line->next_sent++ % SENT] = *item;
}

static int is_same(const struct gx_item *a, const struct gx_item *b)
{
    int i;
    if (a->kind != b->kind || a->format != b->format || a->code != b->code || a->number.format != b->number.format ||
        a->period != b->period || (a->number.format && a->number.value != b->number.value) ||
        a->vector.mask != b->vector.mask)
        return 0;
    if (a->vector.mask & GX_MASK_VELOCITY && a->vector.velocity != b->vector.velocity)
        return 0;
    for (i = 0; i < GX_AXES; ++i)
        if (a->vector.mask >> i & 1 && a->vector.axes[i] != b->vector.axes[i])
            return 0;
    return 1;
}

/* What an end has read there: whether the other has sent it, behind what was read before. */
static void witness(Line *line, const struct gx_item *item)
{
    unsigned i = line->next_sent - line->next_read > SENT ? line->next_sent - SENT : line->next_read;
    if (item->kind == GX_NONE || item->kind == GX_MALFORMED)
        return;
    /* No move without a number is taken then, whatever it says; and how often the position is reported is no matter. */
    if (line == &down && motion_settings.only_in_order && !item->number.format)
        return;
    for (; i != line->next_sent; ++i)
        if (is_same(&line->sent[i % SENT], item)) {
            line->next_read = i + 1;
            return;
        }
    forged = 1;
}

/* Reads what both ends read, beside them. */
static struct {
    struct gx_commands commands;
    struct gx_notices notices;
    unsigned long commands_at, notices_at;
} beside;

static void read_beside(Line *line, const unsigned char *bytes, int length)
{
    struct gx_item item;
    int i, taken;
    for (i = 0; i < length; i += taken) {
        if (line == &down)
            taken = gx_commands_receive(&beside.commands, bytes + i, length - i, &item);
        else
            taken = gx_notices_receive(&beside.notices, bytes + i, length - i, &item);
        witness(line, &item);
    }
    if (length > 0 && line == &down)
        beside.commands_at = now;
    if (length > 0 && line == &up)
        beside.notices_at = now;
}

static void idle_beside(void)
{
    struct gx_item item;
    if (now - beside.commands_at >= MOTION_GAP_MS) {
        gx_commands_idle(&beside.commands, &item);
        witness(&down, &item);
    }
    if (now - beside.notices_at >= HOST_GAP_MS) {
        gx_notices_idle(&beside.notices, &item);
        witness(&up, &item);
    }
}

/* --- the user --- */

typedef struct {
    int32_t target[GX_AXES];
    int axes, velocity;
    int accepted, fetched, started, done, stopped, number;
    int expected_velocity; /* -1: not known */
    unsigned long requested_at;
} Request;

static struct {
    Request requests[REQUESTS];
    int count, told, bad; /* requested, ended, ended otherwise than finished */
    int32_t at[GX_AXES]; /* where it believes the axes to be, once all have finished */
    int known;
    int reporting;
    unsigned long reported_at;
} user;

/* Which request has which number, by the commands that the host sends. */
static struct {
    int request[GX_NUMBER_MAX + 1];
    unsigned first, count;
    int next;
} numbers;

static void user_requests(void)
{
    Request *request = &user.requests[user.count];
    int i, rc, big = below(8) == 0;

    if (user.count == REQUESTS)
        return;
    memset(request, 0, sizeof *request);
    request->axes = below(30) == 0 ? 0 : 1 + (int)below(below(6) == 0 ? 63 : 7);
    if (motion_settings.axes == 7 && below(25) != 0)
        request->axes &= 7;
    request->velocity = below(5) == 0 || request->axes == 0 ? (int)below(GX_VELOCITY_MAX + 1) : -1;
    for (i = 0; i < GX_AXES; ++i) {
        int32_t from = user.count ? user.requests[user.count - 1].target[i] : 0;
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
    rc = gx_host_move(&host, request->target, request->axes, request->velocity);
    HOLDS((rc == GX_RC_BUSY) == (user.count - user.told >= GX_WINDOW_MAX), "room or not");
    HOLDS(gx_host_unfinished(&host) == user.count - user.told + (rc == GX_RC_SUCCESS), "how many are unfinished");
    if (rc == GX_RC_SUCCESS) {
        request->requested_at = now;
        ++user.count;
    }
}

static void user_acts(void)
{
    int times = 1 + (int)below(below(3) == 0 ? GX_WINDOW_MAX + 2 : 4);
    while (times-- > 0)
        user_requests();
    if (below(8) == 0) {
        user.reporting = below(2) ? 0 : 30 + (int)below(400);
        CHECK_INT(gx_host_report(&host, user.reporting), GX_RC_SUCCESS);
    }
}

static void move_ended(const struct gx_host_event *event)
{
    Request *request = &user.requests[user.told];
    int i;

    HOLDS(user.told < user.count, "an end too many");
    if (user.told >= user.count)
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
        HOLDS(event->code == GX_FAULT_AXIS && motion_settings.axes == 7 && request->axes & ~7, "refused without reason");
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
    default:
        HOLDS(0, "no outcome");
    }
    ++user.bad;
}

/* --- the machine --- */

static struct {
    int32_t at[GX_AXES];
    struct gx_vector ahead[3]; /* fetched moves, the first of which is carried out */
    int requests[3], count;
    unsigned long ends;
    int velocity, last; /* in force; the last request accepted */
    int slow, faults;
} machine;

static int request_of(int number)
{
    int request = number < 0 ? -1 : numbers.request[number];
    HOLDS(request >= 0, "a move that nobody requested");
    return request;
}

static void accepted(int number)
{
    int index = request_of(number);
    Request *request;
    if (index < 0)
        return;
    request = &user.requests[index];
    HOLDS(!request->accepted, "a move was taken twice");
    HOLDS(index > machine.last, "moves were taken out of order");
    request->accepted = 1;
    request->number = number;
    machine.last = index;
    if (request->velocity >= 0)
        machine.velocity = request->velocity;
    request->expected_velocity = machine.velocity;
}

static void start_move(void)
{
    if (machine.count == 0)
        return;
    if (machine.requests[0] >= 0) {
        Request *request = &user.requests[machine.requests[0]];
        HOLDS(!request->started, "a move was begun twice");
        request->started = 1;
    }
    machine.ends = now + (machine.slow && below(20) == 0 ? 1000 + below(4000) : below(8) == 0 ? 0 : below(60));
}

static void fetch_move(void)
{
    struct gx_vector move;
    int number, i, index = 0;
    Request *request = user.requests;

    if (gx_motion_next(&motion, &move, &number) != GX_RC_SUCCESS)
        return;
    while (index < user.count && (!request->accepted || !request->axes || request->fetched || request->stopped)) {
        ++index;
        ++request;
    }
    if (index == user.count) {
        HOLDS(0, "a move is there that was not queued");
        index = -1;
    } else {
        request->fetched = 1;
        /* Those of an earlier session are not told any more. */
        HOLDS(number == request->number || (number == -1 && silenced), "another number");
        HOLDS((move.mask & GX_MASK_AXES & ~request->axes) == 0 && move.mask & GX_MASK_AXES, "other axes");
        for (i = 0; i < GX_AXES; ++i)
            if (request->axes >> i & 1)
                HOLDS(move.axes[i] == request->target[i], "another target");
        if (request->expected_velocity >= 0)
            HOLDS(move.mask & GX_MASK_VELOCITY && move.velocity == request->expected_velocity, "another velocity");
    }
    machine.ahead[machine.count] = move;
    machine.requests[machine.count++] = index;
    if (machine.count == 1)
        start_move();
}

static void machine_runs(void)
{
    int i;
    while (machine.count < 3 && (machine.count == 0 || below(2))) {
        int before = machine.count;
        fetch_move();
        if (machine.count == before)
            break;
    }
    while (machine.count > 0 && now >= machine.ends) {
        for (i = 0; i < GX_AXES; ++i)
            if (machine.ahead[0].mask >> i & 1)
                machine.at[i] = machine.ahead[0].axes[i];
        if (machine.requests[0] >= 0)
            user.requests[machine.requests[0]].done = 1;
        CHECK_INT(gx_motion_done(&motion), GX_RC_SUCCESS);
        --machine.count;
        for (i = 0; i < machine.count; ++i) {
            machine.ahead[i] = machine.ahead[i + 1];
            machine.requests[i] = machine.requests[i + 1];
        }
        if (machine.count == 0)
            fetch_move();
        else
            start_move();
    }
    CHECK_INT(gx_motion_set_position(&motion, machine.at), GX_RC_SUCCESS);
}

/* Room for output: the least that something fits in is given. */
enum { ROOMS = 5 };
static const int ROOM[ROOMS] = {4, 8, 14, 32, GX_ENCODED_MAX};

static void motion_sent(const unsigned char *bytes, int size)
{
    struct gx_notices reader;
    struct gx_item item;
    int taken = 0;

    gx_notices_init(&reader);
    while (taken < size) {
        taken += gx_notices_receive(&reader, bytes + taken, size - taken, &item);
        if (taken == size && item.kind == GX_NONE)
            gx_notices_idle(&reader, &item);
        CHECK(item.kind != GX_NONE && item.kind != GX_MALFORMED);
        remember(&up, &item);
    }
}

static void motion_runs(void)
{
    unsigned char bytes[128], *rest = bytes;
    struct gx_motion_event event;
    int length = arrived(&down, bytes, 1 + (int)below(100)), taken, tries = 0;

    read_beside(&down, bytes, length);
    do {
        taken = gx_motion_receive(&motion, rest, length, clock_ms());
        HOLDS(taken >= 0 && taken <= length, "took more than it was given");
        HOLDS(++tries < 1000, "nothing is taken");
        rest += taken;
        length -= taken;
        while (gx_motion_poll(&motion, clock_ms(), &event) == GX_RC_SUCCESS) {
            if (event.kind == GX_MOTION_QUEUED)
                accepted(event.number);
            else if (event.kind == GX_MOTION_BEGUN && gx_motion_unfinished(&motion) > 0)
                silenced = 1;
        }
        machine_runs();
        for (;;) {
            unsigned char out[GX_ENCODED_MAX];
            int size = 0, i;
            /* Few at a time, which share a fate. */
            for (i = 0; size == 0 && i < ROOMS; ++i)
                size = gx_motion_output(&motion, out, ROOM[i], clock_ms());
            if (size == 0)
                break;
            motion_sent(out, size);
            transmit(&up, out, size);
        }
    } while (length > 0 && !wrong);
}

static void stop_machine(void)
{
    int i;
    for (i = 0; i < REQUESTS; ++i)
        if (user.requests[i].accepted && !user.requests[i].done)
            user.requests[i].stopped = 1;
    machine.count = 0;
    ++machine.faults;
}

static void reset_motion(void)
{
    stop_machine();
    memset(&motion, 0x5A, sizeof motion);
    CHECK_INT(gx_motion_init(&motion, &motion_settings), GX_RC_SUCCESS);
    machine.velocity = -1;
    /* What it was receiving is gone too. */
    gx_commands_init(&beside.commands);
}

static void begin_host(void)
{
    memset(&host, 0xA5, sizeof host);
    CHECK_INT(gx_host_init(&host, &host_settings), GX_RC_SUCCESS);
    gx_notices_init(&beside.notices);
    numbers.next = user.told;
}

static void fault_happens(void)
{
    switch (below(4)) {
    case 0:
        /* By default it would take the moves that come next, as from any host. */
        if (motion_settings.only_in_order)
            reset_motion();
        break;
    case 1:
        stop_machine();
        CHECK_INT(gx_motion_stop(&motion, below(2) ? 0 : 99), GX_RC_SUCCESS);
        break;
    case 2:
        /* What was requested before is nobody's any more. */
        user.told = user.count;
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

    remember(&down, item);
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
        HOLDS(numbers.next < user.count, "a command that nobody requested");
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
}

static void host_runs(void)
{
    unsigned char bytes[128], *rest = bytes;
    struct gx_host_event event;
    int length = arrived(&up, bytes, 1 + (int)below(100)), taken, tries = 0;

    read_beside(&up, bytes, length);
    do {
        taken = gx_host_receive(&host, rest, length, clock_ms());
        HOLDS(taken >= 0 && taken <= length, "took more than it was given");
        HOLDS(++tries < 1000, "nothing is taken");
        rest += taken;
        length -= taken;
        while (gx_host_poll(&host, clock_ms(), &event) == GX_RC_SUCCESS)
            if (event.kind == GX_HOST_ENDED)
                move_ended(&event);
    } while (length > 0 && !wrong);
    for (;;) {
        unsigned char out[GX_ENCODED_MAX];
        int size = 0, i;
        for (i = 0; size == 0 && i < ROOMS; ++i)
            size = gx_host_output(&host, out, ROOM[i], clock_ms());
        if (size == 0)
            break;
        host_sent(out, size);
        transmit(&down, out, size);
    }
}

/* What another host, which numbers as it pleases, was told and has not fetched: the numbers that this one begins with. */
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
        if (CHECK(size > 0) && below(3) != 0) {
            motion_sent(out, size);
            transmit(&up, out, size);
        }
    }
}

static void choose(unsigned long run)
{
    static const Quality QUALITIES[] = {
        {0, 0, 0, 0, 0, 0},        /* a good line */
        {0, 0, 0, 100, 0, 0},      /* a slow one */
        {0, 0, 1000, 20, 0, 0},    /* whole frames lost */
        {0, 0, 3000, 100, 0, 0},   /* many of them */
        {20, 0, 0, 20, 0, 0},      /* single bytes lost */
        {0, 20, 0, 5, 0, 0},       /* flips alone */
        {100, 100, 300, 100, 0, 0} /* everything */
    };

    seed = run * 2654435761ul % 0xFFFFFFFFul + 1;
    now = 1;
    clock_start = below(4) == 0 ? 0xFFFFFFFFul - below(20000) : below(1000000);
    quality = QUALITIES[below(sizeof QUALITIES / sizeof *QUALITIES)];
    if (below(5) == 0) {
        quality.from = below(3000);
        quality.until = quality.from + below(12000);
    }
    memset(&down, 0, sizeof down);
    memset(&up, 0, sizeof up);
    memset(&user, 0, sizeof user);
    memset(&machine, 0, sizeof machine);
    memset(&beside, 0, sizeof beside);
    memset(&host_settings, 0, sizeof host_settings);
    memset(&motion_settings, 0, sizeof motion_settings);
    memset(numbers.request, 0xFF, sizeof numbers.request);
    machine.velocity = machine.last = -1;
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
    motion_settings.only_in_order = (int)below(2);
    motion_settings.axes = below(4) == 0 ? 7 : 0;
    wrong = forged = silenced = host_cut = 0;
    memset(&motion, 0x5A, sizeof motion);
    CHECK_INT(gx_motion_init(&motion, &motion_settings), GX_RC_SUCCESS);
    begin_host();
    if (!motion_settings.only_in_order && below(4) == 0)
        leave_notices();
}

static void earlier(unsigned long *next, long deadline)
{
    HOLDS(deadline >= -1, "a deadline");
    if (deadline >= 0 && now + (unsigned long)deadline < *next)
        *next = now + (unsigned long)deadline;
}

static void run_once(unsigned long run)
{
    unsigned long next_act = 0, next_fault;
    int faulty, i, all_known;

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
        motion_runs();
        host_runs();
        idle_beside();
        HOLDS(now < BOUND_MS, "a request does not end");
        if (wrong || (user.told == REQUESTS && !up.count && !down.count && !machine.count &&
                      gx_motion_unfinished(&motion) == 0 && gx_host_unfinished(&host) == 0))
            break;

        /* To the next thing that happens. The ends are not looked at unless they say so, or something has come. */
        next = next_act;
        earlier(&next, gx_host_next_deadline(&host, clock_ms()));
        earlier(&next, gx_motion_next_deadline(&motion, clock_ms()));
        if (up.count && up.due[up.head] < next)
            next = up.due[up.head];
        if (down.count && down.due[down.head] < next)
            next = down.due[down.head];
        if (machine.count && machine.ends < next)
            next = machine.ends;
        if (faulty && next_fault < next)
            next = next_fault;
        now = next <= now ? now + 1 : next;
    }
    repeats += (long)gx_host_get_health(&host)->repeats;
    all_known = user.bad == 0 && machine.faults == 0;
    for (i = 0; i < GX_AXES && all_known; ++i)
        if (user.known >> i & 1)
            HOLDS(user.at[i] == machine.at[i], "the machine is elsewhere");
    if (!quality.lose_byte && !quality.flip_bit && !quality.lose_frame && !quality.until && !machine.faults &&
        motion_settings.axes == 0)
        HOLDS(user.bad == 0, "a good line, and something did not finish");
    /* Where no byte is damaged, nothing is forged: or else this test would not know what it knows. (What is left of a
     * notice at a new host may be another one.) */
    CHECK(!forged || quality.lose_byte || quality.flip_bit || host_cut);
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

    for (run = first; run < first + runs; ++run)
        run_once(run);
    printf("%lu runs: %ld finished, %ld refused, %ld failed, %ld dropped, %ld timed out, %ld lost; %ld new hosts\n", runs,
           finished, refused, failed, dropped, timed_out, lost, restarts);
    printf("%ld commands in %ld bytes, %ld repeats; something forged in %ld runs, of which %ld went wrong\n", commands,
           bytes_down, repeats, forged_runs, forged_wrong);
    return check_summary("gx_channel");
}
