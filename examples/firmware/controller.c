/*
 * Requests are answered by hand here, as in firmware that was written for the original and is only linked anew.
 * <libdeltarobot/controller.h> does the same and more (repeated requests, the end of an operation told once): it calls
 * functions for the motors, and takes 2.3 KB of flash on a Cortex-M4 where dp_process, dp_recv and dp_send take 0.5.
 */
#include "controller.h"

#include <string.h>

#if DP_DATA_MAX_SIZE < 16
#error "a status report has 16 bytes: build the library with DP_DATA_MAX_SIZE=16 or more"
#endif

/* The arms of the simulation. */
#define UNITS_PER_MS 0.25f
#define PARKED_AT 10.0f /* where they stand at the start */
#define RANGE_END 100.0f /* an arm that is sent beyond either end runs into its stop: an error */
#define ENCODER_STEP 2.5f
#define TOLERANCE 0.126f

/* Shipped firmware marks a position it does not know with this signalling NaN: bits to copy, not to compute with. */
static const uint32_t unknown_position = 0x7F800001u;

static void send(struct controller *controller, unsigned char opcode, const void *data, int bytes)
{
    struct protocol_msg msg;

    msg.opcode = opcode;
    msg.data_s = bytes;
    if (bytes > 0)
        memcpy(msg.data, data, (size_t)bytes);
    dp_send(&msg, controller->send, controller->usr);
}

/* The layout of shipped firmware: floats first and STAT padded to 16 bytes, here with zeros. */
static void report(struct controller *controller)
{
    unsigned char data[16];
    int stat = controller->status;
    unsigned int i;

    memset(data, 0, sizeof data);
    for (i = 0; i < 3; ++i) {
        const struct arm *arm = &controller->arms[i];
        const void *field = controller->known ? (const void *)&arm->position : (const void *)&unknown_position;

        memcpy(data + 4 * i, field, 4);
        if (arm->stop)
            stat |= DP_BIT_STAT_STOP_A_BIT << i; /* B and C are the next bits */
    }
    data[12] = (unsigned char)stat;
    send(controller, DP_OPCODE_STATUS_REPL, data, (int)sizeof data);
}

static void answer(struct controller *controller, unsigned char opcode, int accepted)
{
    send(controller, accepted ? DP_OPCODE_ACK : DP_OPCODE_NACK, &opcode, 1);
}

static int read_targets(const struct protocol_msg *msg, float targets[3])
{
    if (msg->data_s != 12)
        return 0;
    memcpy(targets, msg->data, 12);
    /* Only a NaN differs from itself. */
    return targets[0] == targets[0] && targets[1] == targets[1] && targets[2] == targets[2];
}

void controller_init(struct controller *controller, unsigned int now_ms, send_func_t sendfunc, void *usr)
{
    int i;

    memset(controller, 0, sizeof *controller);
    for (i = 0; i < 3; ++i)
        controller->arms[i].position = PARKED_AT;
    controller->moved_ms = now_ms;
    controller->send = sendfunc;
    controller->usr = usr;
}

void controller_message(struct controller *controller, const struct protocol_msg *msg)
{
    int works = controller->status != DP_STATUS_ERROR;
    float targets[3];
    int i;

    switch (msg->opcode) {
    case DP_OPCODE_HOMING:
        if (works) {
            controller->status = DP_STATUS_HOMING;
            controller->known = 0;
        }
        answer(controller, msg->opcode, works);
        report(controller);
        break;
    case DP_OPCODE_MOVE:
        if (!controller->known) {
            answer(controller, msg->opcode, 0);
            break;
        }
        works = works && read_targets(msg, targets);
        if (works) {
            controller->status = DP_STATUS_MOVING;
            for (i = 0; i < 3; ++i)
                controller->arms[i].target = targets[i];
        }
        answer(controller, msg->opcode, works);
        report(controller);
        break;
    case DP_OPCODE_CANCEL:
        if (works)
            controller->status = DP_STATUS_IDLE;
        answer(controller, msg->opcode, works);
        report(controller);
        break;
    case DP_OPCODE_STATUS:
        report(controller);
        break;
    default:
        /* Acknowledgements, and what only a controller sends. */
        break;
    }
}

/* Towards the stop at the near end; 1 when it is pressed. */
static int home_arm(struct arm *arm)
{
    if (arm->position > UNITS_PER_MS) {
        arm->position -= UNITS_PER_MS;
    } else {
        arm->position = 0.0f;
        arm->stop = 1;
    }
    return arm->stop;
}

/* Towards the target; 1 when it is reached. Tells whether a step of the encoder was crossed. */
static int move_arm(struct arm *arm, int *stepped)
{
    float away = arm->target - arm->position;
    int before = (int)(arm->position / ENCODER_STEP);

    if (away < TOLERANCE && away > -TOLERANCE)
        return 1;
    if (away > UNITS_PER_MS)
        away = UNITS_PER_MS;
    else if (away < -UNITS_PER_MS)
        away = -UNITS_PER_MS;
    arm->position += away;
    arm->stop = arm->position <= 0.0f || arm->position >= RANGE_END;
    if ((int)(arm->position / ENCODER_STEP) != before)
        *stepped = 1;
    return 0;
}

/* The simulated arms, a millisecond later. */
static void move_arms(struct controller *controller)
{
    int arrived = 0, stepped = 0, stuck = 0;
    int i;

    for (i = 0; i < 3; ++i) {
        struct arm *arm = &controller->arms[i];

        if (controller->status == DP_STATUS_HOMING) {
            arrived += home_arm(arm);
        } else {
            arrived += move_arm(arm, &stepped);
            stuck |= arm->stop && (arm->target < -TOLERANCE || arm->target > RANGE_END + TOLERANCE);
        }
    }
    if (stuck) {
        controller->status = DP_STATUS_ERROR;
        send(controller, DP_OPCODE_GENERAL_ERR, 0, 0);
        report(controller);
    } else if (arrived == 3) {
        /*
         * Hosts after the specification wait for h or m, those of shipped firmware for a report with IDLE: both get
         * theirs.
         */
        send(controller, controller->status == DP_STATUS_HOMING ? DP_OPCODE_HOMING_REPL : DP_OPCODE_MOVE_REPL, 0, 0);
        controller->known = 1;
        controller->status = DP_STATUS_IDLE;
        report(controller);
    } else if (stepped) {
        report(controller);
    }
}

void controller_run(struct controller *controller, unsigned int now_ms)
{
    while (controller->moved_ms != now_ms) {
        ++controller->moved_ms;
        if (controller->status == DP_STATUS_HOMING || controller->status == DP_STATUS_MOVING)
            move_arms(controller);
    }
}
