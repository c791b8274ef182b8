/*
 * What the drop-in library costs beside the model of the original's algorithm, in one run.
 *
 *     bench               prints for each case: nanoseconds a byte of library and model
 *     bench callgrind     to be run under valgrind --tool=callgrind
 *
 * run.sh does both, of the other programs here too, and makes the table. GOAL is the most instructions that the library
 * may need for a byte of the wire, SIDE is "library" or "model".
 */
#define _POSIX_C_SOURCE 199309L
#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/receiver.h"

#include "../deltarobot/model/model.h"
#include "../common/wire.h"
#include "measure.h"

#include <stdlib.h>

#define STREAM_SIZE 20480
#define CHUNK 64

/* The original needs some thousands of instructions a byte of a hostile stream: a part of it tells enough. */
#define HOSTILE_SIZE 2048

struct stream {
    unsigned char bytes[STREAM_SIZE + WIRE_FRAME_MAX];
    int size;
    int payload; /* of each frame; for the encoder */
};

#define SIDE(name) dp_##name
#define STRUCT(name) struct protocol_##name
#include "loops.h"
#undef SIDE
#undef STRUCT

#define SIDE(name) model_##name
#define STRUCT(name) struct model_##name
#include "loops.h"
#undef SIDE
#undef STRUCT

static int on_msg(const struct protocol_msg *msg, void *usr)
{
    (void)usr;
    taken += msg->opcode;
    return 0;
}

static void each(struct protocol_data *ring, struct stream *stream, int chunk)
{
    int at;
    for (at = 0; at < stream->size; at += chunk)
        dp_process_each(ring, stream->bytes + at, stream->size - at < chunk ? stream->size - at : chunk, on_msg, NULL);
}

static void each_64(struct protocol_data *ring, struct stream *stream)
{
    each(ring, stream, 64);
}

static void each_1024(struct protocol_data *ring, struct stream *stream)
{
    each(ring, stream, 1024);
}

/* The receiver has no model: its state is not the ring's. */
static struct dp_receiver receiver;

static void receiver_bytes(struct protocol_data *ring, struct stream *stream)
{
    static struct protocol_msg msg;
    int at;

    (void)ring;
    for (at = 0; at < stream->size; ++at)
        if (dp_receiver_byte(&receiver, stream->bytes[at]))
            while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
                taken += msg.opcode;
}

static void receiver_each(struct protocol_data *ring, struct stream *stream)
{
    int at;

    (void)ring;
    for (at = 0; at < stream->size; at += CHUNK)
        dp_receiver_each(&receiver, stream->bytes + at, stream->size - at < CHUNK ? stream->size - at : CHUNK, on_msg,
                         NULL);
}

typedef void (*library_loop)(struct protocol_data *ring, struct stream *stream);
typedef void (*model_loop)(struct model_data *ring, struct stream *stream);

static void measure(const char *name, int goal, struct stream *stream, library_loop library, model_loop model)
{
    static struct protocol_data ours;
    static struct model_data theirs;

    dp_init(&ours);
    dp_receiver_init(&receiver);
    memset(&theirs, 0, sizeof theirs);
    MEASURE(name, goal, "library", stream->size, library(&ours, stream));
    if (model != NULL)
        MEASURE(name, goal, "model", stream->size, model(&theirs, stream));
}

static unsigned long seed = 1;

static int random_frame(unsigned char *out, int payload)
{
    static const char opcodes[] = DP_PROTO_ALL_OPCODES;
    unsigned char data[255];
    wire_random_bytes(&seed, data, sizeof data);
    return wire_frame(out, opcodes[wire_random(&seed) % 10], data, payload);
}

static void fill_frames(struct stream *stream, int payload)
{
    stream->payload = payload;
    stream->size = 0;
    while (stream->size < STREAM_SIZE)
        stream->size += random_frame(stream->bytes + stream->size, payload);
}

/* Frames of the lengths that the robot's messages have. */
static int usual_frame(unsigned char *out)
{
    static const int lengths[] = {0, 0, 1, 12, 16};
    return random_frame(out, lengths[wire_random(&seed) % 5]);
}

/* Garbage of up to 20 bytes before each frame; `dollars` of 256 of its bytes are a '$'. */
static void fill_garbage(struct stream *stream, unsigned dollars)
{
    stream->size = 0;
    while (stream->size < STREAM_SIZE) {
        unsigned count = wire_random(&seed) % 20;
        if (stream->size + (int)count >= STREAM_SIZE)
            break;
        for (; count > 0; --count) {
            int dollar = wire_random(&seed) % 256 < dollars;
            stream->bytes[stream->size++] = dollar ? '$' : (unsigned char)wire_random(&seed);
        }
        stream->size += usual_frame(stream->bytes + stream->size);
    }
}

/* One frame in a hundred has a bit flipped or a byte lost. */
static void fill_damaged(struct stream *stream)
{
    stream->size = 0;
    while (stream->size < STREAM_SIZE) {
        unsigned char *frame = stream->bytes + stream->size;
        int size = usual_frame(frame);
        int at = (int)(wire_random(&seed) % (unsigned)size);
        switch (wire_random(&seed) % 200) {
        case 0:
            frame[at] = (unsigned char)(frame[at] ^ 1u << wire_random(&seed) % 8);
            break;
        case 1:
            memmove(frame + at, frame + at + 1, (size_t)(size - at - 1));
            --size;
            break;
        default:
            break;
        }
        stream->size += size;
    }
}

static void fill_pattern(struct stream *stream, const char *pattern, int size)
{
    int i;
    for (i = 0; i < STREAM_SIZE; ++i)
        stream->bytes[i] = (unsigned char)pattern[i % size];
    stream->size = HOSTILE_SIZE;
}

static void payload_cases(void)
{
    static const int payloads[] = {0, 1, 12, 16, 32};
    static struct stream stream;
    char name[50];
    int i;

    for (i = 0; i < 5 && payloads[i] <= DP_DATA_MAX_SIZE; ++i) {
        int payload = payloads[i];
        fill_frames(&stream, payload);
        sprintf(name, "encode:%d", payload);
        measure(name, 9, &stream, dp_encode, model_encode);
        sprintf(name, "bytes:%d", payload);
        measure(name, 103, &stream, dp_bytes, model_bytes);
        sprintf(name, "chunks:%d", payload);
        measure(name, 33, &stream, dp_chunks, model_chunks);
        sprintf(name, "each-64:%d", payload);
        measure(name, 33, &stream, each_64, NULL);
        sprintf(name, "each-1024:%d", payload);
        measure(name, 32, &stream, each_1024, NULL);
        sprintf(name, "receiver:%d", payload);
        measure(name, payload < 12 ? 47 : 25, &stream, receiver_bytes, NULL);
        sprintf(name, "receiver-each-64:%d", payload);
        measure(name, payload < 12 ? 22 : 9, &stream, receiver_each, NULL);
    }
}

static void stream_cases(const char *what, struct stream *stream)
{
    char name[50];
    sprintf(name, "bytes:%s", what);
    measure(name, 120, stream, dp_bytes, model_bytes);
    sprintf(name, "chunks:%s", what);
    measure(name, 40, stream, dp_chunks, model_chunks);
    sprintf(name, "each-64:%s", what);
    measure(name, 49, stream, each_64, NULL);
    sprintf(name, "receiver:%s", what);
    measure(name, 65, stream, receiver_bytes, NULL);
    sprintf(name, "receiver-each-64:%s", what);
    measure(name, 69, stream, receiver_each, NULL);
}

/* A ring full of the pattern, one dp_recv: a byte here is one of the ring. */
static void full_ring_case(const char *what, struct stream *stream)
{
    char name[50];
    sprintf(name, "full-ring:%s", what);
    stream->size = DP_BUFSIZE;
    measure(name, 32, stream, dp_full_ring, model_full_ring);
}

static void hostile_cases(void)
{
    /*
     * "$M<length>:" over and over, of length 3, 7, 11...: each '$' begins a whole candidate, of which only the checksum
     * is wrong. In a stream the longest ones cost most, in a full ring those that are half as long as it; byte by byte
     * three that the same byte completes.
     */
    char longest[] = "$M?:", half[] = "$M?:", three[] = "$M\3:$M?:$M?:";
    struct {
        const char *what, *pattern;
        int size;
    } patterns[] = {
        {"$", "$", 1},       {"$M", "$M", 2},     {"$A$A", "$A$A", 4}, {"$M\\x20", "$M\x20", 3},
        {"$M\\0", "$M\0", 3}, {"$M:", "$M:", 3},   {"zero", "", 1},     {"$M<longest>:", longest, 4},
        {"$M<half>:", half, 4}, {"three-at-once", three, 12},
    };
    static struct stream stream;
    size_t i;

    longest[2] = (char)(DP_DATA_MAX_SIZE < 3 ? DP_DATA_MAX_SIZE : (DP_DATA_MAX_SIZE - 3) / 4 * 4 + 3);
    half[2] = DP_DATA_MAX_SIZE < DP_BUFSIZE / 2 ? longest[2] : (char)((DP_BUFSIZE / 2 - 3) / 4 * 4 + 3);
    three[6] = longest[2] > 8 ? longest[2] - 8 : longest[2];
    three[10] = longest[2];
    for (i = 0; i < sizeof patterns / sizeof *patterns; ++i) {
        if (patterns[i].pattern == half && half[2] == longest[2])
            continue;
        fill_pattern(&stream, patterns[i].pattern, patterns[i].size);
        stream_cases(patterns[i].what, &stream);
        full_ring_case(patterns[i].what, &stream);
    }
    wire_random_bytes(&seed, stream.bytes, STREAM_SIZE);
    stream.size = HOSTILE_SIZE;
    stream_cases("random", &stream);
    full_ring_case("random", &stream);
}

int main(int argc, char **argv)
{
    static struct stream stream;

    use_callgrind = argc > 1 && strcmp(argv[1], "callgrind") == 0;
    payload_cases();
    fill_garbage(&stream, 1);
    stream_cases("garbage", &stream);
    fill_garbage(&stream, 85);
    stream_cases("garbage-of-$", &stream);
    fill_damaged(&stream);
    stream_cases("1%-damaged", &stream);
    hostile_cases();
    return 0;
}
