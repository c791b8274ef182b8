/* Two threads with a ring each: the library has no state of its own that they could meet in. */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

#include "check.h"
#include "wire.h"

#include <pthread.h>

#define MESSAGES 20000

/* The counters of check.h are for one thread: these report to main. */
struct worker {
    pthread_t thread;
    struct protocol_data ring;
    unsigned long seed;
    unsigned char expected[WIRE_FRAME_MAX];
    int expected_length, delivered, wrong;
};

static int loop_back(void *buf, int bytes, void *usr)
{
    struct worker *worker = usr;
    if (bytes != worker->expected_length || memcmp(buf, worker->expected, (size_t)bytes) != 0)
        ++worker->wrong;
    return dp_process(&worker->ring, buf, bytes);
}

static int count_message(const struct protocol_msg *msg, void *usr)
{
    struct worker *worker = usr;
    unsigned char wire[WIRE_FRAME_MAX];
    int length = wire_frame(wire, msg->opcode, msg->data, msg->data_s);
    if (length != worker->expected_length || memcmp(wire, worker->expected, (size_t)length) != 0)
        ++worker->wrong;
    ++worker->delivered;
    return 0;
}

static void *work(void *usr)
{
    struct worker *worker = usr;
    int i;

    for (i = 0; i < MESSAGES; ++i) {
        struct protocol_msg msg;
        memset(&msg, 0, sizeof msg);
        msg.opcode = (unsigned char)DP_PROTO_ALL_OPCODES[wire_random(&worker->seed) % 10];
        msg.data_s = (int)(wire_random(&worker->seed) % (DP_DATA_MAX_SIZE + 1));
        wire_random_bytes(&worker->seed, msg.data, (size_t)msg.data_s);
        worker->expected_length = wire_frame(worker->expected, msg.opcode, msg.data, msg.data_s);
        if (i % 2) {
            if (dp_process_each(&worker->ring, worker->expected, worker->expected_length, count_message, worker) !=
                worker->expected_length)
                ++worker->wrong;
        } else if (dp_send(&msg, loop_back, worker) != DP_RC_SUCCESS || dp_recv(&worker->ring, &msg) != DP_RC_SUCCESS) {
            ++worker->wrong;
        } else {
            count_message(&msg, worker);
        }
    }
    return NULL;
}

int main(void)
{
    static struct worker workers[2];
    int i;

    for (i = 0; i < 2; ++i) {
        workers[i].seed = 0x1234567ul + (unsigned long)i;
        CHECK_INT(pthread_create(&workers[i].thread, NULL, work, &workers[i]), 0);
    }
    for (i = 0; i < 2; ++i) {
        CHECK_INT(pthread_join(workers[i].thread, NULL), 0);
        CHECK_INT(workers[i].delivered, MESSAGES);
        CHECK_INT(workers[i].wrong, 0);
        CHECK_INT(workers[i].ring.m_sz, 0);
    }
    return check_summary("threads");
}
