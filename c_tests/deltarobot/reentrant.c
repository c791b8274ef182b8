/* Callbacks that call the library again on the very structs their caller was given. */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

#include "check.h"
#include "wire.h"

#define DEPTH_MAX 5

struct station {
    struct protocol_data ring;
    struct protocol_msg message;
    int calls, depth, action, stop_after;
};

static struct station new_station(void)
{
    struct station station;
    memset(&station, 0, sizeof station);
    return station;
}

/* A loop-back line whose driver reads and answers before it returns. */
static int send_and_answer(void *buf, int bytes, void *usr)
{
    struct station *station = usr;
    unsigned char sent[WIRE_FRAME_MAX];
    int depth = ++station->calls;

    memcpy(sent, buf, (size_t)bytes);
    CHECK_INT(dp_process(&station->ring, buf, bytes), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&station->ring, &station->message), DP_RC_SUCCESS);
    CHECK_INT(station->message.opcode, sent[1]);
    station->message.opcode = DP_OPCODE_ACK;
    station->message.data_s = 1;
    station->message.data[0] = (char)sent[1];
    if (depth < DEPTH_MAX)
        CHECK_INT(dp_send(&station->message, send_and_answer, station), 100 + depth + 1);
    /* What was given to this call is still there after the inner ones. */
    CHECK_BYTES(buf, sent, bytes);
    return 100 + depth;
}

static void send_callback_uses_the_same_structs(void)
{
    struct station station = new_station();
    station.message.opcode = DP_OPCODE_HOMING;
    CHECK_INT(dp_send(&station.message, send_and_answer, &station), 101);
    CHECK_INT(station.calls, DEPTH_MAX);
    CHECK_INT(station.message.opcode, DP_OPCODE_ACK);
    CHECK_INT(station.ring.m_sz, 0);
}

/* The callback owns the frame while it runs, and may write to it. */
static int scribble(void *buf, int bytes, void *usr)
{
    struct station *station = usr;
    memset(buf, 0xEE, (size_t)bytes);
    memset(&station->message, 0xEE, sizeof station->message);
    memset(&station->ring, 0xEE, sizeof station->ring);
    return dp_recv(&station->ring, &station->message);
}

static void send_callback_overwrites_everything(void)
{
    struct station station = new_station();
    station.message.opcode = DP_OPCODE_MOVE;
    CHECK_INT(dp_send(&station.message, scribble, &station), DP_RC_NO_FRAME);
    CHECK_INT(station.ring.m_sz, 0);
}

enum action { RECV, PROCESS, INIT, EACH, WIPE, ACTIONS };
static const char *const ACTION_NAMES[ACTIONS] = {"recv", "process", "init", "each", "wipe"};

/* Calls the library on the ring that is being read, in one of several ways. */
static int meddle(const struct protocol_msg *msg, void *usr)
{
    struct station *station = usr;
    struct protocol_msg before;
    unsigned char frame[WIRE_FRAME_MAX];
    int length = wire_frame(frame, DP_OPCODE_CANCEL, "", 0);

    ++station->calls;
    memcpy(&before, msg, sizeof before);
    CHECK(msg->data_s >= 0 && msg->data_s <= 1);
    switch (station->action) {
    case RECV:
        dp_recv(&station->ring, &station->message);
        dp_recv_idle(&station->ring, &station->message);
        break;
    case PROCESS:
        /* Once for each message that is not one of these, or this would never end. */
        if (msg->opcode != DP_OPCODE_CANCEL)
            dp_process(&station->ring, frame, length);
        break;
    case INIT:
        CHECK_INT(dp_init(&station->ring), DP_RC_SUCCESS);
        break;
    case EACH:
        if (station->depth < DEPTH_MAX) {
            int taken;
            ++station->depth;
            taken = dp_process_each(&station->ring, frame, length, meddle, station);
            --station->depth;
            CHECK(station->stop_after ? taken >= 0 && taken <= length : taken == length);
        }
        break;
    default:
        memset(&station->ring, 0xFF, sizeof station->ring);
        break;
    }
    CHECK_INT(msg->opcode, before.opcode);
    CHECK_INT(msg->data_s, before.data_s);
    CHECK_BYTES(msg->data, before.data, before.data_s);
    CHECK_INT(msg->checksum_ok, 1);
    return station->stop_after && station->calls % station->stop_after == 0;
}

/* 50 frames, some with a byte of payload, with noise between. */
static int stream_of_frames(unsigned char *out)
{
    int length = 0;
    int i;
    for (i = 0; i < 50; ++i) {
        length += wire_frame(out + length, DP_PROTO_ALL_OPCODES[i % 5], "x", i % 2);
        if (i % 3 == 0)
            out[length++] = '$';
    }
    return length;
}

static void message_callback_uses_the_same_ring(enum action action, int stop_after)
{
    unsigned char stream[50 * (WIRE_OVERHEAD + 2)];
    int length = stream_of_frames(stream);
    struct station station = new_station();
    int at = 0, calls = 0;

    station.action = (int)action;
    station.stop_after = stop_after;
    while (at < length && calls++ < 1000) {
        int taken = dp_process_each(&station.ring, stream + at, length - at, meddle, &station);
        if (!CHECK(taken >= 0 && taken <= length - at))
            return;
        at += taken;
        if (!stop_after)
            CHECK_INT(at, length);
    }
    CHECK_INT(at, length);
    CHECK(station.calls > 0);
    CHECK_INT(dp_init(&station.ring), DP_RC_SUCCESS);
    CHECK_INT(station.ring.m_sz, 0);
    printf("reentrant: %s, stopped %s: %d messages\n", ACTION_NAMES[action], stop_after ? "at times" : "never",
           station.calls);
}

int main(void)
{
    int action, stop_after;

    send_callback_uses_the_same_structs();
    send_callback_overwrites_everything();
    for (action = 0; action < ACTIONS; ++action)
        for (stop_after = 0; stop_after < 3; ++stop_after)
            message_callback_uses_the_same_ring((enum action)action, stop_after);
    return check_summary("reentrant");
}
