/*
 * controller: plays the robot's controller, with simulated actuators. Its line is standard input and output; it ends
 * when the other end hangs up.
 *
 * It answers as the shipped firmware does: each request is acknowledged or refused, then a status report follows;
 * another one for each encoder step of a move, and one when an operation ends. So like the firmware it never sends
 * HOMING_REPLY and MOVE_REPLY, which the specification has for the latter.
 */
#include "libdeltarobot/protocol_ext.h"
#include "line.h"
#include "robot.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define LOOP_MS 5
/* Displacement of the fastest arm in one loop, and between two steps of the encoders. */
#define TRAVEL 0.25f
#define ENCODER_STEP 2.5f
/* Where the rails end. */
#define FARTHEST 1000.0f

struct controller {
    struct line line;
    struct protocol_data ring;
    struct status status;
    float from[ARMS], to[ARMS]; /* the move */
    int loops, loop;            /* how many loops it takes, and how many it took */
};

/* One message a loop: the line is slower than the loop, so no queue of answers is needed. */
static void send(struct controller *it, struct protocol_msg *msg)
{
    if (dp_send(msg, line_write, &it->line) != 0)
        perror("controller: can't write");
}

static void report(struct controller *it)
{
    struct protocol_msg msg;
    robot_status(&msg, &it->status);
    send(it, &msg);
}

static void answer(struct controller *it, const struct protocol_msg *request, int accepted)
{
    struct protocol_msg msg;
    robot_answer(&msg, accepted ? DP_OPCODE_ACK : DP_OPCODE_NACK, request->opcode);
    send(it, &msg);
}

static void begin_move(struct controller *it)
{
    float longest = 0;
    int arm;

    memcpy(it->from, it->status.at, sizeof it->from);
    for (arm = 0; arm < ARMS; ++arm) {
        float distance = robot_distance(it->from[arm], it->to[arm]);
        if (distance > longest)
            longest = distance;
    }
    it->loops = (int)(longest / TRAVEL) + 1;
    it->loop = 0;
    it->status.state = DP_STATUS_MOVING;
}

static void request_homing(struct controller *it, const struct protocol_msg *msg)
{
    int accepted = it->status.state != DP_STATUS_ERROR;
    if (accepted) {
        it->status.state = DP_STATUS_HOMING;
        it->status.known = 0;
    }
    answer(it, msg, accepted);
    report(it);
}

static void request_move(struct controller *it, const struct protocol_msg *msg)
{
    float to[ARMS];
    int arm, accepted;

    if (!it->status.known) {
        answer(it, msg, 0);
        return;
    }
    accepted = it->status.state != DP_STATUS_ERROR && robot_read_move(msg, to) == 0;
    if (accepted) {
        for (arm = 0; arm < ARMS; ++arm)
            it->to[arm] = to[arm] > FARTHEST ? FARTHEST : to[arm] < -FARTHEST ? -FARTHEST : to[arm];
        begin_move(it);
    }
    answer(it, msg, accepted);
    report(it);
}

static void request_cancel(struct controller *it, const struct protocol_msg *msg)
{
    int accepted = it->status.state != DP_STATUS_ERROR;
    if (accepted)
        it->status.state = DP_STATUS_IDLE;
    answer(it, msg, accepted);
    report(it);
}

static void handle(struct controller *it, const struct protocol_msg *msg)
{
    switch (msg->opcode) {
    case DP_OPCODE_HOMING: request_homing(it, msg); break;
    case DP_OPCODE_MOVE:   request_move(it, msg); break;
    case DP_OPCODE_CANCEL: request_cancel(it, msg); break;
    case DP_OPCODE_STATUS: report(it); break;
    default:               break; /* what only a controller sends */
    }
}

/* The end stops are where the displacement is 0. Returns whether an arm was to go farther than that. */
static int feel_stops(struct status *status)
{
    int arm, blocked = 0;

    status->stops = 0;
    for (arm = 0; arm < ARMS; ++arm) {
        blocked |= status->at[arm] < -ROBOT_TOLERANCE;
        if (status->at[arm] <= 0) {
            status->at[arm] = 0;
            status->stops |= 1 << arm;
        }
    }
    return blocked;
}

static void home(struct controller *it)
{
    int arm;

    for (arm = 0; arm < ARMS; ++arm)
        it->status.at[arm] -= TRAVEL;
    feel_stops(&it->status);
    if (it->status.stops == (1 << ARMS) - 1) {
        it->status.known = 1;
        it->status.state = DP_STATUS_IDLE;
        report(it);
    }
}

/* What an encoder counts. */
static int steps(float at)
{
    return (int)(at / ENCODER_STEP);
}

static void move(struct controller *it)
{
    float part = (float)++it->loop / (float)it->loops;
    int arm, stepped = 0, arrived = 1;

    for (arm = 0; arm < ARMS; ++arm) {
        float before = it->status.at[arm];
        float now = it->from[arm] + (it->to[arm] - it->from[arm]) * part;
        it->status.at[arm] = now;
        stepped |= steps(now) != steps(before);
        arrived &= robot_distance(now, it->to[arm]) < ROBOT_TOLERANCE;
    }
    if (feel_stops(&it->status))
        it->status.state = DP_STATUS_ERROR;
    else if (arrived)
        it->status.state = DP_STATUS_IDLE;
    if (stepped || it->status.state != DP_STATUS_MOVING)
        report(it);
}

static void actuate(struct controller *it)
{
    if (it->status.state == DP_STATUS_HOMING)
        home(it);
    else if (it->status.state == DP_STATUS_MOVING)
        move(it);
}

int main(void)
{
    static struct controller it;
    static const float somewhere[ARMS] = {15, 20, 25};
    struct protocol_msg msg;
    unsigned long heard = line_now(), next = line_now();
    int bytes, quiet;

    it.line.in = STDIN_FILENO;
    it.line.out = STDOUT_FILENO;
    memcpy(it.status.at, somewhere, sizeof somewhere);
    dp_init(&it.ring);
    for (;;) {
        long left = (long)(next - line_now());
        bytes = line_receive(&it.line, &it.ring, left > 0 ? (int)left : 0);
        if (bytes < 0)
            return 0;
        if (bytes > 0)
            heard = line_now();
        /* Noise may look like the beginning of a long frame: a quiet line tells that it is none. */
        quiet = line_now() - heard > LINE_QUIET_MS;
        if ((quiet ? dp_recv_idle(&it.ring, &msg) : dp_recv(&it.ring, &msg)) == DP_RC_SUCCESS)
            handle(&it, &msg);
        if ((long)(line_now() - next) >= 0) {
            next = line_now() + LOOP_MS;
            actuate(&it);
        }
    }
}
