/*
 * noise: how many of the intact frames of a noisy line are delivered, by the library and by the model of the original.
 *
 * The library has to deliver them all, but for those that begin inside a frame that the noise happened to make. For
 * that a false start has to find a ':' in the right place, and before it one of 256 bytes: the format can't tell it
 * from a frame.
 */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/receiver.h"

#include "check.h"
#include "model/model.h"
#include "wire.h"

#define FRAMES 20000
#define GARBAGE_MAX 20
#define STREAM_MAX (FRAMES * (GARBAGE_MAX + DP_DATA_MAX_SIZE + WIRE_OVERHEAD) + WIRE_FRAME_MAX)

/* A stream, and for each place in it whether an intact frame was put there. */
static unsigned char stream[STREAM_MAX];
static char intact[STREAM_MAX];
static int size;
static unsigned long seed = 1;

struct count {
    int delivered, swallowed;
};

static unsigned one_of(unsigned count)
{
    return wire_random(&seed) % count;
}

static void put_garbage(unsigned dollars_of_256)
{
    unsigned count = one_of(GARBAGE_MAX + 1);
    while (count-- > 0)
        stream[size++] = one_of(256) < dollars_of_256 ? '$' : (unsigned char)wire_random(&seed);
}

/* A frame as long as those of the robot are. */
static int make_frame(unsigned char *out)
{
    static const int lengths[] = {0, 0, 1, 12, 16};
    int length = lengths[one_of(5)];
    unsigned char payload[16];

    if (length > DP_DATA_MAX_SIZE)
        length = DP_DATA_MAX_SIZE;
    wire_random_bytes(&seed, payload, sizeof payload);
    return wire_frame(out, DP_PROTO_ALL_OPCODES[one_of(10)], payload, length);
}

static void put_frame(void)
{
    intact[size] = 1;
    size += make_frame(stream + size);
}

static void put_damaged_frame(void)
{
    unsigned char *frame = stream + size;
    int length = make_frame(frame);
    int at = (int)one_of((unsigned)length);

    if (one_of(2)) {
        frame[at] = (unsigned char)(frame[at] ^ 1u << one_of(8));
    } else {
        memmove(frame + at, frame + at + 1, (size_t)(length - at - 1));
        --length;
    }
    size += length;
}

/* Loses bytes, and with each the frame that it belongs to. */
static void lose_bytes(unsigned lost_of_1000)
{
    int from, to = 0, frame = -1;

    for (from = 0; from < size; ++from) {
        if (intact[from])
            frame = to;
        if (one_of(1000) < lost_of_1000) {
            if (frame >= 0)
                intact[frame] = 0;
            if (frame == to)
                frame = -1;
            continue;
        }
        stream[to] = stream[from];
        intact[to] = frame == to;
        ++to;
    }
    while (size > to)
        intact[--size] = 0;
}

static void make_stream(int with_garbage, unsigned dollars_of_256, unsigned damaged_of_1000, unsigned lost_of_1000)
{
    int i;

    memset(intact, 0, sizeof intact);
    size = 0;
    for (i = 0; i < FRAMES; ++i) {
        if (with_garbage)
            put_garbage(dollars_of_256);
        if (one_of(1000) < damaged_of_1000)
            put_damaged_frame();
        else
            put_frame();
    }
    lose_bytes(lost_of_1000);
    /* So that no candidate is still incomplete at the end. */
    memset(stream + size, 0, WIRE_FRAME_MAX);
    size += WIRE_FRAME_MAX;
}

/* Whether the frame of the message is what stands in the stream there. */
static int stands_at(int start, int opcode, const void *payload, int length)
{
    unsigned char frame[WIRE_FRAME_MAX];
    int bytes = wire_frame(frame, opcode, payload, length);
    return start >= 0 && memcmp(frame, stream + start, (size_t)bytes) == 0;
}

/* Counts a message whose frame is stream[start..end]. They come in their order: *from is the end of the one before. */
static void count_message(struct count *count, int *from, int start, int end)
{
    CHECK(start >= *from);
    if (intact[start])
        ++count->delivered;
    for (*from = start + 1; *from < end; ++*from)
        count->swallowed += intact[*from];
}

/* The ring and the receiver: both deliver the same, though not necessarily at the same byte. */
static struct count through_library(void)
{
    static struct protocol_data ring;
    static struct dp_receiver receiver;
    struct protocol_msg msg, other;
    struct count count = {0, 0};
    int from = 0, fed;

    memset(&ring, 0, sizeof ring);
    memset(&receiver, 0, sizeof receiver);
    for (fed = 1; fed <= size; ++fed) {
        int is_due = dp_receiver_byte(&receiver, stream[fed - 1]);

        CHECK(is_due == 0 || is_due == 1);
        dp_process(&ring, stream + fed - 1, 1);
        while (dp_recv(&ring, &msg) == DP_RC_SUCCESS) {
            int end = fed - ring.m_sz;
            int start = end - msg.data_s - WIRE_OVERHEAD;
            if (CHECK(stands_at(start, msg.opcode, msg.data, msg.data_s)))
                count_message(&count, &from, start, end);
            CHECK(is_due);
            CHECK_INT(dp_receiver_next(&receiver, &other), DP_RC_SUCCESS);
            CHECK(other.opcode == msg.opcode && other.data_s == msg.data_s && other.checksum_ok == 1);
            CHECK_BYTES(other.data, msg.data, msg.data_s);
        }
        if (is_due)
            CHECK(dp_receiver_next(&receiver, &other) != DP_RC_SUCCESS);
    }
    return count;
}

static struct count through_model(void)
{
    static struct model_data ring;
    struct model_msg msg;
    struct count count = {0, 0};
    int from = 0, fed;

    memset(&ring, 0, sizeof ring);
    for (fed = 1; fed <= size; ++fed) {
        model_process(&ring, stream + fed - 1, 1);
        while (model_recv(&ring, &msg) == MODEL_SUCCESS)
            count_message(&count, &from, fed - ring.m_sz - msg.data_s - WIRE_OVERHEAD, fed - ring.m_sz);
    }
    return count;
}

static double percent(int part, int whole)
{
    return 100.0 * part / whole;
}

static void compare(const char *noise)
{
    struct count library = through_library(), model = through_model();
    int at, frames = 0;

    for (at = 0; at < size; ++at)
        frames += intact[at];
    printf("%-40s %6d intact frames: library %.2f %% and %d swallowed by chance, model %.2f %%\n", noise, frames,
           percent(library.delivered, frames), library.swallowed, percent(model.delivered, frames));
    CHECK_INT(library.delivered + library.swallowed, frames);
    CHECK(library.delivered >= model.delivered);
}

static int count_each(const struct protocol_msg *msg, void *usr)
{
    int *count = usr;
    (void)msg;
    ++*count;
    return 0;
}

/* Of 100 frames without noise, how many the original keeps when it is given so many bytes at once. */
static int kept_of_100(int piece)
{
    static struct model_data model;
    static struct protocol_data ring, ring_of_each;
    struct model_msg model_msg;
    struct protocol_msg msg;
    int at, by_model = 0, by_library = 0, by_each = 0;

    memset(&model, 0, sizeof model);
    memset(&ring, 0, sizeof ring);
    memset(&ring_of_each, 0, sizeof ring_of_each);
    for (at = 0; at < size; at += piece) {
        int bytes = size - at < piece ? size - at : piece;
        model_process(&model, stream + at, bytes);
        while (model_recv(&model, &model_msg) == MODEL_SUCCESS)
            ++by_model;
        dp_process(&ring, stream + at, bytes);
        while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
            ++by_library;
        CHECK_INT(dp_process_each(&ring_of_each, stream + at, bytes, count_each, &by_each), bytes);
    }
    CHECK_INT(by_each, FRAMES);
    CHECK(by_library >= by_model);
    printf("%d bytes at once: dp_process_each keeps all, dp_process %.1f %%, the model %.1f %%\n", piece,
           percent(by_library, FRAMES), percent(by_model, FRAMES));
    return (int)(percent(by_model, FRAMES) + 0.5);
}

int main(void)
{
    make_stream(0, 0, 0, 0);
    compare("no noise");
#if DP_BUFSIZE == 128 && DP_DATA_MAX_SIZE == 32
    /* As the README says. */
    CHECK_INT(kept_of_100(192), 62);
    CHECK_INT(kept_of_100(1024), 11);
#else
    kept_of_100(1024);
#endif
    make_stream(1, 1, 0, 0);
    compare("garbage between frames");
    make_stream(0, 0, 10, 0);
    compare("1 % of the frames damaged");
    make_stream(1, 85, 0, 0);
    compare("garbage, a third of it '$'");
    make_stream(1, 85, 10, 0);
    compare("that, and 1 % of the frames damaged");
    make_stream(0, 0, 0, 10);
    compare("1 % of the bytes lost");
    make_stream(0, 0, 0, 1);
    compare("0.1 % of the bytes lost");
    return check_summary("noise");
}
