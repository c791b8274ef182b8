/* Where the library is deliberately better than the reference: a function for each difference the README lists. */
#define _POSIX_C_SOURCE 200809L
#include "libdeltarobot/protocol.h"

#include "check.h"
#include "wire.h"

#include <limits.h>
#include <unistd.h>

static struct protocol_data ring;
static struct protocol_msg message;

static void start(void)
{
    memset(&ring, 0, sizeof ring);
    memset(&message, 0, sizeof message);
}

static int feed(const void *bytes, int count)
{
    return dp_process(&ring, (void *)bytes, count);
}

/* Feeds byte by byte, reading after each: tells what was delivered, in order, and how often GARBAGE was answered. */
static void feed_reading(const unsigned char *bytes, int count, char *opcodes, int *garbage)
{
    int i, rc;
    *garbage = 0;
    for (i = 0; i < count; ++i) {
        CHECK_INT(feed(bytes + i, 1), DP_RC_SUCCESS);
        rc = dp_recv(&ring, &message);
        if (rc == DP_RC_SUCCESS)
            *opcodes++ = (char)message.opcode;
        if (rc == DP_RC_GARBAGE)
            ++*garbage;
    }
    *opcodes = '\0';
}

/*
 * A good frame right behind a false start, and one inside: `head` is what comes before an H. Enough bytes follow for
 * any false start to end in this build's sizes.
 */
static void found_behind(const void *head, int head_length)
{
    unsigned char bytes[32 + WIRE_FRAME_MAX];
    char opcodes[32];
    int garbage, length;

    memcpy(bytes, head, (size_t)head_length);
    length = head_length + wire_frame(bytes + head_length, DP_OPCODE_HOMING, "", 0);
    memset(bytes + length, 'z', DP_DATA_MAX_SIZE + WIRE_OVERHEAD);
    length += DP_DATA_MAX_SIZE + WIRE_OVERHEAD;
    start();
    feed_reading(bytes, length, opcodes, &garbage);
    if (!CHECK(strcmp(opcodes, "H") == 0))
        check_dump("of", bytes, (size_t)length);
    CHECK_INT(ring.m_sz, 0);
    if (length > DP_BUFSIZE)
        return;
    start();
    CHECK_INT(feed(bytes, length), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_HOMING);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_GARBAGE);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
}

static void frame_at_a_false_start_is_found(void)
{
    found_behind("$", 1);           /* bad opcode: the good frame's starter */
    found_behind("$$$", 3);         /* several of them */
    found_behind("$H", 2);          /* bad length: the starter again, or an inner frame */
    found_behind("$M\1", 3);        /* bad checksum, with the frame in its payload */
    found_behind("$M\0", 3);        /* bad checksum: the good frame's starter */
    found_behind("$S\0\xB1", 4);    /* bad terminator: the good frame's starter */
    found_behind("$S\0\xB1$", 5);   /* and one more */
    found_behind("x$y$H\0\0:$z", 10);
}

static void garbage_is_consumed_and_told_once(void)
{
    static const char BAD_CHECKSUM[] = {'$', 'H', 0, 0, ':'};

    start();
    CHECK_INT(feed("xyz", 3), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_GARBAGE);
    CHECK_INT(message.opcode, 0xFF);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);

    start();
    CHECK_INT(feed(BAD_CHECKSUM, 5), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_GARBAGE);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);

    /* What may become a frame stays. */
    start();
    CHECK_INT(feed("xyz$S", 5), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_GARBAGE);
    CHECK_INT(ring.m_sz, 2);
    CHECK_INT(ring.m_idx, 3);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
    CHECK_INT(feed("\0\xB1:", 3), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_STATUS);

    /* Garbage in front of a whole frame is not worth a call of its own. */
    start();
    CHECK_INT(feed("x$S\0\xB1:", 6), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
}

static void without_a_frame_only_the_opcode_is_set(void)
{
    static const struct {
        const char *bytes;
        int count, result;
    } INPUTS[] = {{"", 0, DP_RC_NO_FRAME}, {"$M\1a", 4, DP_RC_NO_FRAME}, {"$H\0\0:", 5, DP_RC_GARBAGE}};
    struct protocol_msg expected;
    int i;

    memset(&expected, 0x77, sizeof expected);
    expected.opcode = 0xFF;
    for (i = 0; i < 3; ++i) {
        start();
        memset(&message, 0x77, sizeof message);
        CHECK_INT(feed(INPUTS[i].bytes, INPUTS[i].count), DP_RC_SUCCESS);
        CHECK_INT(dp_recv(&ring, &message), INPUTS[i].result);
        CHECK_BYTES(&message, &expected, sizeof message);
    }
}

static void too_long_is_rejected_at_the_length_byte(void)
{
    unsigned char bytes[32];
    int size, length;

    for (size = DP_DATA_MAX_SIZE + 1; size <= 255; ++size) {
        int kept = size == '$'; /* a starter itself */
        bytes[0] = '$';
        bytes[1] = DP_OPCODE_MOVE;
        bytes[2] = (unsigned char)size;
        start();
        memset(&message, 0x77, sizeof message);
        CHECK_INT(feed(bytes, 2), DP_RC_SUCCESS);
        CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
        CHECK_INT(feed(bytes + 2, 1), DP_RC_SUCCESS);
        CHECK_INT(dp_recv(&ring, &message), DP_RC_GARBAGE);
        CHECK_INT(ring.m_sz, kept);
        CHECK_INT(message.data_s, 0x77777777);
        length = wire_frame(bytes, DP_OPCODE_CANCEL, "", 0);
        CHECK_INT(feed(bytes, length), DP_RC_SUCCESS);
        CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
        CHECK_INT(message.opcode, DP_OPCODE_CANCEL);
    }
}

static int must_not_be_called(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)bytes;
    (void)usr;
    CHECK(!"the callback was called");
    return DP_RC_SUCCESS;
}

static void bad_data_s_is_not_sent(void)
{
    static const int SIZES[] = {INT_MIN, -256, -1, DP_DATA_MAX_SIZE + 1, 256, 256 + 1, INT_MAX};
    size_t i;

    start();
    message.opcode = DP_OPCODE_MOVE;
    for (i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
        message.data_s = SIZES[i];
        CHECK_INT(dp_send(&message, must_not_be_called, NULL), DP_RC_ERROR_GENERIC);
    }
}

static void uninitialised_ring_is_healed(void)
{
    static const int FIELDS[][2] = {{-1, 0},      {DP_BUFSIZE, 0}, {INT_MIN, INT_MIN}, {INT_MAX, INT_MAX},
                                    {0, -1},      {0, INT_MIN},    {0, DP_BUFSIZE + 1}, {0, INT_MAX},
                                    {-1, -1},     {-1, 3},         {DP_BUFSIZE, DP_BUFSIZE}};
    size_t i;

    for (i = 0; i < sizeof FIELDS / sizeof *FIELDS; ++i) {
        start();
        ring.m_idx = FIELDS[i][0];
        ring.m_sz = FIELDS[i][1];
        CHECK_INT(feed("$S\0\xB1:", 5), DP_RC_SUCCESS);
        CHECK_INT(ring.m_sz, 5);
        CHECK(ring.m_idx >= 0 && ring.m_idx < DP_BUFSIZE);
        CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);

        ring.m_idx = FIELDS[i][0];
        ring.m_sz = FIELDS[i][1];
        CHECK_INT(dp_recv(&ring, &message), DP_RC_NO_FRAME);
        CHECK_INT(ring.m_sz, 0);
        CHECK(ring.m_idx >= 0 && ring.m_idx < DP_BUFSIZE);
    }
}

static void null_and_negative_are_refused(void)
{
    start();
    CHECK_INT(dp_process(NULL, &message, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_process(&ring, NULL, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(feed("x", -1), DP_RC_ERROR_GENERIC);
    CHECK_INT(feed("x", INT_MIN), DP_RC_ERROR_GENERIC);
    CHECK_INT(ring.m_sz, 0);
    CHECK_INT(dp_recv(NULL, &message), DP_RC_ERROR_GENERIC);
    CHECK_INT(message.opcode, 0xFF);
    CHECK_INT(dp_recv(&ring, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(NULL, must_not_be_called, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(&message, NULL, NULL), DP_RC_ERROR_GENERIC);
}

static int answer_within(void *buf, int bytes, void *usr)
{
    int *depth = usr;
    if (++*depth == 2)
        return dp_process(&ring, buf, bytes);
    CHECK_INT(dp_process(&ring, buf, bytes), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_HOMING);
    message.opcode = DP_OPCODE_HOMING_REPL;
    return dp_send(&message, answer_within, usr);
}

static void callback_may_call_again(void)
{
    int depth = 0;

    start();
    message.opcode = DP_OPCODE_HOMING;
    CHECK_INT(dp_send(&message, answer_within, &depth), DP_RC_SUCCESS);
    CHECK_INT(depth, 2);
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_HOMING_REPL);
}

static int take(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)usr;
    return bytes;
}

static void exercise(void)
{
    unsigned char bytes[DP_BUFSIZE + 1];
    unsigned long seed = 7;

    wire_random_bytes(&seed, bytes, sizeof bytes);
    start();
    feed("x$S\0\xB1:", 6);
    dp_recv(&ring, &message);
    dp_recv(&ring, &message);
    feed(bytes, (int)sizeof bytes);
    dp_recv(&ring, &message);
    message.data_s = 0;
    dp_send(&message, take, NULL);
    dp_send(NULL, NULL, NULL);
}

/* The library runs with both streams turned into a pipe that has to stay empty. */
static void nothing_is_printed(void)
{
    int ends[2], kept_out, kept_err;
    ssize_t printed;
    char bytes[64];

    fflush(stdout);
    fflush(stderr);
    if (!CHECK(pipe(ends) == 0))
        return;
    kept_out = dup(STDOUT_FILENO);
    kept_err = dup(STDERR_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    exercise();
    fflush(stdout);
    fflush(stderr);
    dup2(kept_out, STDOUT_FILENO);
    dup2(kept_err, STDERR_FILENO);
    close(kept_out);
    close(kept_err);
    close(ends[1]);
    printed = read(ends[0], bytes, sizeof bytes);
    close(ends[0]);
    CHECK_INT(printed, 0);
}

int main(void)
{
    frame_at_a_false_start_is_found();
    garbage_is_consumed_and_told_once();
    without_a_frame_only_the_opcode_is_set();
    too_long_is_rejected_at_the_length_byte();
    bad_data_s_is_not_sent();
    uninitialised_ring_is_healed();
    null_and_negative_are_refused();
    callback_may_call_again();
    nothing_is_printed();
    return check_summary("better");
}
