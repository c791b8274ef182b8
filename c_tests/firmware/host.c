/*
 * Talks to firmware that runs in an emulator, through the emulated UART: host ROLE [ROUNDS] -- COMMAND...
 *
 * COMMAND is the emulator, with the UART at its standard input and output. ROLE is `controller` (the example, whose
 * answers are checked) or `echo` (echo.c, which sends back each frame it receives). Each phase prints a line; the exit
 * status is 0 when all passed.
 */
#define _DEFAULT_SOURCE

#include "emulator.h"

/* --- controller --- */

/* A status report as shipped firmware lays it out: floats first, then STAT. */
struct report {
    uint32_t bits[3];
    float at[3];
    int status, stops;
};

static void read_report(const struct protocol_msg *msg, struct report *report)
{
    CHECK(msg->opcode == DP_OPCODE_STATUS_REPL && msg->data_s == 16);
    memcpy(report->bits, msg->data, 12);
    memcpy(report->at, msg->data, 12);
    report->status = msg->data[12] & DP_BIT_STAT_STATUS_BITS;
    report->stops = (unsigned char)msg->data[12] >> 2 & 7;
}

static void expect_report(struct report *report, int status)
{
    struct protocol_msg msg;

    expect(&msg, DP_OPCODE_STATUS_REPL);
    read_report(&msg, report);
    CHECK(report->status == status);
}

static void move(float a, float b, float c)
{
    float to[3];

    to[0] = a;
    to[1] = b;
    to[2] = c;
    request(DP_OPCODE_MOVE, to, 12);
}

static void before_homing(void)
{
    double since = seconds();
    struct protocol_msg msg;
    struct report report;
    int i;

    phase = "unhomed";
    request(DP_OPCODE_STATUS, NULL, 0);
    expect_report(&report, DP_STATUS_IDLE);
    for (i = 0; i < 3; ++i)
        CHECK(report.bits[i] == 0x7F800001u);
    CHECK(report.stops == 0);
    move(1, 2, 3);
    expect_answer(DP_OPCODE_NACK, DP_OPCODE_MOVE);
    CHECK(!get(&msg, 100)); /* no report behind this one */
    request(DP_OPCODE_CANCEL, NULL, 0);
    expect_answer(DP_OPCODE_ACK, DP_OPCODE_CANCEL);
    expect_report(&report, DP_STATUS_IDLE);
    passed(since, "requests before homing", 3);
}

static void homing(void)
{
    double since = seconds();
    struct protocol_msg msg;
    struct report report;
    int i;

    phase = "homing";
    request(DP_OPCODE_HOMING, NULL, 0);
    expect_answer(DP_OPCODE_ACK, DP_OPCODE_HOMING);
    expect_report(&report, DP_STATUS_HOMING);
    CHECK(report.bits[0] == 0x7F800001u);
    expect(&msg, DP_OPCODE_HOMING_REPL);
    expect_report(&report, DP_STATUS_IDLE);
    CHECK(report.stops == 7);
    for (i = 0; i < 3; ++i)
        CHECK(report.at[i] == 0.0f);
    passed(since, "arms at their stops", 3);
}

static void finish_move(const float to[3], int *reports)
{
    struct protocol_msg msg;
    struct report report;
    int i;

    for (;;) {
        CHECK(get(&msg, ANSWER_MS));
        if (msg.opcode == DP_OPCODE_MOVE_REPL)
            break;
        read_report(&msg, &report);
        CHECK(report.status == DP_STATUS_MOVING);
        ++*reports;
    }
    expect_report(&report, DP_STATUS_IDLE);
    for (i = 0; i < 3; ++i)
        CHECK(report.at[i] - to[i] < 0.126f && to[i] - report.at[i] < 0.126f);
}

static void moves(void)
{
    static const float targets[][3] = {{50, 60, 70.5f}, {1.25f, 99, 3}, {2, 99, 3}, {33.3f, 0, 0}, {0, 0, 0}};
    static const int wrong[] = {0, 1, 4, 11, 13, 16, DP_DATA_MAX_SIZE};
    double since = seconds();
    uint32_t not_a_number[3] = {0x3F800000u, 0x7FC00000u, 0};
    struct report report;
    char zeros[DP_DATA_MAX_SIZE];
    int reports = 0;
    size_t i;

    phase = "moves";
    for (i = 0; i < sizeof targets / sizeof targets[0]; ++i) {
        int before = reports;

        move(targets[i][0], targets[i][1], targets[i][2]);
        expect_answer(DP_OPCODE_ACK, DP_OPCODE_MOVE);
        expect_report(&report, DP_STATUS_MOVING);
        finish_move(targets[i], &reports);
        if (i == 0)
            CHECK(reports - before >= 20); /* one at each step of the encoder */
    }
    CHECK(report.stops != 7);
    passed(since, "reports on the way", reports);

    since = seconds();
    phase = "refusals";
    memset(zeros, 0, sizeof zeros);
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        if (wrong[i] > DP_DATA_MAX_SIZE || wrong[i] == 12)
            continue;
        request(DP_OPCODE_MOVE, zeros, wrong[i]);
        expect_answer(DP_OPCODE_NACK, DP_OPCODE_MOVE);
        expect_report(&report, DP_STATUS_IDLE);
    }
    request(DP_OPCODE_MOVE, not_a_number, 12);
    expect_answer(DP_OPCODE_NACK, DP_OPCODE_MOVE);
    expect_report(&report, DP_STATUS_IDLE);
    passed(since, "moves refused", (int)i + 1);
}

static void cancel(void)
{
    double since = seconds();
    struct protocol_msg msg;
    struct report report;
    int i;

    phase = "cancel";
    move(90, 90, 90);
    expect_answer(DP_OPCODE_ACK, DP_OPCODE_MOVE);
    for (i = 0; i < 4; ++i)
        expect_report(&report, DP_STATUS_MOVING);
    request(DP_OPCODE_CANCEL, NULL, 0);
    do
        CHECK(get(&msg, ANSWER_MS));
    while (msg.opcode == DP_OPCODE_STATUS_REPL);
    CHECK(msg.opcode == DP_OPCODE_ACK && msg.data_s == 1 && msg.data[0] == 'C');
    expect_report(&report, DP_STATUS_IDLE);
    CHECK(report.at[0] > 1.0f && report.at[0] < 89.0f && report.stops == 0);
    CHECK(!get(&msg, 100));
    passed(since, "reports before it", i);
}

static void status_rounds(int rounds)
{
    double since = seconds();
    struct stream stream;
    struct report report;
    int i;

    phase = "round trips";
    stream.count = 0;
    frame(&stream, DP_OPCODE_STATUS, NULL, 0);
    for (i = 0; i < rounds; ++i) {
        /* In two pieces, cut anywhere. */
        size_t first = any((unsigned int)stream.count + 1);

        if (first > 0)
            put(stream.bytes, first);
        if (first < (size_t)stream.count)
            put(stream.bytes + first, (size_t)stream.count - first);
        expect_report(&report, DP_STATUS_IDLE);
    }
    passed(since, "status reports", rounds);
}

/* Rubbish between requests, and false beginnings of frames, which the quiet line ends. */
static void controller_noise(void)
{
    static const char false_start[] = "$M\x20 only the head of a frame";
    double since = seconds();
    struct report report;
    int i, k;

    phase = "noise";
    for (i = 0; i < 200; ++i) {
        struct stream stream;
        unsigned int rubbish = any(60);

        stream.count = 0;
        while (rubbish-- > 0) {
            unsigned char byte = (unsigned char)any(256);

            if (byte == DP_PROTO_FRAME_START)
                byte = 'x';
            append(&byte, 1, &stream);
        }
        frame(&stream, DP_OPCODE_STATUS, NULL, 0);
        put(stream.bytes, (size_t)stream.count);
        expect_report(&report, DP_STATUS_IDLE);
    }
    for (k = 0; k < 2; ++k) {
        put(false_start, 3);
        request(DP_OPCODE_STATUS, NULL, 0);
        expect_report(&report, DP_STATUS_IDLE); /* after the silence */
    }
    passed(since, "requests amid rubbish", i + k);
}

static void error_state(void)
{
    double since = seconds();
    struct protocol_msg msg;
    struct report report;

    phase = "error";
    move(-5, 10, 10);
    expect_answer(DP_OPCODE_ACK, DP_OPCODE_MOVE);
    do
        CHECK(get(&msg, ANSWER_MS));
    while (msg.opcode == DP_OPCODE_STATUS_REPL);
    CHECK(msg.opcode == DP_OPCODE_GENERAL_ERR && msg.data_s == 0);
    expect_report(&report, DP_STATUS_ERROR);
    CHECK(report.stops & 1);
    request(DP_OPCODE_HOMING, NULL, 0);
    expect_answer(DP_OPCODE_NACK, DP_OPCODE_HOMING);
    expect_report(&report, DP_STATUS_ERROR);
    move(1, 1, 1);
    expect_answer(DP_OPCODE_NACK, DP_OPCODE_MOVE);
    expect_report(&report, DP_STATUS_ERROR);
    request(DP_OPCODE_CANCEL, NULL, 0);
    expect_answer(DP_OPCODE_NACK, DP_OPCODE_CANCEL);
    expect_report(&report, DP_STATUS_ERROR);
    passed(since, "requests refused", 3);
}

/* --- echo --- */

static const char opcodes[] = DP_PROTO_ALL_OPCODES;

/* What the library finds in a stream. */
struct collected {
    struct protocol_msg msgs[512];
    int count;
};

/* The same search on this machine, a byte at a time. */
static void search(struct protocol_data *ring, const unsigned char *bytes, int count, struct collected *found)
{
    int i;

    for (i = 0; i < count; ++i) {
        unsigned char byte = bytes[i];

        CHECK(dp_process(ring, &byte, 1) == DP_RC_SUCCESS);
        while (dp_recv(ring, &found->msgs[found->count]) == DP_RC_SUCCESS)
            CHECK(++found->count < 512);
    }
}

static int same(const struct protocol_msg *a, const struct protocol_msg *b)
{
    return a->opcode == b->opcode && a->data_s == b->data_s && memcmp(a->data, b->data, (size_t)a->data_s) == 0;
}

static void random_payload(char *payload, int bytes)
{
    int i;

    for (i = 0; i < bytes; ++i)
        payload[i] = (char)(any(8) ? any(256) : any(2) ? '$' : ':');
}

static void echo_lengths(void)
{
    double since = seconds();
    struct protocol_msg sent, got;
    int length, k, count = 0;

    phase = "lengths";
    for (length = 0; length <= DP_DATA_MAX_SIZE; ++length)
        for (k = 0; k < 10; ++k, ++count) {
            sent.opcode = (unsigned char)opcodes[k];
            sent.data_s = length;
            random_payload(sent.data, length);
            request(sent.opcode, sent.data, length);
            CHECK(get(&got, ANSWER_MS));
            CHECK(same(&sent, &got));
        }
    /* And all that the length byte can say beyond: rejected there, so that what follows is found at once. */
    for (length = DP_DATA_MAX_SIZE + 1; length <= 255; ++length, ++count) {
        char head[3];

        head[0] = '$';
        head[1] = 'M';
        head[2] = (char)length;
        put(head, 3);
        request(DP_OPCODE_STATUS, NULL, 0);
        expect(&got, DP_OPCODE_STATUS);
    }
    passed(since, "frames of every length", count);
}

static void echo_rounds(int rounds)
{
    double since = seconds();
    struct protocol_msg sent, got;
    int i;

    phase = "round trips";
    for (i = 0; i < rounds; ++i) {
        sent.opcode = (unsigned char)opcodes[any(10)];
        sent.data_s = (int)any(DP_DATA_MAX_SIZE + 1);
        random_payload(sent.data, sent.data_s);
        request(sent.opcode, sent.data, sent.data_s);
        CHECK(get(&got, ANSWER_MS));
        CHECK(same(&sent, &got));
    }
    passed(since, "frames and back", rounds);
}

/*
 * A long stream of frames with or without rubbish between them, cut anyhow: the firmware must find what this machine
 * finds. The echoes are waited for, since two lines of one speed can't carry more back than there.
 */
static void echo_stream(const char *name, int noisy, int streams)
{
    double since = seconds();
    int n, found = 0;

    phase = name;
    for (n = 0; n < streams; ++n) {
        static struct protocol_data ring;
        static struct collected expected;
        struct stream stream;
        char payload[DP_DATA_MAX_SIZE];
        char zero = 0;
        int at = 0, i;

        stream.count = 0;
        while (stream.count < (int)sizeof stream.bytes - 3 * FRAME_MAX) {
            int length = (int)any(DP_DATA_MAX_SIZE + 1);

            random_payload(payload, length);
            frame(&stream, (unsigned char)opcodes[any(10)], payload, length);
            if (noisy) {
                if (any(4) == 0) {
                    unsigned char *behind = stream.bytes + stream.count;
                    behind[-1 - (int)any((unsigned int)length + 5)] ^= (unsigned char)(1u << any(8));
                }
                length = (int)any((unsigned int)sizeof payload);
                random_payload(payload, length);
                append(payload, length, &stream);
            }
        }
        /* Nothing stays behind an incomplete candidate. */
        for (i = 0; i < FRAME_MAX; ++i)
            append(&zero, 1, &stream);

        memset(&ring, 0, sizeof ring);
        expected.count = 0;
        while (at < stream.count) {
            int piece = 1 + (int)any(any(4) ? 8 : 40);
            int seen = expected.count;

            if (piece > stream.count - at)
                piece = stream.count - at;
            search(&ring, stream.bytes + at, piece, &expected);
            put(stream.bytes + at, (size_t)piece);
            at += piece;
            for (; seen < expected.count; ++seen) {
                struct protocol_msg echo;

                CHECK(get(&echo, ANSWER_MS));
                CHECK(same(&expected.msgs[seen], &echo));
            }
        }
        CHECK(expected.count > 5);
        found += expected.count;
    }
    passed(since, "frames found", found);
}

int main(int argc, char **argv)
{
    int rounds = 10000;
    int at = 2;

    if (argc > at && strcmp(argv[at], "--") != 0)
        rounds = atoi(argv[at++]);
    if (argc < at + 2 || strcmp(argv[at], "--") != 0) {
        fprintf(stderr, "usage: %s controller|echo [ROUNDS] -- COMMAND...\n", argv[0]);
        return 2;
    }
    start_emulator(argv + at + 1);
    wait_for_start();
    if (strcmp(argv[1], "controller") == 0) {
        before_homing();
        homing();
        moves();
        cancel();
        status_rounds(rounds);
        controller_noise();
        error_state();
    } else {
        echo_lengths();
        echo_rounds(rounds);
        echo_stream("pieces", 0, rounds / 1000 + 1);
        echo_stream("noise", 1, rounds / 1000 + 1);
    }
    return 0;
}
