/* A machine on gx_motion.h at the far end of a line, and what became in it of each move that was requested. */
#ifndef GX_MACHINE_H
#define GX_MACHINE_H

#include "libdeltarobot/gx_motion.h"

#include "witness.h"

enum { REQUESTS = 60 };

typedef struct {
    int32_t target[GX_AXES];
    int axes, velocity;
    int accepted, fetched, started, done, stopped, number;
    int expected_velocity; /* -1: not known */
} Request;

static Request requests[REQUESTS];
static int requested;

/* Which request has which number, by the commands that the host sends. */
static struct {
    int request[GX_NUMBER_MAX + 1];
    unsigned first, count;
    int next;
} numbers;

static struct gx_motion motions[2], *motion = motions;
static struct gx_motion_settings motion_settings;
static int silenced; /* whether moves of an earlier session are carried out */

static struct {
    int32_t at[GX_AXES];
    struct gx_vector ahead[3]; /* fetched moves, the first of which is carried out */
    int requests[3], count;
    unsigned long ends;
    int velocity, last; /* in force; the last request accepted */
    int slow, faults;
} machine;

static void accepted(int number)
{
    int index = number < 0 ? -1 : numbers.request[number];
    Request *request;

    HOLDS(index >= 0, "a move that nobody requested");
    if (index < 0)
        return;
    request = &requests[index];
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
        Request *request = &requests[machine.requests[0]];
        HOLDS(!request->started, "a move was begun twice");
        request->started = 1;
    }
    machine.ends = now + (machine.slow && below(20) == 0 ? 1000 + below(4000) : below(8) == 0 ? 0 : below(60));
}

static void fetch_move(void)
{
    struct gx_vector move;
    int number, i, index = 0;
    Request *request = requests;

    if (gx_motion_next(motion, &move, &number) != GX_RC_SUCCESS)
        return;
    while (index < requested && (!request->accepted || !request->axes || request->fetched || request->stopped)) {
        ++index;
        ++request;
    }
    if (index == requested) {
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
            requests[machine.requests[0]].done = 1;
        CHECK_INT(gx_motion_done(motion), GX_RC_SUCCESS);
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
    CHECK_INT(gx_motion_set_position(motion, machine.at), GX_RC_SUCCESS);
}

/* What an end has to say now, the least that something fits in: few things at a time, which share a fate. */
static int least_output(int (*output)(void *out, int cap), unsigned char *out)
{
    static const int ROOM[] = {4, 8, 14, 32, GX_ENCODED_MAX};
    size_t i;
    int size = 0;
    for (i = 0; size == 0 && i < sizeof ROOM / sizeof *ROOM; ++i)
        size = output(out, ROOM[i]);
    return size;
}

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
        remember(&to_host, &item);
    }
    transmit(&up, bytes, size);
}

static int motion_receives(const unsigned char *bytes, int count)
{
    int taken = gx_motion_receive(motion, bytes, count, clock_ms());
    read_beside(&to_motion, bytes, taken);
    return taken;
}

static int motion_output(void *out, int cap)
{
    return gx_motion_output(motion, out, cap, clock_ms());
}

static void motion_does(void)
{
    struct gx_motion_event event;
    unsigned char out[GX_ENCODED_MAX];
    int size;

    while (gx_motion_poll(motion, clock_ms(), &event) == GX_RC_SUCCESS) {
        if (event.kind == GX_MOTION_QUEUED)
            accepted(event.number);
        else if (event.kind == GX_MOTION_BEGUN && gx_motion_unfinished(motion) > 0)
            silenced = 1;
    }
    machine_runs();
    while ((size = least_output(motion_output, out)) > 0)
        motion_sent(out, size);
}

static void init_motion(void)
{
    memset(motion, 0x5A, sizeof *motion);
    CHECK_INT(gx_motion_init(motion, &motion_settings), GX_RC_SUCCESS);
    machine.velocity = -1;
    gx_commands_init(&to_motion.commands); /* what it was receiving is gone too */
}

static void stop_machine(void)
{
    int i;
    for (i = 0; i < REQUESTS; ++i)
        if (requests[i].accepted && !requests[i].done)
            requests[i].stopped = 1;
    machine.count = 0;
    ++machine.faults;
}

#endif
