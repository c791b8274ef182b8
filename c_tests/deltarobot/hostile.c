/* Input nobody should give: the library answers, touches nothing it was not given, and works afterwards. */
#include "libdeltarobot/protocol.h"

#include "check.h"
#include "wire.h"

#include <limits.h>
#include <stdlib.h>

#define GUARD 64
#define GUARD_BYTE 0x5A
#define ROUNDS 2000

/* The structs under test with bytes around them that nobody may touch. */
struct guarded {
    unsigned char before[GUARD];
    struct protocol_data ring;
    unsigned char between[GUARD];
    struct protocol_msg message;
    unsigned char after[GUARD];
};

static struct guarded at;
static unsigned long seed = 0x2545F491;

static void fill(unsigned char byte)
{
    memset(&at, byte, sizeof at);
    memset(at.before, GUARD_BYTE, GUARD);
    memset(at.between, GUARD_BYTE, GUARD);
    memset(at.after, GUARD_BYTE, GUARD);
}

static int guards_hold(void)
{
    int i;
    for (i = 0; i < GUARD; ++i)
        if (at.before[i] != GUARD_BYTE || at.between[i] != GUARD_BYTE || at.after[i] != GUARD_BYTE)
            return 0;
    return 1;
}

static int ring_in_range(void)
{
    return at.ring.m_idx >= 0 && at.ring.m_idx < DP_BUFSIZE && at.ring.m_sz >= 0 && at.ring.m_sz <= DP_BUFSIZE;
}

/* dp_recv, with what it promises about the message whatever happens. */
static int recv_checked(void)
{
    struct protocol_msg before;
    int rc;

    memset(&at.message, 0xC3, sizeof at.message);
    memcpy(&before, &at.message, sizeof before);
    rc = dp_recv(&at.ring, &at.message);
    if (rc == DP_RC_SUCCESS) {
        CHECK(at.message.data_s >= 0 && at.message.data_s <= DP_DATA_MAX_SIZE);
        CHECK_INT(at.message.checksum_ok, 1);
        CHECK(at.message.opcode != 0 && strchr(DP_PROTO_ALL_OPCODES, at.message.opcode) != NULL);
        CHECK_BYTES(at.message.data + at.message.data_s, before.data + at.message.data_s,
                    DP_DATA_MAX_SIZE - at.message.data_s);
    } else {
        CHECK(rc == DP_RC_NO_FRAME || rc == DP_RC_GARBAGE);
        before.opcode = 0xFF;
        CHECK_BYTES(&at.message, &before, sizeof before);
    }
    CHECK(guards_hold());
    CHECK(ring_in_range());
    return rc;
}

/* The ring is of use again: whatever it holds, enough zeros end it, and a frame behind them arrives. */
static void works_again(void)
{
    unsigned char bytes[WIRE_FRAME_MAX];
    int guard = DP_BUFSIZE + 1;
    int i, length;

    for (i = 0; i < DP_DATA_MAX_SIZE + WIRE_OVERHEAD; ++i) {
        bytes[0] = 0;
        dp_process(&at.ring, bytes, 1);
        while (guard-- > 0 && recv_checked() == DP_RC_SUCCESS)
            continue;
    }
    CHECK_INT(at.ring.m_sz, 0);
    length = wire_frame(bytes, DP_OPCODE_STATUS, "", 0);
    CHECK_INT(dp_process(&at.ring, bytes, length), DP_RC_SUCCESS);
    CHECK_INT(recv_checked(), DP_RC_SUCCESS);
    CHECK_INT(at.message.opcode, DP_OPCODE_STATUS);
    CHECK_INT(at.message.data_s, 0);
    CHECK_INT(recv_checked(), DP_RC_NO_FRAME);
}

struct sent {
    int calls, bytes;
    unsigned char frame[DP_DATA_MAX_SIZE + WIRE_OVERHEAD];
};

static int take(void *buf, int bytes, void *usr)
{
    struct sent *sent = usr;
    ++sent->calls;
    sent->bytes = bytes;
    if (bytes >= 0 && bytes <= (int)sizeof sent->frame)
        memcpy(sent->frame, buf, (size_t)bytes);
    return -77;
}

static int take_without_usr(void *buf, int bytes, void *usr)
{
    (void)buf;
    CHECK(usr == NULL);
    return bytes;
}

static void null_pointers(void)
{
    struct guarded before;
    unsigned char bytes[4] = {'$', 'S', 0, 0};

    fill(0);
    memcpy(&before, &at, sizeof before);
    CHECK_INT(dp_process(NULL, bytes, 4), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(NULL, NULL, 4), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(NULL, NULL, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(NULL, NULL, -1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(&at.ring, NULL, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(&at.ring, NULL, INT_MAX), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(&at.ring, NULL, -1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(&at.ring, NULL, 0), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_recv(&at.ring, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(NULL, NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(NULL, take, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(&at.message, NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_BYTES(&at, &before, sizeof at);
    CHECK_INT(dp_recv(NULL, &at.message), DP_RC_ERROR_GENERIC);
    before.message.opcode = 0xFF;
    CHECK_BYTES(&at, &before, sizeof at);
    /* usr belongs to the caller: NULL is as good as any. */
    CHECK_INT(dp_send(&at.message, take_without_usr, NULL), WIRE_OVERHEAD);
}

/* A message is not taken from a ring when there is nowhere to put it. */
static void null_message_loses_nothing(void)
{
    unsigned char bytes[WIRE_FRAME_MAX];
    int length = wire_frame(bytes, DP_OPCODE_HOMING, "", 0);

    fill(0);
    CHECK_INT(dp_process(&at.ring, bytes, length), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&at.ring, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(recv_checked(), DP_RC_SUCCESS);
    CHECK_INT(at.message.opcode, DP_OPCODE_HOMING);
}

static void process_sizes(void)
{
    static const int NEGATIVE[] = {-1, -2, -127, -128, -DP_BUFSIZE, -32768, INT_MIN + 1, INT_MIN};
    struct guarded before;
    /* Just what may be read: a sanitizer sees a byte more. */
    unsigned char *exact = malloc(DP_BUFSIZE);
    size_t i;

    fill(0);
    memset(exact, 'x', DP_BUFSIZE);
    memcpy(&before, &at, sizeof before);
    for (i = 0; i < sizeof NEGATIVE / sizeof *NEGATIVE; ++i)
        CHECK_INT(dp_process(&at.ring, exact, NEGATIVE[i]), DP_RC_ERROR_GENERIC);
    CHECK_BYTES(&at, &before, sizeof at);
    CHECK_INT(dp_process(&at.ring, exact, DP_BUFSIZE), DP_RC_SUCCESS);
    CHECK_INT(dp_process(&at.ring, exact, DP_BUFSIZE + 1), DP_RC_OVERFLOW);
    CHECK_INT(dp_process(&at.ring, exact, INT_MAX), DP_RC_OVERFLOW);
    CHECK_INT(at.ring.m_sz, DP_BUFSIZE);
    CHECK_BYTES(at.ring.m_buf, exact, DP_BUFSIZE);
    CHECK(guards_hold());
    CHECK_INT(recv_checked(), DP_RC_GARBAGE);
    works_again();
    free(exact);
}

static void uninitialised_structs(void)
{
    static const unsigned char PATTERNS[] = {0x00, 0x01, 0x24, 0x7F, 0x80, 0xAA, 0xFF};
    size_t i;
    int round;

    for (i = 0; i < sizeof PATTERNS; ++i) {
        fill(PATTERNS[i]);
        recv_checked();
        works_again();
        fill(PATTERNS[i]);
        works_again();
    }
    for (round = 0; round < ROUNDS; ++round) {
        fill(0);
        wire_random_bytes(&seed, &at.ring, sizeof at.ring);
        if (round & 1)
            at.ring.m_idx = (int)(wire_random(&seed) % DP_BUFSIZE);
        if (round & 2)
            at.ring.m_sz = (int)(wire_random(&seed) % (DP_BUFSIZE + 1));
        if (round & 4)
            recv_checked();
        works_again();
    }
}

static void ring_fields_out_of_range(void)
{
    static const int VALUES[] = {INT_MIN, INT_MIN + 1, -32769, -DP_BUFSIZE, -2, -1, 0, 1, DP_BUFSIZE - 1,
                                 DP_BUFSIZE, DP_BUFSIZE + 1, 65536, INT_MAX - DP_BUFSIZE, INT_MAX - 1, INT_MAX};
    const int count = (int)(sizeof VALUES / sizeof *VALUES);
    int i, j;

    for (i = 0; i < count; ++i)
        for (j = 0; j < count; ++j) {
            int in_range = VALUES[i] >= 0 && VALUES[i] < DP_BUFSIZE && VALUES[j] >= 0 && VALUES[j] <= DP_BUFSIZE;
            fill(0);
            at.ring.m_idx = VALUES[i];
            at.ring.m_sz = VALUES[j];
            if (in_range) {
                CHECK_INT(recv_checked(), VALUES[j] ? DP_RC_GARBAGE : DP_RC_NO_FRAME);
            } else {
                CHECK_INT(recv_checked(), DP_RC_NO_FRAME);
                CHECK_INT(at.ring.m_sz, 0);
            }
            at.ring.m_idx = VALUES[i];
            at.ring.m_sz = VALUES[j];
            if (!in_range) {
                CHECK_INT(dp_process(&at.ring, (void *)"x", 1), DP_RC_SUCCESS);
                CHECK_INT(at.ring.m_sz, 1);
            }
            CHECK(guards_hold());
            works_again();
        }
}

/* Every length byte in front of that many bytes: delivered when it fits a message, passed over when not. */
static void every_length_on_the_wire(void)
{
    unsigned char payload[255], bytes[WIRE_FRAME_MAX];
    int size, i;

    for (i = 0; i < 255; ++i)
        payload[i] = (unsigned char)(128 + i % 100);
    for (size = 0; size <= 255; ++size) {
        int length = wire_frame(bytes, DP_OPCODE_MOVE, payload, size);
        int delivered = 0;

        fill(0);
        for (i = 0; i < length; ++i) {
            CHECK_INT(dp_process(&at.ring, bytes + i, 1), DP_RC_SUCCESS);
            if (recv_checked() == DP_RC_SUCCESS) {
                ++delivered;
                CHECK_INT(i, length - 1);
                CHECK_INT(at.message.opcode, DP_OPCODE_MOVE);
                if (CHECK_INT(at.message.data_s, size))
                    CHECK_BYTES(at.message.data, payload, size);
            }
        }
        CHECK_INT(delivered, size <= DP_DATA_MAX_SIZE);
        works_again();
    }
}

static void every_length_to_send(void)
{
    static const int FAR[] = {INT_MIN, INT_MIN + 1, -65536, 65536, 65536 + 1, INT_MAX - 4, INT_MAX};
    unsigned char expected[WIRE_FRAME_MAX];
    struct sent sent;
    size_t i;
    int size;

    fill(0);
    at.message.opcode = DP_OPCODE_NACK;
    wire_random_bytes(&seed, at.message.data, DP_DATA_MAX_SIZE);
    for (size = -300; size <= 600; ++size) {
        memset(&sent, 0, sizeof sent);
        at.message.data_s = size;
        if (size >= 0 && size <= DP_DATA_MAX_SIZE) {
            CHECK_INT(dp_send(&at.message, take, &sent), -77);
            CHECK_INT(sent.calls, 1);
            if (CHECK_INT(sent.bytes, wire_frame(expected, DP_OPCODE_NACK, at.message.data, size)))
                CHECK_BYTES(sent.frame, expected, sent.bytes);
        } else {
            CHECK_INT(dp_send(&at.message, take, &sent), DP_RC_ERROR_GENERIC);
            CHECK_INT(sent.calls, 0);
        }
        CHECK_INT(at.message.data_s, size);
    }
    memset(&sent, 0, sizeof sent);
    for (i = 0; i < sizeof FAR / sizeof *FAR; ++i) {
        at.message.data_s = FAR[i];
        CHECK_INT(dp_send(&at.message, take, &sent), DP_RC_ERROR_GENERIC);
    }
    CHECK_INT(sent.calls, 0);
    CHECK(guards_hold());
}

static void every_opcode_to_send(void)
{
    unsigned char expected[WIRE_FRAME_MAX];
    struct sent sent;
    int opcode;

    fill(0);
    memset(&sent, 0, sizeof sent);
    for (opcode = 0; opcode < 256; ++opcode) {
        at.message.opcode = (unsigned char)opcode;
        CHECK_INT(dp_send(&at.message, take, &sent), -77);
        CHECK_INT(sent.bytes, wire_frame(expected, opcode, "", 0));
        CHECK_BYTES(sent.frame, expected, WIRE_OVERHEAD);
    }
}

static void random_traffic(void)
{
    static const unsigned char LIKELY[] = "$$$$::ANHSMChsme\0\1\2\3\4";
    unsigned char bytes[2 * DP_BUFSIZE];
    int round, i;

    fill(0);
    for (round = 0; round < 10 * ROUNDS; ++round) {
        int count = (int)(wire_random(&seed) % sizeof bytes);
        for (i = 0; i < count; ++i) {
            unsigned pick = wire_random(&seed);
            bytes[i] = pick & 0x100 ? LIKELY[pick % sizeof LIKELY] : (unsigned char)pick;
        }
        dp_process(&at.ring, bytes, count);
        CHECK(ring_in_range());
        for (i = 0; i < round % 4; ++i)
            recv_checked();
    }
    works_again();
}

int main(void)
{
    null_pointers();
    null_message_loses_nothing();
    process_sizes();
    uninitialised_structs();
    ring_fields_out_of_range();
    every_length_on_the_wire();
    every_length_to_send();
    every_opcode_to_send();
    random_traffic();
    return check_summary("hostile");
}
