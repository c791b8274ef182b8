/* A controller's firmware on controller.h, and the platform that it moves, at the far end of a line. */
#ifndef PLATFORM_H
#define PLATFORM_H

#include "libdeltarobot/controller.h"

#include "channel.h"

enum {
    ONE_WAY_MS = 150, /* the longest delay of a line; twice that is below the session's guard time of 500 */
    SENT = 64
};

/* The last frames from an end. */
typedef struct {
    struct {
        unsigned char bytes[40];
        int length;
        unsigned long at;
    } frames[SENT];
    unsigned next;
} Sent;

static Sent from_host, from_controller;
static struct dp_controller controllers[2], *controller = controllers;

/* What is known of the platform, and happened to it since the current request. */
static struct {
    int state;
    int known;
    float at[3], target[3];
    unsigned long since, ends, step;
    int firmware, stuck, stopping;
    int unpadded; /* firmware whose structs have no padding, as on AVR: reports of 13 bytes */
    int homings, arrivals, faults, nacks, sendings; /* since the operation was requested */
    float wanted[3];
    unsigned long heard_at;
} plant;

static void send_frame(Line *line, Sent *sent, const unsigned char *bytes, int length)
{
    unsigned place = sent->next++ % SENT;
    memcpy(sent->frames[place].bytes, bytes, (size_t)length);
    sent->frames[place].length = length;
    sent->frames[place].at = now;
    transmit(line, bytes, length);
}

/*
 * Marks the run as forged unless the frame of that was sent, and lately enough to be understood only now: behind the
 * beginning of a false frame, it is found when the line was quiet for a while.
 */
static int was_sent(const Sent *sent, int opcode, const void *payload, int size)
{
    unsigned char frame[WIRE_FRAME_MAX];
    int length = wire_frame(frame, opcode, payload, size), i;

    for (i = 0; i < SENT; ++i)
        if (sent->frames[i].length == length && now <= sent->frames[i].at + ONE_WAY_MS + 100 &&
            memcmp(sent->frames[i].bytes, frame, (size_t)length) == 0)
            return 1;
    forged = 1;
    return 0;
}

static int is_running(void)
{
    return plant.state == DP_STATUS_HOMING || plant.state == DP_STATUS_MOVING;
}

static void stand(int state)
{
    plant.state = state;
    plant.stopping = 0;
}

static int start_homing(void *usr)
{
    (void)usr;
    was_sent(&from_host, DP_OPCODE_HOMING, "", 0);
    plant.state = DP_STATUS_HOMING;
    plant.stopping = 0;
    plant.ends = now + 100 + below(1500);
    return 0;
}

static int start_move(const struct protocol_msg_position *target, void *usr)
{
    const float axes[3] = {target->DA, target->DB, target->DC};
    unsigned char wire[12];
    int i;

    (void)usr;
    /* As they are on the wire, whatever order the processor has. */
    for (i = 0; i < 12; ++i) {
        unsigned bits;
        memcpy(&bits, &axes[i / 4], sizeof bits);
        wire[i] = (unsigned char)(bits >> i % 4 * 8);
    }
    was_sent(&from_host, DP_OPCODE_MOVE, wire, 12);
    plant.target[0] = target->DA;
    plant.target[1] = target->DB;
    plant.target[2] = target->DC;
    plant.state = DP_STATUS_MOVING;
    plant.stopping = 0;
    /* Some moves are over before anybody looks. */
    plant.ends = now + (below(8) == 0 ? below(3) : 50 + below(1500));
    plant.step = now + 50;
    return 0;
}

static int stop(void *usr)
{
    (void)usr;
    was_sent(&from_host, DP_OPCODE_CANCEL, "", 0);
    if (is_running() && !plant.stopping) {
        int i;
        for (i = 0; i < 3; ++i)
            plant.at[i] = (plant.at[i] + plant.target[i]) / 2 + 1;
        /* Some need time to stand. */
        plant.stuck = 0;
        if (below(2)) {
            plant.stopping = 1;
            plant.ends = now + below(200);
        } else {
            stand(DP_STATUS_IDLE);
        }
    }
    return 0;
}

static void read_status(struct protocol_msg_status_report *report, void *usr)
{
    static const unsigned UNKNOWN = 0x7F800001;
    (void)usr;
    if (plant.known) {
        report->DA = plant.at[0];
        report->DB = plant.at[1];
        report->DC = plant.at[2];
    } else {
        memcpy(&report->DA, &UNKNOWN, sizeof UNKNOWN);
        memcpy(&report->DB, &UNKNOWN, sizeof UNKNOWN);
        memcpy(&report->DC, &UNKNOWN, sizeof UNKNOWN);
    }
    report->STAT = (unsigned char)(plant.state | (int)below(8) << 2);
}

static int send_up(void *buf, int bytes, void *usr)
{
    unsigned char frame[WIRE_FRAME_MAX];
    const unsigned char *given = buf;
    (void)usr;
    memcpy(frame, given, (size_t)bytes);
    if (plant.firmware && frame[1] == DP_OPCODE_STATUS_REPL) {
        unsigned char payload[16];
        memcpy(payload, frame + 3, 16);
        payload[12] |= 0xE0;
        wire_random_bytes(&seed, payload + 13, 3);
        bytes = wire_frame(frame, DP_OPCODE_STATUS_REPL, payload, plant.unpadded ? 13 : 16);
    }
    if (frame[1] == DP_OPCODE_NACK)
        ++plant.nacks;
    send_frame(&up, &from_controller, frame, bytes);
    return bytes;
}

static const struct dp_controller_calls CALLS = {start_homing, start_move, stop, read_status, send_up};

static void platform_moves(void)
{
    if (!is_running())
        return;
    if (now >= plant.ends && !plant.stuck) {
        if (plant.stopping) {
            stand(DP_STATUS_IDLE);
        } else if (plant.state == DP_STATUS_HOMING) {
            plant.known = 1;
            plant.at[0] = plant.at[1] = plant.at[2] = 0;
            ++plant.homings;
            stand(DP_STATUS_IDLE);
        } else {
            memcpy(plant.at, plant.target, sizeof plant.at);
            if (memcmp(plant.at, plant.wanted, sizeof plant.at) == 0)
                ++plant.arrivals;
            stand(DP_STATUS_IDLE);
        }
    } else if (plant.state == DP_STATUS_MOVING && now >= plant.step) {
        plant.step = now + 50;
        if (plant.firmware)
            dp_controller_report(controller);
    }
}

static int controller_flags;

static void reset_controller(void)
{
    CHECK_INT(dp_controller_init(controller, &CALLS, NULL, plant.firmware ? DP_LAYOUT_FIRMWARE : DP_LAYOUT_SPEC,
                                 controller_flags),
              DP_RC_SUCCESS);
    plant.known = 0;
    plant.stuck = 0;
    stand(DP_STATUS_IDLE);
    ++plant.faults;
}

static void controller_runs(void)
{
    unsigned char bytes[64];
    int length;

    platform_moves();
    while ((length = arrived(&down, bytes, 1 + (int)below(DP_BUFSIZE < 64 ? DP_BUFSIZE : 64))) > 0) {
        int taken = 0;
        plant.heard_at = now;
        while (taken < length) {
            int more = dp_controller_receive(controller, bytes + taken, length - taken);
            CHECK(more > 0 && more <= length - taken);
            if (more <= 0)
                break;
            taken += more;
            while (dp_controller_poll(controller) == DP_RC_SUCCESS)
                ;
        }
    }
    while ((now - plant.heard_at >= 20 ? dp_controller_poll_idle(controller) : dp_controller_poll(controller)) ==
           DP_RC_SUCCESS)
        ;
}

#endif
