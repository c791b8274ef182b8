/*
 * motion [AXES]: a machine of 3 to 6 axes (by default 4) behind a serial line, whose other end is this program's
 * standard input and output. Firmware looks like this too, but for the part at the end.
 *
 * It moves all axes of a vector in step, at the velocity along the vector. The first axis has an end stop at either
 * side, where the machine stops. It ends, with status 0, when nobody has the line open any more.
 */
#define _XOPEN_SOURCE 700
#include "libdeltarobot/gx_motion.h"

#include <poll.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define END_STOP 20000       /* of the first axis, at either side, in steps */
#define END_STOP_HIT 64      /* what hosts are told then: one of the firmware's own codes */
#define SLOWEST 100          /* steps per second, also when no velocity was ever told */

static unsigned long now_ms(void);

struct machine {
    struct gx_motion link;
    int32_t at[GX_AXES];
    /* The move being carried out. */
    int moving, held;
    int32_t from[GX_AXES], to[GX_AXES];
    unsigned long began, lasts, ran; /* milliseconds; when it was looked at last */
};

/* The square root, rounded down: Newton's way. */
static unsigned long root(double square)
{
    double guess = square > 1 ? square : 1;
    int i;
    for (i = 0; i < 60; ++i)
        guess = (guess + square / guess) / 2;
    return (unsigned long)guess;
}

static void start_move(struct machine *machine, const struct gx_vector *move)
{
    double square = 0;
    unsigned long velocity = move->velocity > SLOWEST ? move->velocity : SLOWEST;
    int i;

    for (i = 0; i < GX_AXES; ++i) {
        double distance;
        machine->from[i] = machine->at[i];
        machine->to[i] = move->mask >> i & 1 ? move->axes[i] : machine->at[i];
        distance = (double)machine->to[i] - machine->from[i];
        square += distance * distance;
    }
    machine->began = now_ms();
    machine->lasts = (unsigned long)((double)root(square) * 1000 / (double)velocity);
    machine->moving = 1;
}

static void run_machine(struct machine *machine)
{
    struct gx_vector move;
    unsigned long elapsed;
    int i;

    if (machine->held)
        machine->began += now_ms() - machine->ran;
    machine->ran = now_ms();
    if (!machine->moving && gx_motion_next(&machine->link, &move, NULL) == GX_RC_SUCCESS)
        start_move(machine, &move);
    if (!machine->moving || machine->held)
        return;
    elapsed = now_ms() - machine->began;
    if (elapsed > machine->lasts)
        elapsed = machine->lasts;
    for (i = 0; i < GX_AXES; ++i) {
        double distance = (double)machine->to[i] - machine->from[i];
        machine->at[i] = elapsed < machine->lasts
                             ? machine->from[i] + (int32_t)(distance * (double)elapsed / (double)machine->lasts)
                             : machine->to[i];
    }
    if (machine->at[0] > END_STOP || machine->at[0] < -END_STOP) {
        machine->at[0] = machine->at[0] > 0 ? END_STOP : -END_STOP;
        machine->moving = 0;
        gx_motion_stop(&machine->link, END_STOP_HIT);
    } else if (elapsed == machine->lasts) {
        machine->moving = 0;
        gx_motion_done(&machine->link);
    }
    gx_motion_set_position(&machine->link, machine->at);
}

/* What a host asks for past the queue. This machine stands at once. */
static void handle(struct machine *machine, const struct gx_motion_event *event)
{
    if (event->kind == GX_MOTION_HOLD || event->kind == GX_MOTION_RESUME)
        machine->held = event->kind == GX_MOTION_HOLD;
    if (event->kind == GX_MOTION_STOP) {
        machine->moving = machine->held = 0;
        gx_motion_stop(&machine->link, 0);
    }
}

static void start(struct machine *machine, int axes)
{
    struct gx_motion_settings settings = {0, 0, 0, 0};
    settings.axes = (1 << axes) - 1;
    gx_motion_init(&machine->link, &settings);
    gx_motion_set_position(&machine->link, machine->at);
}

/* What a microcontroller does otherwise. */

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000;
}

/* Waits a millisecond for bytes: whether there are any, or -1 if nobody has the line open. */
static int wait_for_bytes(void)
{
    struct pollfd line = {STDIN_FILENO, POLLIN, 0};
    if (poll(&line, 1, 1) > 0 && (line.revents & POLLIN) == 0)
        return -1;
    return (line.revents & POLLIN) != 0;
}

static void send_all(const char *bytes, int count)
{
    while (count > 0) {
        ssize_t sent = write(STDOUT_FILENO, bytes, (size_t)count);
        if (sent <= 0)
            return;
        bytes += sent;
        count -= (int)sent;
    }
}

int main(int argc, char **argv)
{
    static struct machine machine;
    int axes = argc > 1 ? atoi(argv[1]) : 4;
    char in[64], out[GX_ENCODED_MAX];
    int got = 0, taken = 0, waited;

    if (axes < 3 || axes > GX_AXES)
        return 2;
    start(&machine, axes);
    while ((waited = wait_for_bytes()) < 0)
        poll(NULL, 0, 1); /* nobody yet */
    do {
        struct gx_motion_event event;
        if (taken == got && waited > 0) {
            got = (int)read(STDIN_FILENO, in, sizeof in);
            taken = 0;
            if (got <= 0)
                break;
        }
        taken += gx_motion_receive(&machine.link, in + taken, got - taken, now_ms());
        while (gx_motion_poll(&machine.link, now_ms(), &event) == GX_RC_SUCCESS)
            handle(&machine, &event);
        run_machine(&machine);
        send_all(out, gx_motion_output(&machine.link, out, sizeof out, now_ms()));
    } while ((waited = wait_for_bytes()) >= 0);
    return 0;
}
