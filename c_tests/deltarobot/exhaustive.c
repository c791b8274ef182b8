/*
 * exhaustive [LENGTH]: every stream of up to that many bytes (7, or 9 in a minute or two) that is made of what matters:
 * '$', two opcodes, 0 to 3, ':', and the checksum that fits. After each byte, ring and receiver have to have delivered
 * what the grammar says, applied naively to the whole stream; shorter streams are fed in pieces too, fetched late, and
 * given up by idle. For a library of the smallest sizes: each byte of a stream is one at which something may happen.
 */
#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/receiver.h"

#include "check.h"

#include <stdlib.h>

#define LONGEST 9

/* Streams of up to so many bytes are cut in two everywhere, and of up to so many into pieces in all ways. */
#define CUT_IN_TWO 6
#define CUT_IN_ALL_WAYS 5

struct message {
    unsigned char opcode, length, payload[2];
};

/* What came out of a stream: at most a frame in five bytes. */
struct result {
    int count;
    struct message messages[2];
};

static unsigned char stream[LONGEST];
static unsigned long streams;

static void add(struct result *result, int opcode, int length, const void *payload)
{
    struct message *message = &result->messages[result->count];

    if (!CHECK(result->count < 2 && length <= 2))
        return;
    memset(message, 0, sizeof *message);
    message->opcode = (unsigned char)opcode;
    message->length = (unsigned char)length;
    memcpy(message->payload, payload, (size_t)length);
    ++result->count;
}

static void add_msg(struct result *result, const struct protocol_msg *msg)
{
    CHECK(msg->checksum_ok == 1);
    add(result, msg->opcode, msg->data_s, msg->data);
}

/* The grammar: 1 when the bytes begin with a frame, 0 when they do not, -1 when more of them are needed to tell. */
static int is_frame(const unsigned char *bytes, int count)
{
    unsigned sum = 0;
    int i, size;

    if (count == 0)
        return -1;
    if (bytes[0] != '$')
        return 0;
    if (count == 1)
        return -1;
    if (bytes[1] == 0 || strchr(DP_PROTO_ALL_OPCODES, bytes[1]) == NULL)
        return 0;
    if (count == 2)
        return -1;
    if (bytes[2] > DP_DATA_MAX_SIZE)
        return 0;
    size = bytes[2] + 5;
    if (count < size)
        return -1;
    for (i = 0; i < size; ++i)
        if (i != size - 2)
            sum += bytes[i];
    return bytes[size - 1] == ':' && bytes[size - 2] == (sum & 0xFF);
}

/* What a whole stream means. Gives where what may become a frame begins. */
static int naively(const unsigned char *bytes, int count, int idle, struct result *result)
{
    int at = 0;

    result->count = 0;
    while (at < count) {
        int frame = is_frame(bytes + at, count - at);

        if (frame < 0 && !idle)
            break;
        if (frame > 0) {
            add(result, bytes[at + 1], bytes[at + 2], bytes + at + 3);
            at += bytes[at + 2] + 5;
        } else {
            ++at;
        }
    }
    return at;
}

static int same(const struct result *result, const struct result *expected)
{
    return result->count == expected->count &&
           memcmp(result->messages, expected->messages, (size_t)expected->count * sizeof *expected->messages) == 0;
}

static void compare(const struct result *result, const struct result *expected, const char *what, int length)
{
    ++check_count;
    if (!same(result, expected) && check_fails()) {
        fprintf(stderr, "%s: %d messages, not %d\n", what, result->count, expected->count);
        check_dump("stream", stream, (size_t)length);
    }
}

static int collect(const struct protocol_msg *msg, void *usr)
{
    add_msg(usr, msg);
    return 0;
}

static void from_ring(struct protocol_data *ring, int idle, struct result *result)
{
    struct protocol_msg msg;

    while ((idle ? dp_recv_idle(ring, &msg) : dp_recv(ring, &msg)) == DP_RC_SUCCESS)
        add_msg(result, &msg);
}

static void from_receiver(struct dp_receiver *receiver, int idle, struct result *result)
{
    struct protocol_msg msg;

    while ((idle ? dp_receiver_idle(receiver, &msg) : dp_receiver_next(receiver, &msg)) == DP_RC_SUCCESS)
        add_msg(result, &msg);
}

/* The end of the piece that begins there: pieces end behind the bytes whose bits are set in `cuts`. */
static int end_of_piece(int from, int length, unsigned long cuts)
{
    int to = from + 1;

    while (to < length && !(cuts >> (to - 1) & 1))
        ++to;
    return to;
}

/* Feeds a stream in pieces, from each place in the ring on, and to a receiver from which nothing is fetched before it
 * is full or the stream is over; then gives up the rest. */
static void in_pieces(int length, unsigned long cuts)
{
    struct protocol_data ring;
    struct dp_receiver receiver;
    struct result expected, given_up, of_ring = {0}, of_receiver = {0};
    int from, to;

    memset(&ring, 0, sizeof ring);
    memset(&receiver, 0, sizeof receiver);
    ring.m_idx = (int)(streams % DP_BUFSIZE);
    for (from = 0; from < length; from = to) {
        to = end_of_piece(from, length, cuts);
        if (to - from > DP_BUFSIZE - ring.m_sz)
            to = from + 1;
        CHECK_INT(dp_process(&ring, stream + from, to - from), DP_RC_SUCCESS);
        from_ring(&ring, 0, &of_ring);
    }
    for (from = 0; from < length; ++from)
        if (dp_receiver_byte(&receiver, stream[from]) < 0) {
            from_receiver(&receiver, 0, &of_receiver);
            CHECK(dp_receiver_byte(&receiver, stream[from]) >= 0);
        }
    from_receiver(&receiver, 0, &of_receiver);
    naively(stream, length, 0, &expected);
    compare(&of_ring, &expected, "dp_process in pieces", length);
    compare(&of_receiver, &expected, "dp_receiver_next, late", length);
    naively(stream, length, 1, &given_up);
    from_ring(&ring, 1, &of_ring);
    from_receiver(&receiver, 1, &of_receiver);
    compare(&of_ring, &given_up, "dp_recv_idle", length);
    compare(&of_receiver, &given_up, "dp_receiver_idle", length);
}

/* The same by the functions that take any number of bytes. */
static void by_each(int length, unsigned long cuts)
{
    struct protocol_data ring;
    struct dp_receiver receiver;
    struct result expected, of_ring = {0}, of_receiver = {0};
    int from, to;

    memset(&ring, 0, sizeof ring);
    memset(&receiver, 0, sizeof receiver);
    for (from = 0; from < length; from = to) {
        to = end_of_piece(from, length, cuts);
        CHECK_INT(dp_process_each(&ring, stream + from, to - from, collect, &of_ring), to - from);
        CHECK_INT(dp_receiver_each(&receiver, stream + from, to - from, collect, &of_receiver), to - from);
        naively(stream, to, 0, &expected);
        compare(&of_ring, &expected, "dp_process_each", to);
        compare(&of_receiver, &expected, "dp_receiver_each", to);
    }
    naively(stream, length, 1, &expected);
    from_ring(&ring, 1, &of_ring);
    from_receiver(&receiver, 1, &of_receiver);
    compare(&of_ring, &expected, "dp_process_each, then idle", length);
    compare(&of_receiver, &expected, "dp_receiver_each, then idle", length);
}

struct state {
    struct protocol_data ring;
    struct dp_receiver receiver;
    struct result of_ring, of_receiver;
};

static void extend(const struct state *before, int length, int longest);

static void append(const struct state *before, int length, int longest, int byte)
{
    struct state state = *before;
    struct result expected;
    int waiting;

    stream[length++] = (unsigned char)byte;
    ++streams;
    dp_process(&state.ring, stream + length - 1, 1);
    from_ring(&state.ring, 0, &state.of_ring);
    if (dp_receiver_byte(&state.receiver, stream[length - 1]))
        from_receiver(&state.receiver, 0, &state.of_receiver);
    waiting = length - naively(stream, length, 0, &expected);
    compare(&state.of_ring, &expected, "dp_recv", length);
    compare(&state.of_receiver, &expected, "dp_receiver_next", length);
    CHECK_INT(state.ring.m_sz, waiting);
    if (length <= CUT_IN_ALL_WAYS) {
        unsigned long cuts;

        for (cuts = 0; cuts < 1ul << (length - 1); ++cuts) {
            in_pieces(length, cuts);
            by_each(length, cuts);
        }
    } else if (length <= CUT_IN_TWO) {
        int at;

        for (at = 0; at < length; ++at) {
            in_pieces(length, 1ul << at);
            by_each(length, 1ul << at);
        }
    }
    if (length < longest)
        extend(&state, length, longest);
}

/* Appends each byte that may mean something. */
static void extend(const struct state *before, int length, int longest)
{
    static const unsigned char alphabet[] = {'$', 'A', 'm', 0, 1, 2, 3, ':'};
    struct result result;
    int start = naively(stream, length, 0, &result), i;
    unsigned sum = ':';

    for (i = 0; i < (int)sizeof alphabet; ++i)
        append(before, length, longest, alphabet[i]);
    /* The checksum of the frame that may stand there, as far as it has come. */
    if (length - start >= 3) {
        for (i = start; i < length; ++i)
            sum += stream[i];
        append(before, length, longest, (int)(sum & 0xFF));
    }
}

int main(int argc, char **argv)
{
    static const struct state empty;
    int longest = argc > 1 ? atoi(argv[1]) : 7;

    if (!CHECK(1 <= longest && longest <= LONGEST))
        return check_summary("exhaustive");
    extend(&empty, 0, longest);
    printf("exhaustive: %lu streams of up to %d bytes\n", streams, longest);
    return check_summary("exhaustive");
}
