/* A host session step by step: what the tests of host.h share. */
#ifndef HOST_STEPS_H
#define HOST_STEPS_H

#include "libdeltarobot/host.h"

#include "check.h"
#include "wire.h"

/* Whether a session can work: status reports fit its frames. */
#define HOST_WORKS (DP_DATA_MAX_SIZE >= 16)

#if HOST_WORKS

static struct dp_host host;
static struct dp_host_event event;
static struct dp_host_health health;
static unsigned long now;
static unsigned char waiting[4 * WIRE_FRAME_MAX];
static int waiting_count;
static const struct protocol_msg_position TARGET = {1, 2, -3.5f};

/* Begins a session late in the clock's turn. */
static void begin(void)
{
    now = 0xFFFFFF00ul;
    waiting_count = 0;
    memset(&host, 0x5A, sizeof host);
    CHECK_INT(dp_host_init(&host, NULL), DP_RC_SUCCESS);
}

/* The statistics as they are now. */
static const struct dp_host_health *healthy(void)
{
    memset(&health, 0x5A, sizeof health);
    CHECK_INT(dp_host_get_health(&host, &health), DP_RC_SUCCESS);
    return &health;
}

static void pass(unsigned long ms)
{
    now = (now + ms) & 0xFFFFFFFFul;
}

static int receive_waiting(void)
{
    int taken = dp_host_receive(&host, waiting, waiting_count, now);
    CHECK(taken >= 0 && taken <= waiting_count);
    waiting_count -= taken;
    memmove(waiting, waiting + taken, (size_t)waiting_count);
    return taken;
}

/* The next event, of what waits too. */
static int next_event(void)
{
    int rc;
    while ((rc = dp_host_poll(&host, now, &event)) == DP_RC_NO_EVENT && waiting_count > 0)
        CHECK(receive_waiting() > 0);
    return rc;
}

/* What is sent now: its opcodes, e.g. "CS". */
static int sends(const char *opcodes)
{
    unsigned char out[DP_HOST_OUTPUT_MAX];
    const unsigned char *frame = out;
    char got[8];
    int count = 0, length;

    while (next_event() == DP_RC_SUCCESS)
        CHECK(event.kind == DP_HOST_STATUS || event.kind == DP_HOST_STATE); /* others are asked for */
    length = dp_host_output(&host, out, DP_HOST_OUTPUT_MAX, now);
    while (frame < out + length && count < 7) {
        got[count++] = (char)frame[1];
        frame += frame[2] + WIRE_OVERHEAD;
    }
    got[count] = '\0';
    CHECK(frame == out + length);
    CHECK_INT(dp_host_output(&host, out, DP_HOST_OUTPUT_MAX, now), 0);
    return strcmp(got, opcodes) == 0;
}

/* A frame comes. What there is no room for waits until all events were fetched. */
static void comes(int opcode, const void *payload, int size)
{
    unsigned char *frame = waiting + waiting_count;
    if (!CHECK(waiting_count + WIRE_FRAME_MAX <= (int)sizeof waiting))
        return;
    waiting_count += wire_frame(frame, opcode, payload, size);
    receive_waiting();
}

/* A report as shipped firmware sends it; the position is TARGET times part, or unknown. */
static void comes_report(int state, float part)
{
    unsigned char payload[16] = {1, 0, 0x80, 0x7F, 1, 0, 0x80, 0x7F, 1, 0, 0x80, 0x7F, 0, 0xDE, 0xAD, 0xBE};
    if (part >= 0) {
        float at[3];
        at[0] = TARGET.DA * part;
        at[1] = TARGET.DB * part;
        at[2] = TARGET.DC * part;
        memcpy(payload, at, sizeof at);
    }
    payload[12] = (unsigned char)(0xE0 | state);
    comes('s', payload, 16);
}

/* The next event but status reports is this one. */
static int tells(int kind, int opcode, int outcome)
{
    int rc;
    while ((rc = next_event()) == DP_RC_SUCCESS)
        if (event.kind != DP_HOST_STATUS && event.kind != DP_HOST_STATE)
            break;
    if (kind == 0)
        return CHECK_INT(rc, DP_RC_NO_EVENT) && CHECK_INT(event.kind, 0);
    return CHECK_INT(rc, DP_RC_SUCCESS) && CHECK_INT(event.kind, kind) && CHECK_INT(event.opcode, opcode) &&
           CHECK_INT(event.outcome, outcome);
}

static int tells_nothing(void)
{
    return tells(0, 0, 0);
}

#endif
#endif
