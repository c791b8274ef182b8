/*
 * host DEVICE: a host program that draws with the machine of motion.c: a circle of short moves, long ones, and then
 * what can go wrong. Prints each command and notice in words, and checks that everything ends as it should. Exit status
 * 0 if it did, 1 if not, 2 when there is no line.
 */
#define _XOPEN_SOURCE 700
#include "libdeltarobot/gx_host.h"
#include "libdeltarobot/serial.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { SEGMENTS = 32, RADIUS = 300, X = 1, Y = 2, Z = 4, A = 8, B = 16 };

static struct gx_host session;
static struct dp_serial port;
static struct gx_commands sent; /* for printing */
static struct gx_notices heard;
static unsigned long began, sent_bytes, circle_bytes;
static int expected, failed, gone, loses; /* the next write */

/* What the machine has told. */
static struct {
    int ended[GX_HOST_DEVIATED + 1];
    int last_outcome, last_code;
    int reports, errors, held, stops;
    int32_t at[GX_AXES];
} seen;

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000 - began;
}

/* --- in words --- */

static const char *reason(int code)
{
    switch (code) {
    case GX_FAULT_UNKNOWN: return "not a command";
    case GX_FAULT_NUMBER: return "no number";
    case GX_FAULT_INTERRUPTED: return "incomplete";
    case GX_FAULT_SYNTAX: return "a byte that has no place there";
    case GX_FAULT_EMPTY: return "names no axis";
    case GX_FAULT_REPEATED: return "names an axis twice";
    case GX_FAULT_RANGE: return "out of range";
    case GX_FAULT_LIMIT: return "leads nowhere";
    case GX_FAULT_BUSY: return "no room";
    case GX_FAULT_ORDER: return "not the next number";
    case GX_FAULT_CLOSED: return "no session";
    case GX_FAULT_NUMBERLESS: return "needs a number";
    case GX_FAULT_AXIS: return "no such axis";
    case GX_FAULT_STOPPED: return "the machine has stopped";
    case GX_FAULT_OWN: return "an end stop was hit";
    default: return "an unknown reason";
    }
}

static void print_vector(const struct gx_vector *vector, const char *format)
{
    int i;
    for (i = 0; i < GX_AXES; ++i)
        if (vector->mask >> i & 1)
            printf(format, "xyzabc"[i], (long)vector->axes[i]);
    if (vector->mask & GX_MASK_VELOCITY)
        printf(" at %u steps/s", (unsigned)vector->velocity);
}

static void print(const char *arrow, const struct gx_item *item)
{
    printf("%6.3f %s ", (double)now_ms() / 1000, arrow);
    if (item->number.format)
        printf("#%u: ", (unsigned)item->number.value);
    switch (item->kind) {
    case GX_MOVE:
        printf("go to");
        print_vector(&item->vector, " %c=%ld");
        break;
    case GX_STEP:
        printf("go on by");
        print_vector(&item->vector, " %c%+ld");
        break;
    case GX_REPORTING:
        printf(item->period ? "report the position each %u ms" : "report no positions", (unsigned)item->period);
        break;
    case GX_COMPLETED:
    case GX_CONFIRMED:
        printf("done");
        break;
    case GX_CONTROL:
        printf("%s", item->code == GX_CONTROL_HOLD ? "hold" : item->code == GX_CONTROL_RESUME ? "resume" : "stop");
        break;
    case GX_STATUS:
        printf("%s, room for %u moves", item->code ? "holding" : "ready", (unsigned)item->period);
        break;
    case GX_REFUSED:
        printf("refused: %s", reason(item->code));
        break;
    case GX_POSITION:
        printf("at");
        print_vector(&item->vector, " %c=%ld");
        break;
    default:
        printf("malformed: %s", reason(item->code));
    }
    printf("\n");
}

/* --- the line --- */

static int transmit(const char *bytes, int count)
{
    struct gx_item item;
    int taken = 0;

    while (taken < count) {
        taken += gx_commands_receive(&sent, bytes + taken, count - taken, &item);
        if (item.kind != GX_NONE)
            print(loses ? "-x" : "->", &item);
    }
    if (loses) {
        loses = 0;
        return 0;
    }
    sent_bytes += (unsigned long)count;
    return dp_serial_write(&port, bytes, count, 1000) == count ? 0 : -1;
}

static void print_heard(const char *bytes, int count)
{
    struct gx_item item;
    int taken = 0;

    while (taken < count) {
        taken += gx_notices_receive(&heard, bytes + taken, count - taken, &item);
        if (item.kind != GX_NONE)
            print("<-", &item);
    }
    if (count == 0) {
        gx_notices_idle(&heard, &item);
        if (item.kind != GX_NONE)
            print("<-", &item);
    }
}

static void handle(const struct gx_host_event *event)
{
    switch (event->kind) {
    case GX_HOST_ENDED:
        ++seen.ended[event->outcome];
        seen.last_outcome = event->outcome;
        seen.last_code = event->code;
        break;
    case GX_HOST_REPORT:
        ++seen.reports;
        memcpy(seen.at, event->position.axes, sizeof seen.at);
        break;
    case GX_HOST_ERROR:
        ++seen.errors;
        break;
    case GX_HOST_STATUS:
        seen.held = event->code;
        break;
    case GX_HOST_STOPPED:
        ++seen.stops;
        memcpy(seen.at, event->position.axes, sizeof seen.at);
        break;
    default:
        break;
    }
}

/* Runs the session until fewer than so many moves are unfinished, or for so long. */
static void run(int unfinished, long for_ms)
{
    static char in[64];
    static int got, taken;
    unsigned long start = now_ms();
    char out[128];
    int count;

    while (!gone) {
        struct gx_host_event event;
        long wait, left = for_ms - (long)(now_ms() - start);

        while (gx_host_poll(&session, now_ms(), &event) == GX_RC_SUCCESS)
            handle(&event);
        while ((count = gx_host_output(&session, out, sizeof out, now_ms())) > 0)
            gone |= transmit(out, count) != 0;
        if (gx_host_unfinished(&session) < unfinished || left <= 0)
            return;
        if (taken == got) {
            wait = gx_host_next_deadline(&session, now_ms());
            taken = 0;
            got = dp_serial_read(&port, in, sizeof in, wait < 0 || wait > left ? left : wait);
            if (got < 0) {
                gone = 1;
                return;
            }
            print_heard(in, got);
        }
        taken += gx_host_receive(&session, in + taken, got - taken, now_ms());
    }
}

static void expect(int ok, const char *what)
{
    ++expected;
    if (!ok) {
        ++failed;
        printf("%6.3f !! expected %s\n", (double)now_ms() / 1000, what);
    }
}

static void title(const char *text)
{
    printf("\n%s\n", text);
}

/* --- what is drawn --- */

static void go(long x, long y, long z, int axes, int velocity)
{
    int32_t target[GX_AXES] = {0, 0, 0, 0, 0, 0};
    target[0] = (int32_t)x;
    target[1] = (int32_t)y;
    target[2] = (int32_t)z;
    /* As many as there is room for: then some have to end first. */
    while (!gone && gx_host_move(&session, target, axes, velocity) == GX_RC_BUSY)
        run(GX_WINDOW_MAX, 5000);
}

/* Until all moves have ended. */
static void finish(void)
{
    run(1, 5000);
    expect(gx_host_unfinished(&session) == 0, "all moves to end");
}

static int is_at(long x, long y, long z)
{
    return seen.at[0] == x && seen.at[1] == y && seen.at[2] == z;
}

/* The sine of a turn's 32nd parts, times 10000. */
static long sine(int part)
{
    static const long QUARTER[] = {0, 1951, 3827, 5556, 7071, 8315, 9239, 9808, 10000};
    part &= 31;
    if (part >= 16)
        return -sine(part - 16);
    return QUARTER[part <= 8 ? part : 16 - part];
}

static void draw_circle(void)
{
    unsigned long before;
    int i;

    title("A circle: to its first point by a long move, then on by short ones.");
    go(RADIUS, 0, 0, X | Y | Z, 4000);
    finish();
    before = sent_bytes;
    for (i = 1; i <= SEGMENTS; ++i)
        go(RADIUS * sine(i + 8) / 10000, RADIUS * sine(i) / 10000, 0, X | Y, -1);
    finish();
    circle_bytes = sent_bytes - before;
    expect(seen.ended[GX_HOST_FINISHED] == SEGMENTS + 1, "all moves of the circle to be finished");
    expect(circle_bytes <= 7ul * SEGMENTS + 20, "short moves, 7 bytes with their numbers");
}

static void draw(void)
{
    static const char HALF[] = "#\x80\x81!\x83\xE8\x87";
    struct gx_host_health before, after;
    int finished;

    draw_circle();

    title("Long moves, with position reports.");
    gx_host_report(&session, 100);
    go(2000, 0, 500, X | Y | Z, 8000);
    go(0, 0, 0, X | Y | Z, -1);
    finish();
    expect(seen.reports >= 4, "position reports on the way");
    run(0, 250);
    expect(is_at(0, 0, 0), "the machine at its origin");
    gx_host_report(&session, 0);
    run(0, 50);

    title("A command that is cut off by the next: an error notice, and no harm.");
    finished = seen.ended[GX_HOST_FINISHED];
    go(100, 0, 0, X, -1);
    expect(transmit(HALF, sizeof HALF - 1) == 0, "half a command on the line");
    go(100, 100, 0, Y, -1);
    finish();
    expect(seen.errors == 1, "one error notice");
    expect(seen.ended[GX_HOST_FINISHED] == finished + 2, "both moves to be finished");

    title("A command that the line loses: those behind it are out of order, and all are sent again, in long form.");
    finished = seen.ended[GX_HOST_FINISHED];
    gx_host_get_health(&session, &before);
    loses = 1;
    go(110, 100, 0, X, -1);
    run(2, 1000);
    go(120, 110, 0, X | Y, -1);
    go(130, 110, 0, X, -1);
    finish();
    expect(seen.ended[GX_HOST_FINISHED] == finished + 3, "all three moves to be finished");
    gx_host_get_health(&session, &after);
    expect(after.repeats == before.repeats + 3, "three moves to be sent again");

    title("An axis that the machine does not have: refused, and so is what comes behind it.");
    go(100, 200, 0, Y, -1);
    go(0, 0, 0, B, -1);
    go(100, 300, 0, Y, -1);
    finish();
    expect(seen.ended[GX_HOST_REFUSED] == 1 && seen.ended[GX_HOST_DROPPED] == 1, "one move refused, one dropped");
    expect(seen.last_code == GX_FAULT_AXIS, "the axis as the reason");

    title("Into the end stop: the machine stops, and drops what it has queued.");
    go(21000, 0, 0, X, 16383);
    go(0, 0, 0, X, -1);
    finish();
    expect(seen.ended[GX_HOST_FAILED] == 1 && seen.ended[GX_HOST_DROPPED] == 2, "one move failed, one more dropped");
    expect(seen.last_code == GX_FAULT_OWN, "the end stop as the reason");

    title("Back: a new session begins, and with it a report of where the machine is.");
    gx_host_report(&session, 200);
    go(15000, 0, 0, X, 16383);
    finish();
    run(0, 300);
    expect(is_at(15000, 200, 0), "the machine where it was sent");
    expect(seen.last_outcome == GX_HOST_FINISHED, "the last move to be finished");

    title("Hold, in the middle of a move, and go on.");
    finished = seen.ended[GX_HOST_FINISHED];
    go(5000, 0, 0, X, 5000);
    run(0, 200);
    gx_host_control(&session, GX_CONTROL_HOLD);
    run(0, 700);
    expect(seen.held && seen.ended[GX_HOST_FINISHED] == finished, "the machine to hold");
    gx_host_control(&session, GX_CONTROL_RESUME);
    finish();
    expect(seen.ended[GX_HOST_FINISHED] == finished + 1, "the move to be finished");

    title("Stop, and forget the rest.");
    go(15000, 0, 0, X, 5000);
    go(0, 0, 0, X, -1);
    run(0, 200);
    gx_host_control(&session, GX_CONTROL_STOP);
    finish();
    run(0, 100);
    expect(seen.stops == 1 && seen.at[0] > 5000 && seen.at[0] < 15000, "the machine to stop on its way, and say where");
    expect(seen.last_outcome == GX_HOST_DROPPED, "the last move to be dropped");
}

int main(int argc, char **argv)
{
    struct gx_host_health health;
    struct gx_host_settings settings;

    if (argc != 2) {
        fprintf(stderr, "usage: host DEVICE\n");
        return 2;
    }
    if (dp_serial_open(&port, argv[1], DP_SERIAL_BAUD) != DP_RC_SUCCESS) {
        fprintf(stderr, "host: %s\n", dp_serial_error(&port));
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, 0);
    memset(&settings, 0, sizeof settings);
    settings.gap_ms = 10;
    gx_host_init(&session, &settings);
    began = now_ms();
    draw();
    expect(!gone, "the line to stay open");
    gx_host_get_health(&session, &health);
    printf("\n%lu moves in %lu sessions, %lu sent again, %lu error notices, %lu reports, in %.1f s; %.1f bytes for a "
           "segment of the circle with its number; %d expectations, %d not met: %s\n",
           health.moves, health.sessions, health.repeats, health.errors, health.reports, (double)now_ms() / 1000,
           (double)circle_bytes / SEGMENTS, expected, failed, failed ? "FAILED" : "all as expected");
    dp_serial_close(&port);
    return failed ? 1 : 0;
}
