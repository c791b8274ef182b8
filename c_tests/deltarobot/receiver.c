/*
 * receiver: libdeltarobot/receiver.h. What it finds in noise is compared in noise.c and exhaustive.c; here: what each
 * function returns, any contents, bytes that come while something is unfetched, and random streams beside dp_recv.
 */
#include "libdeltarobot/receiver.h"

#include "check.h"
#include "wire.h"

static unsigned long seed = 1;

static int give(struct dp_receiver *receiver, const void *bytes, int count)
{
    int i, due = 0;

    for (i = 0; i < count; ++i)
        due = dp_receiver_byte(receiver, ((const unsigned char *)bytes)[i]);
    return due;
}

static void frames_by_bytes(void)
{
    struct dp_receiver receiver;
    struct protocol_msg msg;

    memset(&msg, 0x55, sizeof msg);
    CHECK_INT(dp_receiver_init(&receiver), DP_RC_SUCCESS);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    CHECK_INT(msg.opcode, 0xFF);
    CHECK_INT(msg.data[0], 0x55);
    CHECK_INT(dp_receiver_idle(&receiver, &msg), DP_RC_NO_FRAME);
    CHECK_INT(give(&receiver, "$S\0\xB1", 4), 0);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    CHECK_INT(dp_receiver_byte(&receiver, ':'), 1);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
    CHECK(msg.opcode == DP_OPCODE_STATUS && msg.data_s == 0 && msg.checksum_ok == 1);
    CHECK_INT(msg.data[0], 0x55);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    CHECK_INT(msg.opcode, 0xFF);

    /* Garbage is thrown away when as many bytes are there as a frame needs. */
    give(&receiver, "noise", 5);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_GARBAGE);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    /* Inside a false start, and right behind it. */
    give(&receiver, "$X$h\0\xC6:", 7);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
    CHECK_INT(msg.opcode, DP_OPCODE_HOMING_REPL);
    /* Incomplete: waited for, then given up. */
    give(&receiver, "$A\1$S\0\xB1", 7);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_GARBAGE);
    CHECK_INT(dp_receiver_byte(&receiver, ':'), 1);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
    give(&receiver, "$A\1", 3);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    CHECK_INT(dp_receiver_idle(&receiver, &msg), DP_RC_GARBAGE);
    CHECK_INT(dp_receiver_idle(&receiver, &msg), DP_RC_NO_FRAME);
}

static void what_is_unfetched_is_kept(void)
{
    struct dp_receiver receiver;
    struct protocol_msg msg;
    unsigned char payload[DP_DATA_MAX_SIZE], frame[WIRE_FRAME_MAX];
    int size, i, kept = 0;

    wire_random_bytes(&seed, payload, sizeof payload);
    size = wire_frame(frame, DP_OPCODE_MOVE, payload, DP_DATA_MAX_SIZE);
    dp_receiver_init(&receiver);
    for (i = 0; i < size; ++i)
        if (dp_receiver_byte(&receiver, frame[i]) && i < size - 1)
            CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
    /* Nobody fetches it: further bytes are kept while there is room, and then not taken. */
    while ((i = dp_receiver_byte(&receiver, (unsigned char)"$S\0\xB1:"[kept % 5])) == 1)
        ++kept;
    CHECK_INT(i, -DP_RC_OVERFLOW);
    CHECK_INT(dp_receiver_byte(&receiver, '$'), -DP_RC_OVERFLOW);
    CHECK(kept >= 5);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
    CHECK_INT(msg.data_s, DP_DATA_MAX_SIZE);
    CHECK_BYTES(msg.data, payload, DP_DATA_MAX_SIZE);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
    CHECK_INT(msg.opcode, DP_OPCODE_STATUS);
    CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_NO_FRAME);
}

static int count_msg(const struct protocol_msg *msg, void *usr)
{
    (void)msg;
    ++*(int *)usr;
    return 0;
}

static void null_pointers_and_sizes(void)
{
    struct dp_receiver receiver = {{0}};
    struct protocol_msg msg;
    int count = 0;

    CHECK_INT(dp_receiver_init(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_byte(NULL, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_next(NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_next(&receiver, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_idle(&receiver, NULL), DP_RC_ERROR_GENERIC);
    msg.opcode = 1;
    CHECK_INT(dp_receiver_next(NULL, &msg), DP_RC_ERROR_GENERIC);
    CHECK_INT(msg.opcode, 0xFF);
    msg.opcode = 1;
    CHECK_INT(dp_receiver_idle(NULL, &msg), DP_RC_ERROR_GENERIC);
    CHECK_INT(msg.opcode, 0xFF);
    CHECK_INT(dp_receiver_each(NULL, "", 0, count_msg, &count), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_each(&receiver, "", 0, NULL, &count), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_each(&receiver, NULL, 1, count_msg, &count), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_each(&receiver, "", -1, count_msg, &count), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_receiver_each(&receiver, NULL, 0, count_msg, &count), 0);
    CHECK_INT(count, 0);
}

static int stop_at_homing(const struct protocol_msg *msg, void *usr)
{
    ++*(int *)usr;
    return msg->opcode == DP_OPCODE_HOMING;
}

static void each_stops_and_goes_on(void)
{
    static const char stream[] = "x$S\0\xB1:$H\0\xA6:$A\001M\xED:$H\0\xA6:$C";
    const int size = (int)sizeof stream - 1;
    int piece;

    for (piece = 1; piece <= size; ++piece) {
        struct dp_receiver receiver = {{0}};
        int at = 0, count = 0, stops = 0;

        while (at < size) {
            int bytes = size - at < piece ? size - at : piece;
            int taken = dp_receiver_each(&receiver, stream + at, bytes, stop_at_homing, &count);

            CHECK(0 <= taken && taken <= bytes);
            if (taken < bytes || (at + taken == 11 || at + taken == 22))
                ++stops;
            at += taken;
        }
        CHECK_INT(count, DP_DATA_MAX_SIZE >= 1 ? 4 : 3);
        CHECK(stops >= 2);
    }
}

struct log {
    int count;
    unsigned long sum;
};

static int log_msg(const struct protocol_msg *msg, void *usr)
{
    struct log *log = usr;
    int i;

    ++log->count;
    log->sum = log->sum * 31 + msg->opcode + (unsigned)msg->data_s;
    for (i = 0; i < msg->data_s; ++i)
        log->sum = log->sum * 31 + (unsigned char)msg->data[i];
    return 0;
}

/* Frames, beginnings of frames and noise. */
static int random_stream(unsigned char *out, int size)
{
    int at = 0;

    while (at + WIRE_FRAME_MAX < size) {
        unsigned char payload[255];
        unsigned kind = wire_random(&seed) % 8;
        int length = (int)(wire_random(&seed) % (unsigned)(kind ? DP_DATA_MAX_SIZE + 1 : 256)), i;

        wire_random_bytes(&seed, payload, sizeof payload);
        if (kind < 5) {
            int bytes = wire_frame(out + at, DP_PROTO_ALL_OPCODES[wire_random(&seed) % 10], payload, length);
            if (wire_random(&seed) % 8 == 0)
                out[at + (int)(wire_random(&seed) % (unsigned)bytes)] ^= 1;
            at += bytes;
        } else {
            for (i = 0; i < length % 12; ++i)
                out[at++] = kind < 7 ? (unsigned char)"$A:\0\1\2mM"[wire_random(&seed) % 8] : payload[i];
        }
    }
    return at;
}

static void random_streams(void)
{
    static unsigned char stream[4096];
    int round;

    for (round = 0; round < 500; ++round) {
        static struct protocol_data ring;
        struct dp_receiver receiver, by_bytes;
        struct log of_ring = {0, 0}, of_each = {0, 0}, of_bytes = {0, 0};
        struct protocol_msg msg;
        int size = random_stream(stream, sizeof stream), at, bytes;

        memset(&ring, 0, sizeof ring);
        memset(&receiver, 0, sizeof receiver);
        memset(&by_bytes, 0, sizeof by_bytes);
        for (at = 0; at < size; at += bytes) {
            int i;

            bytes = 1 + (int)(wire_random(&seed) % (round % 2 ? 8 : 200));
            if (bytes > size - at)
                bytes = size - at;
            for (i = 0; i < bytes; ++i) {
                dp_process(&ring, stream + at + i, 1);
                while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
                    log_msg(&msg, &of_ring);
                if (dp_receiver_byte(&by_bytes, stream[at + i]))
                    while (dp_receiver_next(&by_bytes, &msg) == DP_RC_SUCCESS)
                        log_msg(&msg, &of_bytes);
            }
            CHECK_INT(dp_receiver_each(&receiver, stream + at, bytes, log_msg, &of_each), bytes);
            CHECK(of_each.count == of_ring.count && of_each.sum == of_ring.sum);
            CHECK(of_bytes.count == of_ring.count && of_bytes.sum == of_ring.sum);
        }
    }
}

static void any_contents(void)
{
    long round;

    for (round = 0; round < 20000; ++round) {
        struct dp_receiver receiver;
        struct protocol_msg msg;
        unsigned char stream[64];
        int i, count = 0;

        wire_any_memory(&seed, &receiver, sizeof receiver);
        if (round % 4 == 0) /* counts that may be in range */
            for (i = 0; i < 6; ++i)
                ((unsigned char *)&receiver)[i] &= i % 2 ? 0 : 0x3F;
        for (i = 0; i < (int)sizeof stream; ++i)
            stream[i] = round % 2 ? (unsigned char)"$A:\0\1\2mM"[wire_random(&seed) % 8] : (unsigned char)wire_random(&seed);
        if (wire_random(&seed) % 2) {
            CHECK_INT(dp_receiver_each(&receiver, stream, sizeof stream, count_msg, &count), sizeof stream);
        } else {
            for (i = 0; i < (int)sizeof stream; ++i)
                if (dp_receiver_byte(&receiver, stream[i]) != 0)
                    while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
                        ++count;
        }
        while (dp_receiver_idle(&receiver, &msg) == DP_RC_SUCCESS)
            ++count;
        /* Whatever it was, it works now. */
        CHECK_INT(give(&receiver, "$S\0\xB1:", 5), 1);
        CHECK_INT(dp_receiver_next(&receiver, &msg), DP_RC_SUCCESS);
        CHECK_INT(msg.opcode, DP_OPCODE_STATUS);
    }
}

int main(void)
{
    CHECK_INT(sizeof(struct dp_receiver), (DP_DATA_MAX_SIZE + 15 + sizeof(long)) / sizeof(long) * sizeof(long));
    frames_by_bytes();
    what_is_unfetched_is_kept();
    null_pointers_and_sizes();
    each_stops_and_goes_on();
    random_streams();
    any_contents();
    return check_summary("receiver");
}
