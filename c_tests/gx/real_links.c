/*
 * What a real link costs: both ends of the GX protocol on a serial line of 115200 baud, whose bytes are flipped now and
 * then, with a machine that carries out what it was told, and figures of that.
 *
 *   - Of the moves that are reported as finished, at most 1 in 1,000 were not made as requested, at 1 flipped bit in
 *     10,000 bytes and with windows of 1, 4 and 16; the positions that are sent so that nothing drifts cost at most 5 %
 *     more bytes; and without flips all moves are made, and none is said to have deviated.
 *   - A completion needs no waiting: a move of a clean line with window 1 takes 4 ms at most, in binary and in ASCII.
 *   - A controller that only sends numbers back is driven, and what it reports as finished was carried out.
 *   - A host that holds and resumes loses nothing; one that stops is told where.
 *
 * Usage: gx_real_links [MOVES [SEED]], by default 4000 of them in each run; the figures in docs/gx-protocol.md are those
 * of 100000.
 */
#include "libdeltarobot/gx_host.h"
#include "libdeltarobot/gx_motion.h"

#include "check.h"
#include "wire.h"

#include <stdlib.h>

enum { BYTE_US = 87, MOVE_US = 1000, WIRE = 4096, AXES_USED = 3 };

typedef struct {
    int32_t target[GX_AXES];
    int axes, velocity; /* as requested; -1: as before */
    int known, in_force; /* named in the session so far; the velocity then in force, -1: not known */
    int right; /* carried out as requested */
} Request;

/* Bytes on their way: one leaves at a time. */
typedef struct {
    unsigned char bytes[WIRE];
    unsigned head, count;
    long sent, flipped;
} Wire;

typedef struct {
    int window, ascii, flips, absolute_every, echo;
} Setup;

static unsigned long seed;
static unsigned long long now_us;
static Wire down, up;
static struct gx_host host;
static struct gx_motion motion;
static Request *requests;
static long requested, ended, moves;
static long outcomes[GX_HOST_DEVIATED + 1], wrong_finished, drifts, unanswered, statuses, holds, stops;
static struct gx_vector stopped_at;
static const Setup *setup;

/* Which request has which number, by the commands that the host sends. */
static long request_of[GX_NUMBER_MAX + 1];
static long next_request;
static int session_axes, session_velocity;

static struct {
    struct gx_vector move;
    int moving, number, held;
    unsigned long long ends;
} machine;

/* A controller that knows the posted proposal and no more: carries out one command after the other. */
static struct {
    struct gx_commands commands;
    struct gx_item queue[64];
    unsigned head, count;
    struct gx_vector at;
    unsigned long long ends;
} plain;

static unsigned below(unsigned limit)
{
    return wire_random(&seed) % limit;
}

static unsigned long now_ms(void)
{
    return (unsigned long)(now_us / 1000);
}

static void put(Wire *wire, const unsigned char *bytes, int count)
{
    while (count-- > 0) {
        unsigned char byte = *bytes++;
        if (wire->count == WIRE)
            abort();
        ++wire->sent;
        if (setup->flips && below(10000) < (unsigned)setup->flips) {
            byte = (unsigned char)(byte ^ 1u << below(8));
            ++wire->flipped;
        }
        wire->bytes[(wire->head + wire->count++) % WIRE] = byte;
    }
}

static int take(Wire *wire, unsigned char *byte)
{
    if (wire->count == 0)
        return 0;
    *byte = wire->bytes[wire->head];
    wire->head = (wire->head + 1) % WIRE;
    --wire->count;
    return 1;
}

/* --- the user --- */

static void request_move(void)
{
    Request *request = &requests[requested];
    int i, big = below(8) == 0;

    memset(request, 0, sizeof *request);
    request->axes = requested ? 1 + (int)below((1 << AXES_USED) - 1) : (1 << AXES_USED) - 1;
    request->velocity = below(5) == 0 ? (int)below(GX_VELOCITY_MAX + 1) : -1;
    for (i = 0; i < AXES_USED; ++i) {
        long from = requested ? requests[requested - 1].target[i] : 0;
        if (request->axes >> i & 1)
            from = from > 100000 || from < -100000 ? 0 : from + (big ? (long)below(7000) - 3500 : (long)below(141) - 70);
        request->target[i] = (int32_t)from;
    }
    if (gx_host_move(&host, request->target, request->axes, request->velocity) == GX_RC_SUCCESS)
        ++requested;
}

static void handle_host(const struct gx_host_event *event)
{
    switch (event->kind) {
    case GX_HOST_ENDED:
        ++outcomes[event->outcome];
        if (event->outcome == GX_HOST_FINISHED && !requests[ended].right)
            ++wrong_finished;
        ++ended;
        break;
    case GX_HOST_DRIFT:
        ++drifts;
        break;
    case GX_HOST_STATUS:
        ++statuses;
        holds += event->code;
        break;
    case GX_HOST_STOPPED:
        ++stops;
        stopped_at = event->position;
        break;
    case GX_HOST_UNANSWERED:
        ++unanswered;
        break;
    default:
        break;
    }
}

/* What the host sends, read where it leaves. */
static void host_sent(const unsigned char *bytes, int count)
{
    struct gx_commands reader;
    struct gx_item item;
    int taken = 0;

    gx_commands_init(&reader);
    while (taken < count) {
        taken += gx_commands_receive(&reader, bytes + taken, count - taken, &item);
        if (item.kind == GX_REPORTING && item.number.format) {
            memset(request_of, 0xFF, sizeof request_of);
            next_request = ended;
            session_axes = 0;
            session_velocity = -1;
        } else if ((item.kind == GX_MOVE || item.kind == GX_STEP) && request_of[item.number.value] < ended) {
            Request *request = &requests[next_request];
            request_of[item.number.value] = next_request++;
            session_axes |= request->axes;
            session_velocity = request->velocity >= 0 ? request->velocity : session_velocity;
            request->known = session_axes;
            request->in_force = session_velocity;
        }
    }
    put(&down, bytes, count);
}

/* --- the machine --- */

static int is_right(const Request *request, const struct gx_vector *move)
{
    int i;
    for (i = 0; i < AXES_USED; ++i)
        if (request->known >> i & 1 && move->axes[i] != request->target[i])
            return 0;
    return request->in_force < 0 || (move->mask & GX_MASK_VELOCITY && move->velocity == request->in_force);
}

static void run_machine(void)
{
    if (machine.moving && now_us >= machine.ends) {
        long index = machine.number < 0 ? -1 : request_of[machine.number];
        if (index >= 0)
            requests[index].right = is_right(&requests[index], &machine.move);
        gx_motion_set_position(&motion, machine.move.axes);
        gx_motion_done(&motion);
        machine.moving = 0;
    }
    if (!machine.moving && gx_motion_next(&motion, &machine.move, &machine.number) == GX_RC_SUCCESS) {
        machine.moving = 1;
        machine.ends = now_us + MOVE_US;
    }
}

static void motion_gets(unsigned char byte)
{
    struct gx_motion_event event;
    while (gx_motion_receive(&motion, &byte, 1, now_ms()) == 0)
        gx_motion_poll(&motion, now_ms(), &event);
}

static void run_motion(void)
{
    struct gx_motion_event event;
    unsigned char out[GX_ENCODED_MAX];
    int count;

    while (gx_motion_poll(&motion, now_ms(), &event) == GX_RC_SUCCESS)
        if (event.kind == GX_MOTION_STOP) {
            machine.moving = 0;
            gx_motion_stop(&motion, 0);
        }
    run_machine();
    while (up.count < 64 && (count = gx_motion_output(&motion, out, sizeof out, now_ms())) > 0)
        put(&up, out, count);
}

static void plain_gets(unsigned char byte)
{
    struct gx_item item;
    while (gx_commands_receive(&plain.commands, &byte, 1, &item) == 0)
        if (item.kind == GX_MALFORMED) /* by which the host may send it again */
            plain.queue[(plain.head + plain.count++) % 64] = item;
    if (item.kind != GX_NONE && plain.count < 64)
        plain.queue[(plain.head + plain.count++) % 64] = item;
}

static void run_plain(void)
{
    struct gx_item *item = &plain.queue[plain.head];
    unsigned char out[GX_ENCODED_MAX];
    int count = 0;

    if (plain.count == 0 || now_us < plain.ends)
        return;
    if (item->kind == GX_MALFORMED || item->kind == GX_CONTROL) {
        count = gx_write_refused(item->format, &item->number, GX_FAULT_UNKNOWN, out, sizeof out);
    } else {
        gx_follow(&plain.at, item);
        if (item->number.format)
            count = gx_write_completed(&item->number, out, sizeof out);
        if (item->kind == GX_MOVE && item->number.format && request_of[item->number.value] >= 0) {
            Request *request = &requests[request_of[item->number.value]];
            request->right = is_right(request, &plain.at);
        }
    }
    if (count > 0)
        put(&up, out, count);
    plain.head = (plain.head + 1) % 64;
    --plain.count;
    plain.ends = now_us + MOVE_US;
}

/* --- runs --- */

static void begin(const Setup *of)
{
    struct gx_host_settings settings;
    struct gx_motion_settings motion_settings;
    static const int32_t origin[GX_AXES] = {0, 0, 0, 0, 0, 0};

    setup = of;
    now_us = 0;
    requested = ended = wrong_finished = drifts = unanswered = statuses = holds = stops = 0;
    memset(outcomes, 0, sizeof outcomes);
    memset(&down, 0, sizeof down);
    memset(&up, 0, sizeof up);
    memset(&machine, 0, sizeof machine);
    memset(&plain, 0, sizeof plain);
    memset(request_of, 0xFF, sizeof request_of);
    next_request = 0;
    session_axes = 0;
    session_velocity = -1;
    memset(&settings, 0, sizeof settings);
    settings.window = of->window;
    settings.ascii = of->ascii;
    settings.absolute_every = of->absolute_every;
    settings.echo = of->echo;
    settings.probe_ms = 200;
    gx_host_init(&host, &settings);
    memset(&motion_settings, 0, sizeof motion_settings);
    motion_settings.only_in_order = 1;
    motion_settings.gap_ms = 100;
    gx_motion_init(&motion, &motion_settings);
    gx_motion_set_position(&motion, origin);
    gx_commands_init(&plain.commands);
}

/* A byte's time. */
static void step(void)
{
    struct gx_host_event event;
    unsigned char byte, out[GX_ENCODED_MAX];
    int count;

    now_us += BYTE_US;
    if (take(&down, &byte)) {
        if (setup->echo)
            plain_gets(byte);
        else
            motion_gets(byte);
    }
    if (setup->echo)
        run_plain();
    else
        run_motion();
    if (take(&up, &byte))
        while (gx_host_receive(&host, &byte, 1, now_ms()) == 0 &&
               gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
            handle_host(&event);
    while (gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
        handle_host(&event);
    while (down.count < 32 && (count = gx_host_output(&host, out, sizeof out, now_ms())) > 0)
        host_sent(out, count);
}

static void step_on(long steps)
{
    while (steps-- > 0)
        step();
}

/* All moves, until each has ended; returns the bytes that they took. */
static long run(const Setup *of)
{
    begin(of);
    while (ended < moves && now_us < 400000ull * (unsigned long long)(moves + 100)) {
        while (requested < moves && requested - ended < GX_WINDOW_MAX)
            request_move();
        step();
    }
    CHECK_INT(ended, moves);
    printf("window %2d%s%s, flips %d: %.2f bytes a move down, %.2f up, %.2f ms; %ld finished, %ld of them wrong; %ld "
           "deviated, %ld lost or timed out, %ld others; %ld drifts\n",
           of->window, of->ascii ? ", ASCII" : "", of->echo ? ", echo" : "", of->flips, (double)down.sent / (double)moves,
           (double)up.sent / (double)moves, (double)now_us / 1000 / (double)moves, outcomes[GX_HOST_FINISHED],
           wrong_finished, outcomes[GX_HOST_DEVIATED], outcomes[GX_HOST_LOST] + outcomes[GX_HOST_TIMED_OUT],
           outcomes[GX_HOST_REFUSED] + outcomes[GX_HOST_FAILED] + outcomes[GX_HOST_DROPPED], drifts);
    return down.sent + up.sent;
}

static void nothing_drifts(void)
{
    static const int WINDOWS[] = {1, 4, 16};
    int i;
    for (i = 0; i < 3; ++i) {
        Setup flips = {0, 0, 1, 0, 0}, clean = {0, 0, 0, 0, 0}, without = {0, 0, 0, 255, 0};
        long bytes;
        flips.window = clean.window = without.window = WINDOWS[i];
        run(&flips);
        CHECK(wrong_finished * 1000 <= moves);
        CHECK(outcomes[GX_HOST_FINISHED] * 100 >= moves * 97);
        bytes = run(&clean);
        CHECK_INT(outcomes[GX_HOST_FINISHED], moves);
        CHECK_INT(wrong_finished + drifts, 0);
        CHECK(bytes * 100 <= run(&without) * 105);
    }
}

static void completions_need_no_waiting(void)
{
    Setup binary = {1, 0, 0, 0, 0}, ascii = {1, 1, 0, 0, 0};
    run(&binary);
    CHECK(now_us / 1000 <= 4ull * (unsigned long long)moves + 200);
    run(&ascii);
    CHECK(now_us / 1000 <= 5ull * (unsigned long long)moves + 200);
}

static void an_echo_is_driven(void)
{
    Setup clean = {0, 0, 0, 0, 1}, flips = {0, 0, 1, 0, 1}, ascii = {0, 1, 0, 0, 1};
    run(&clean);
    CHECK_INT(outcomes[GX_HOST_FINISHED], moves);
    CHECK_INT(wrong_finished, 0);
    run(&ascii);
    CHECK_INT(outcomes[GX_HOST_FINISHED], moves);
    CHECK_INT(wrong_finished, 0);
    /* It has no check: each flipped value may be wrong, but nothing drifts. */
    run(&flips);
    CHECK(wrong_finished * 500 <= moves);
    gx_host_control(&host, GX_CONTROL_HOLD);
    while (unanswered == 0 && now_us < 1000000000000ull)
        step();
    CHECK_INT(unanswered, 1);
}

static void hosts_hold_and_stop(void)
{
    static const Setup SETUP = {4, 0, 0, 0, 0};
    long before, i;
    begin(&SETUP);
    while (ended < moves) {
        while (requested < moves && requested - ended < GX_WINDOW_MAX)
            request_move();
        step();
        if (below(200) != 0)
            continue;
        before = holds;
        gx_host_control(&host, GX_CONTROL_HOLD);
        for (i = 0; holds == before && i < 1000; ++i)
            step();
        CHECK(holds == before + 1);
        step_on(100);
        before = ended;
        step_on((long)below(3000));
        CHECK_INT(ended, before); /* what was under way has come to its end */
        before = statuses;
        gx_host_control(&host, GX_CONTROL_RESUME);
        for (i = 0; statuses == before && i < 1000; ++i)
            step();
    }
    CHECK_INT(outcomes[GX_HOST_FINISHED], moves);
    CHECK_INT(wrong_finished, 0);

    /* In the middle of moves: told where, all moves end, and the next go from there. */
    begin(&SETUP);
    while (ended < moves - GX_WINDOW_MAX) {
        while (requested < moves && requested - ended < GX_WINDOW_MAX)
            request_move();
        step_on((long)below(4000));
        before = stops;
        gx_host_control(&host, GX_CONTROL_STOP);
        for (i = 0; stops == before && i < 4000; ++i)
            step();
        CHECK(stops == before + 1);
        CHECK_INT(gx_motion_unfinished(&motion), 0);
        CHECK(stopped_at.mask == 0x7F);
        while (ended < requested && i++ < 8000)
            step();
        CHECK_INT(ended, requested);
    }
    CHECK_INT(wrong_finished + outcomes[GX_HOST_DEVIATED] + outcomes[GX_HOST_TIMED_OUT], 0);
    CHECK(outcomes[GX_HOST_FAILED] + outcomes[GX_HOST_DROPPED] > 0);
    printf("%ld stops: %ld finished, %ld failed, %ld dropped, %ld lost\n", stops, outcomes[GX_HOST_FINISHED],
           outcomes[GX_HOST_FAILED], outcomes[GX_HOST_DROPPED], outcomes[GX_HOST_LOST]);
}

int main(int argc, char **argv)
{
    moves = argc > 1 ? strtol(argv[1], NULL, 10) : 4000;
    seed = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    requests = calloc((size_t)moves + 1, sizeof *requests);
    if (requests == NULL)
        return 2;
    nothing_drifts();
    completions_need_no_waiting();
    an_echo_is_driven();
    hosts_hold_and_stop();
    free(requests);
    return check_summary("gx_real_links");
}
