/*
 * gx_host.h and gx_motion.h, given what nobody should give: arguments out of range, and memory that holds anything at
 * all while bytes of the alphabet come in. No call goes wrong or goes on for ever.
 */
#include "libdeltarobot/gx_host.h"
#include "libdeltarobot/gx_motion.h"

#include "check.h"
#include "receiver.h"
#include "wire.h"

#include <limits.h>

enum { ROUNDS = 3000, STEPS = 20 };

static struct gx_host host;
static struct gx_motion motion;
static unsigned long seed = 99, now;
static unsigned char bytes[64], out[128];

static int some_bytes(const char *alphabet, int letters)
{
    int count = (int)(wire_random(&seed) % sizeof bytes), i;
    for (i = 0; i < count; ++i)
        bytes[i] = (unsigned char)alphabet[wire_random(&seed) % (unsigned)letters];
    return count;
}

static int some_room(void)
{
    return (int)(wire_random(&seed) % sizeof out);
}

/* Whatever its memory held, a receiver returns no value that its header does not have. */
static void in_range(const struct gx_item *item)
{
    int axis;
    if (item->kind == GX_NONE)
        return;
    CHECK(item->kind > GX_NONE && item->kind <= GX_STATUS);
    CHECK(item->format == GX_BINARY || item->format == GX_ASCII);
    CHECK(item->number.value <= GX_NUMBER_MAX && item->number.format <= GX_ASCII);
    CHECK(item->code <= 127 && item->period <= GX_PERIOD_MAX);
    CHECK(item->vector.velocity <= GX_VELOCITY_MAX && item->vector.mask <= 127);
    for (axis = 0; axis < GX_AXES; ++axis)
        CHECK(item->vector.axes[axis] >= GX_POSITION_MIN && item->vector.axes[axis] <= GX_POSITION_MAX);
}

/* Each byte of a receiver is every value in turn, among zeros and among ones. */
static void receivers_in_any_memory(void)
{
    static const char ENDS[][9] = {"\n", "a", "0\n", "?", "\x81", "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", ""};
    struct receiver receiver;
    struct gx_item item;
    size_t at, end;
    int others, value, host, taken, count, calls;

    for (others = 0; others <= 255; others += 255)
        for (at = 0; at < sizeof receiver.of; ++at)
            for (value = 0; value <= 255; ++value)
                for (end = 0; end < sizeof ENDS / sizeof *ENDS; ++end)
                    for (host = 0; host <= 1; ++host) {
                        memset(&receiver.of, others, sizeof receiver.of);
                        ((unsigned char *)&receiver.of)[at] = (unsigned char)value;
                        receiver.host = host;
                        count = (int)strlen(ENDS[end]);
                        for (taken = calls = 0; taken < count && calls < 20; ++calls) {
                            taken += receive(&receiver, ENDS[end] + taken, count - taken, &item);
                            in_range(&item);
                        }
                        CHECK_INT(taken, count);
                        idle(&receiver, &item);
                        in_range(&item);
                    }
}

static void arguments_of_the_host(void)
{
    struct gx_host_event event;
    struct gx_host_health health;
    int32_t target[GX_AXES] = {GX_POSITION_MAX, GX_POSITION_MIN, 0, 0, 0, GX_POSITION_MAX + 1};
    int i;

    CHECK_INT(gx_host_init(NULL, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_init(&host, NULL), GX_RC_SUCCESS);
    CHECK_INT(gx_host_move(NULL, target, 1, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, NULL, 1, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 0, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 0x20, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 0x40, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, -1, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, INT_MAX, 1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 1, -2), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 1, GX_VELOCITY_MAX + 1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_move(&host, target, 1, INT_MAX), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_unfinished(&host), 0);
    for (i = 0; i < GX_WINDOW_MAX; ++i)
        CHECK_INT(gx_host_move(&host, target, 0x1F, GX_VELOCITY_MAX), GX_RC_SUCCESS);
    CHECK_INT(gx_host_move(&host, target, 0x1F, -1), GX_RC_BUSY);
    CHECK_INT(gx_host_report(NULL, 1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_report(&host, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_report(&host, GX_PERIOD_MAX + 1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_receive(NULL, bytes, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_receive(&host, NULL, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_receive(&host, bytes, -1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_receive(&host, NULL, 0, 0), 0);
    CHECK_INT(gx_host_poll(NULL, 0, &event), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_poll(&host, 0, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_output(NULL, out, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_output(&host, NULL, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_output(&host, out, INT_MIN, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_output(&host, NULL, 0, 0), 0);
    CHECK_INT(gx_host_next_deadline(NULL, 0), -1);
    CHECK_INT(gx_host_unfinished(NULL), 0);
    CHECK_INT(gx_host_get_health(NULL, &health), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_get_health(&host, NULL), GX_RC_ERROR_GENERIC);
}

static void a_host_in_any_memory(void)
{
    static const char ALPHABET[] = "\x81\x83\x80\xFF\xAA\xD5\xD6###?!=&%0123 xyzc\n\r-+";
    static const int32_t TARGET[GX_AXES] = {GX_POSITION_MAX, GX_POSITION_MIN, 0, 0, 0, GX_POSITION_MAX + 1};
    struct gx_host_event event;
    int round, step, count, done, events;

    for (round = 0; round < ROUNDS; ++round) {
        if (round % 3) /* or with what the one before has left */
            wire_any_memory(&seed, &host, sizeof host);
        for (step = 0; step < STEPS; ++step) {
            count = some_bytes(ALPHABET, sizeof ALPHABET - 1);
            done = gx_host_receive(&host, bytes, count, now);
            CHECK(done >= 0 && done <= count);
            for (events = 0; events < 600 && gx_host_poll(&host, now, &event) == GX_RC_SUCCESS; ++events)
                continue;
            CHECK(events < 600);
            gx_host_move(&host, TARGET, 1 + step % 31, step % 4 ? -1 : step);
            if (step % 7 == 0)
                gx_host_report(&host, step);
            if (step % 6 == 0)
                gx_host_control(&host, step / 6);
            count = some_room();
            done = gx_host_output(&host, out, count, now);
            CHECK(done >= 0 && done <= count);
            CHECK(gx_host_next_deadline(&host, now) >= -1);
            now += wire_random(&seed) % 2000;
        }
    }
}

static void arguments_of_the_motion_side(void)
{
    struct gx_motion_event event;
    struct gx_motion_health health;
    struct gx_vector move = {0, 0, {0}};
    int number;

    CHECK_INT(gx_motion_init(NULL, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_init(&motion, NULL), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_receive(NULL, bytes, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_receive(&motion, NULL, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_receive(&motion, bytes, -1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_receive(&motion, bytes, INT_MIN, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_receive(&motion, NULL, 0, 0), 0);
    CHECK_INT(gx_motion_poll(NULL, 0, &event), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_poll(&motion, 0, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_next(NULL, &move, &number), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_next(&motion, NULL, &number), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_done(NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_stop(NULL, 0), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_set_position(NULL, move.axes), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_set_position(&motion, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_output(NULL, out, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_output(&motion, NULL, 1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_output(&motion, out, -1, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_output(&motion, NULL, 0, 0), 0);
    CHECK_INT(gx_motion_next_deadline(NULL, 0), -1);
    CHECK_INT(gx_motion_unfinished(NULL), 0);
    CHECK_INT(gx_motion_get_health(NULL, &health), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_get_health(&motion, NULL), GX_RC_ERROR_GENERIC);
}

static void a_motion_side_in_any_memory(void)
{
    static const char ALPHABET[] = "\x1B\x81\x83\x80\xFF\xC1#!*~%R01258V xyzc\n\r?=-+";
    struct gx_motion_event event;
    struct gx_vector move = {0, 0, {0}};
    int round, step, count, done, events, number;

    for (round = 0; round < ROUNDS; ++round) {
        if (round % 3) /* or with what the one before has left */
            wire_any_memory(&seed, &motion, sizeof motion);
        for (step = 0; step < STEPS; ++step) {
            count = some_bytes(ALPHABET, sizeof ALPHABET - 1);
            done = gx_motion_receive(&motion, bytes, count, now);
            CHECK(done >= 0 && done <= count);
            for (events = 0; events < 64 && gx_motion_poll(&motion, now, &event) == GX_RC_SUCCESS; ++events)
                continue;
            CHECK(events < 64);
            if (step % 3 == 0 && gx_motion_next(&motion, &move, &number) == GX_RC_SUCCESS)
                gx_motion_done(&motion);
            if (step % 9 == 8)
                gx_motion_stop(&motion, 0);
            if (step % 7 == 0)
                gx_motion_set_position(&motion, move.axes);
            count = some_room();
            done = gx_motion_output(&motion, out, count, now);
            CHECK(done >= 0 && done <= count);
            CHECK(gx_motion_next_deadline(&motion, now) >= -1);
            now += wire_random(&seed) % 2000;
        }
    }
}

int main(void)
{
    receivers_in_any_memory();
    arguments_of_the_host();
    a_host_in_any_memory();
    arguments_of_the_motion_side();
    a_motion_side_in_any_memory();
    return check_summary("gx_hostile");
}
