/* What protocol_ext.h adds to the original's API, and what dp_process does when the ring is too small. */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

#include "check.h"
#include "wire.h"

#include <limits.h>
#include <stdlib.h>

#define STREAM_BYTES (100 * 1024)
#define FRAMES_MAX (STREAM_BYTES / WIRE_OVERHEAD)

static struct protocol_data ring;
static struct protocol_msg message;
static unsigned long seed = 0xC0FFEE;

/* A long stream of frames with noise between, where each frame starts, and how many of them have arrived. */
static unsigned char stream[STREAM_BYTES];
static int stream_length;
static int frame_at[FRAMES_MAX];
static int frame_count;
static int arrived;

/* Noise without a starter can't swallow a frame; with this it would not be known which frames must arrive. */
static int put_noise(unsigned char *out)
{
    int count = (int)(wire_random(&seed) % 8);
    int i;
    wire_random_bytes(&seed, out, (size_t)count);
    for (i = 0; i < count; ++i)
        if (out[i] == '$')
            out[i] = ':';
    return count;
}

static int put_random_frame(unsigned char *out)
{
    unsigned char payload[DP_DATA_MAX_SIZE];
    int size = (int)(wire_random(&seed) % (DP_DATA_MAX_SIZE + 1));
    wire_random_bytes(&seed, payload, (size_t)size);
    if (size > WIRE_OVERHEAD)
        wire_frame(payload, DP_OPCODE_HOMING, "", 0); /* a frame within the frame: never delivered */
    return wire_frame(out, DP_PROTO_ALL_OPCODES[wire_random(&seed) % 10], payload, size);
}

static void make_stream(void)
{
    while (stream_length + DP_DATA_MAX_SIZE + WIRE_OVERHEAD + 8 < STREAM_BYTES) {
        stream_length += put_noise(stream + stream_length);
        frame_at[frame_count++] = stream_length;
        stream_length += put_random_frame(stream + stream_length);
    }
    memset(stream + stream_length, 'z', (size_t)(STREAM_BYTES - stream_length));
    stream_length = STREAM_BYTES;
}

static void start(void)
{
    CHECK_INT(dp_init(&ring), DP_RC_SUCCESS);
    memset(&message, 0, sizeof message);
    arrived = 0;
}

static void expect_next(const struct protocol_msg *msg)
{
    unsigned char frame[WIRE_FRAME_MAX];
    int length;
    if (!CHECK(arrived < frame_count))
        return;
    CHECK_INT(msg->checksum_ok, 1);
    if (!CHECK(msg->data_s >= 0 && msg->data_s <= DP_DATA_MAX_SIZE))
        return;
    length = wire_frame(frame, msg->opcode, msg->data, msg->data_s);
    CHECK_BYTES(frame, stream + frame_at[arrived], length);
    ++arrived;
}

static int on_msg(const struct protocol_msg *msg, void *usr)
{
    int *stop = usr;
    expect_next(msg);
    CHECK(ring.m_sz >= 0 && ring.m_sz <= DP_BUFSIZE && ring.m_idx >= 0 && ring.m_idx < DP_BUFSIZE);
    return *stop;
}

static void every_message_in_chunks_of(int chunk)
{
    int go_on = 0, at;

    start();
    for (at = 0; at < stream_length; at += chunk) {
        int count = stream_length - at < chunk ? stream_length - at : chunk;
        CHECK_INT(dp_process_each(&ring, stream + at, count, on_msg, &go_on), count);
    }
    CHECK_INT(arrived, frame_count);
    CHECK_INT(ring.m_sz, 0);
}

/* Stopped at every message, the rest is given again until all is taken: `stop` is any int but 0. */
static void stopped_at_every_message(int chunk, int stop)
{
    int at = 0;

    start();
    while (at < stream_length) {
        int count = stream_length - at < chunk ? stream_length - at : chunk;
        int before = arrived;
        int taken = dp_process_each(&ring, stream + at, count, on_msg, &stop);
        if (!CHECK(taken >= 0 && taken <= count))
            return;
        CHECK(arrived == before || arrived == before + 1);
        CHECK(arrived == before + 1 || taken == count);
        at += taken;
    }
    while (dp_recv(&ring, &message) == DP_RC_SUCCESS)
        expect_next(&message);
    CHECK_INT(arrived, frame_count);
}

/* Bytes come by dp_process, dp_process_each and dp_recv in turns. */
static void shares_the_ring(void)
{
    int go_on = 0, at = 0, turn = 0;

    start();
    while (at < stream_length) {
        int count = turn % 7 + 1;
        if (count > stream_length - at)
            count = stream_length - at;
        if (count > DP_BUFSIZE - ring.m_sz)
            count = DP_BUFSIZE - ring.m_sz;
        if (turn % 3 == 0) {
            CHECK_INT(dp_process_each(&ring, stream + at, count, on_msg, &go_on), count);
        } else {
            CHECK_INT(dp_process(&ring, stream + at, count), DP_RC_SUCCESS);
            if ((turn % 3 == 1 || ring.m_sz == DP_BUFSIZE) && dp_recv(&ring, &message) == DP_RC_SUCCESS)
                expect_next(&message);
        }
        at += count;
        ++turn;
    }
    /* No bytes: delivers what is in the ring. */
    CHECK_INT(dp_process_each(&ring, NULL, 0, on_msg, &go_on), 0);
    CHECK_INT(arrived, frame_count);
}

/* A ring full to the last byte loses nothing to dp_process_each. */
static void full_ring_is_emptied_first(void)
{
    int go_on = 0;

    start();
    CHECK_INT(dp_process(&ring, stream, DP_BUFSIZE), DP_RC_SUCCESS);
    CHECK_INT(dp_process_each(&ring, stream + DP_BUFSIZE, stream_length - DP_BUFSIZE, on_msg, &go_on),
              stream_length - DP_BUFSIZE);
    CHECK_INT(arrived, frame_count);
}

static void each_refuses(void)
{
    int go_on = 0;

    start();
    CHECK_INT(dp_process_each(NULL, stream, 1, on_msg, &go_on), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process_each(&ring, NULL, 1, on_msg, &go_on), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process_each(&ring, stream, -1, on_msg, &go_on), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process_each(&ring, stream, INT_MIN, on_msg, &go_on), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process_each(&ring, stream, 1, NULL, &go_on), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process_each(&ring, NULL, 0, on_msg, &go_on), 0);
    CHECK_INT(ring.m_sz, 0);
    ring.m_idx = -5;
    ring.m_sz = INT_MAX;
    CHECK_INT(dp_process_each(&ring, stream, stream_length, on_msg, &go_on), stream_length);
    CHECK_INT(arrived, frame_count);
}

static int feed(const void *bytes, int count)
{
    return dp_process(&ring, (void *)bytes, count);
}

/* A false start whose length byte promises more than comes hides the requests behind it from dp_recv. */
static void idle_gives_up_a_false_start(void)
{
    unsigned char bytes[WIRE_FRAME_MAX];
    int requests = (DP_DATA_MAX_SIZE + 1) / WIRE_OVERHEAD;
    int i, length;

    if (requests > 6)
        requests = 6;
    bytes[0] = '$';
    bytes[1] = DP_OPCODE_MOVE;
    bytes[2] = DP_DATA_MAX_SIZE;
    start();
    CHECK_INT(feed(bytes, 3), DP_RC_SUCCESS);
    length = wire_frame(bytes, DP_OPCODE_STATUS, "", 0);
    for (i = 0; i < requests; ++i) {
        CHECK_INT(feed(bytes, length), DP_RC_SUCCESS);
        CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
    }
    CHECK_INT(ring.m_sz, 3 + requests * length);
    for (i = 0; i < requests; ++i) {
        CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_SUCCESS);
        CHECK_INT(message.opcode, DP_OPCODE_STATUS);
        CHECK_INT(message.data_s, 0);
        CHECK_INT(ring.m_sz, (requests - 1 - i) * length);
    }
    CHECK_INT(dp_recv_idle(&ring, &message), requests ? DP_RC_NO_FRAME : DP_RC_GARBAGE);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_NO_FRAME);
}

static void idle_passes_several_false_starts(void)
{
    unsigned char bytes[64];
    int length = 0;

    memcpy(bytes, "x$M\1$$S\1", 8);
    length = 8;
    length += wire_frame(bytes + length, DP_OPCODE_HOMING, "", 0);
    bytes[length++] = '$';
    bytes[length++] = DP_OPCODE_MOVE;
    length += wire_frame(bytes + length, DP_OPCODE_CANCEL, "", 0);
    bytes[length++] = '$';
    bytes[length++] = DP_OPCODE_MOVE;
    bytes[length++] = DP_DATA_MAX_SIZE;
    if (length > DP_BUFSIZE)
        return;
    start();
    CHECK_INT(feed(bytes, length), DP_RC_SUCCESS);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_HOMING);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_CANCEL);
    memset(&message, 0x44, sizeof message);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_GARBAGE);
    CHECK_INT(message.opcode, 0xFF);
    CHECK_INT(message.data_s, 0x44444444);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_NO_FRAME);
}

/* A whole frame is never given up for what it carries. */
static void idle_respects_whole_frames(void)
{
    unsigned char inner[WIRE_OVERHEAD], bytes[WIRE_FRAME_MAX];
    int size = DP_DATA_MAX_SIZE < WIRE_OVERHEAD ? 0 : WIRE_OVERHEAD;

    wire_frame(inner, DP_OPCODE_HOMING, "", 0);
    start();
    CHECK_INT(feed(bytes, wire_frame(bytes, DP_OPCODE_NACK, inner, size)), DP_RC_SUCCESS);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_NACK);
    CHECK_INT(message.data_s, size);
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_NO_FRAME);
}

static void idle_refuses(void)
{
    start();
    CHECK_INT(dp_recv_idle(NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_recv_idle(&ring, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_recv_idle(NULL, &message), DP_RC_ERROR_GENERIC);
    CHECK_INT(message.opcode, 0xFF);
    ring.m_idx = INT_MAX;
    ring.m_sz = INT_MIN;
    CHECK_INT(dp_recv_idle(&ring, &message), DP_RC_NO_FRAME);
    CHECK_INT(ring.m_sz, 0);
}

static void init_makes_an_empty_ring(void)
{
    static const struct protocol_data zero;

    CHECK_INT(dp_init(NULL), DP_RC_ERROR_GENERIC);
    memset(&ring, 0xFF, sizeof ring);
    CHECK_INT(dp_init(&ring), DP_RC_SUCCESS);
    CHECK_INT(ring.m_idx, 0);
    CHECK_INT(ring.m_sz, 0);
    CHECK_BYTES(ring.m_buf, zero.m_buf, DP_BUFSIZE);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
}

static void version_is_the_headers(void)
{
    char text[64];

    snprintf(text, sizeof text, "%d.%d.%d", DP_VERSION_MAJOR, DP_VERSION_MINOR, DP_VERSION_PATCH);
    CHECK(strcmp(text, DP_VERSION_STRING) == 0);
    CHECK(strcmp(text, dp_version()) == 0);
}

/* Checks that the ring holds these bytes, oldest first. */
static void expect_unread(const unsigned char *bytes, int count)
{
    int i;
    if (!CHECK_INT(ring.m_sz, count))
        return;
    for (i = 0; i < count; ++i)
        CHECK_INT((unsigned char)ring.m_buf[(ring.m_idx + i) % DP_BUFSIZE], bytes[i]);
}

static void overflow_drops_the_oldest(void)
{
    unsigned char bytes[3 * DP_BUFSIZE];
    int offset, extra;

    wire_random_bytes(&seed, bytes, sizeof bytes);
    for (offset = 0; offset < DP_BUFSIZE; ++offset) {
        /* Exactly full is no overflow, from wherever it starts. */
        start();
        ring.m_idx = offset;
        CHECK_INT(feed(bytes, DP_BUFSIZE - 1), DP_RC_SUCCESS);
        CHECK_INT(feed(bytes + DP_BUFSIZE - 1, 1), DP_RC_SUCCESS);
        CHECK_INT(ring.m_idx, offset);
        expect_unread(bytes, DP_BUFSIZE);
        CHECK_INT(feed(bytes, 0), DP_RC_SUCCESS);
        CHECK_INT(feed(NULL, 0), DP_RC_SUCCESS);
        expect_unread(bytes, DP_BUFSIZE);

        /* A little more: the oldest go. */
        for (extra = 1; extra <= DP_BUFSIZE; extra += 1 + extra / 2) {
            start();
            ring.m_idx = offset;
            CHECK_INT(feed(bytes, DP_BUFSIZE), DP_RC_SUCCESS);
            CHECK_INT(feed(bytes + DP_BUFSIZE, extra), DP_RC_OVERFLOW);
            CHECK_INT(ring.m_idx, (offset + extra) % DP_BUFSIZE);
            expect_unread(bytes + extra, DP_BUFSIZE);
        }

        /* More than a ring: its first bytes stay. */
        for (extra = 1; extra <= DP_BUFSIZE; extra += DP_BUFSIZE / 3 + 1) {
            start();
            ring.m_idx = offset;
            CHECK_INT(feed(bytes, 3), DP_RC_SUCCESS);
            CHECK_INT(feed(bytes + 3, DP_BUFSIZE + extra), DP_RC_OVERFLOW);
            expect_unread(bytes + 3, DP_BUFSIZE);
        }
    }
}

int main(void)
{
    static const int CHUNKS[] = {1, 64, 192, 1024, STREAM_BYTES};
    size_t i;

    make_stream();
    for (i = 0; i < sizeof CHUNKS / sizeof *CHUNKS; ++i) {
        every_message_in_chunks_of(CHUNKS[i]);
        stopped_at_every_message(CHUNKS[i], i % 2 ? 1 : -1);
    }
    shares_the_ring();
    full_ring_is_emptied_first();
    each_refuses();
    idle_gives_up_a_false_start();
    idle_passes_several_false_starts();
    idle_respects_whole_frames();
    idle_refuses();
    init_makes_an_empty_ring();
    version_is_the_headers();
    overflow_drops_the_oldest();
    return check_summary("ext");
}
