/* payload.h: each message of the specification built, sent, received and read; both layouts of the report; texts. */
#include "libdeltarobot/payload.h"

#include "check.h"
#include "wire.h"

#include <stdio.h>
#include <stdlib.h>

static struct protocol_msg message;

/* 0x7F800001 as it lies in memory: no code may load it as a float. */
static void set_unknown(float *place)
{
    unsigned int bits = 0x7F800001u;
    memcpy(place, &bits, 4);
}

static int keep_frame(void *buf, int bytes, void *usr)
{
    memcpy(usr, buf, (size_t)bytes);
    return bytes;
}

/* The frame of what was built is what the specification says, and is received as what was built. */
static void is_frame(int opcode, const void *payload, int size)
{
    unsigned char expected[WIRE_FRAME_MAX], frame[WIRE_FRAME_MAX];
    struct protocol_data ring;
    struct protocol_msg received;
    int length = wire_frame(expected, opcode, payload, size);

    CHECK_INT(dp_send(&message, keep_frame, frame), length);
    CHECK_BYTES(frame, expected, length);
    memset(&ring, 0, sizeof ring);
    CHECK_INT(dp_process(&ring, frame, length), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &received), DP_RC_SUCCESS);
    CHECK_INT(received.opcode, opcode);
    CHECK_INT(dp_msg_check(&received), DP_RC_SUCCESS);
    CHECK_INT(dp_msg_check(&message), DP_RC_SUCCESS);
}

static void without_payload(void)
{
    static const char PLAIN[] = "HSChme";
    int opcode;

    for (opcode = 0; opcode < 256; ++opcode) {
        int is_plain = opcode != 0 && strchr(PLAIN, opcode) != NULL;
        memset(&message, 0x77, sizeof message);
        CHECK_INT(dp_build(&message, (unsigned char)opcode), is_plain ? DP_RC_SUCCESS : DP_RC_ERROR_GENERIC);
        if (is_plain)
            is_frame(opcode, "", 0);
        else
            CHECK_INT(message.opcode, 0x77);
    }
}

static void answers(void)
{
    unsigned char answered = 0x55;

    CHECK_INT(dp_build_ack(&message, DP_OPCODE_HOMING), DP_RC_SUCCESS);
    is_frame('A', "H", 1);
    CHECK_INT(dp_read_answer(&message, &answered), DP_RC_SUCCESS);
    CHECK_INT(answered, 'H');
    CHECK_INT(dp_build_nack(&message, DP_OPCODE_MOVE), DP_RC_SUCCESS);
    is_frame('N', "M", 1);
    CHECK_INT(dp_read_answer(&message, &answered), DP_RC_SUCCESS);
    CHECK_INT(answered, 'M');

    message.data_s = 0;
    CHECK_INT(dp_read_answer(&message, &answered), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_msg_check(&message), DP_RC_ERROR_GENERIC);
    message.data_s = 2;
    CHECK_INT(dp_read_answer(&message, &answered), DP_RC_ERROR_GENERIC);
    message.data_s = 1;
    message.opcode = DP_OPCODE_MOVE;
    CHECK_INT(dp_read_answer(&message, &answered), DP_RC_ERROR_GENERIC);
    CHECK_INT(answered, 'M');
}

static void moves(void)
{
    static const unsigned char WIRE[12] = {0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0};
    struct protocol_msg_position target, read;
    int size;

    target.DA = 1;
    set_unknown(&target.DB);
    target.DC = -3.5f;
#if DP_DATA_MAX_SIZE < 12
    CHECK_INT(dp_build_move(&message, &target), DP_RC_ERROR_GENERIC);
    (void)WIRE;
    (void)read;
    (void)size;
#else
    CHECK_INT(dp_build_move(&message, &target), DP_RC_SUCCESS);
    is_frame('M', WIRE, 12);
    memset(&read, 0x33, sizeof read);
    CHECK_INT(dp_read_move(&message, &read), DP_RC_SUCCESS);
    CHECK_BYTES(&read, &target, 12);
    for (size = -1; size <= DP_DATA_MAX_SIZE + 1; ++size) {
        message.data_s = size;
        CHECK_INT(dp_read_move(&message, &read), size == 12 ? DP_RC_SUCCESS : DP_RC_ERROR_GENERIC);
        CHECK_INT(dp_msg_check(&message), size == 12 ? DP_RC_SUCCESS : DP_RC_ERROR_GENERIC);
    }
#endif
}

#if DP_DATA_MAX_SIZE >= 16
static void reports(void)
{
    static const unsigned char SPEC[13] = {0x16, 0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0};
    static const unsigned char FIRMWARE[16] = {0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0, 0x16, 0, 0, 0};
    struct protocol_msg_status_report report, read;
    int layout, size;

    memset(&report, 0, sizeof report);
    report.DA = 1;
    set_unknown(&report.DB);
    report.DC = -3.5f;
    report.STAT = 0xE0 | 0x16;
    CHECK_INT(dp_build_status_report(&message, &report, DP_LAYOUT_SPEC), DP_RC_SUCCESS);
    is_frame('s', SPEC, 13);
    memset(&read, 0, sizeof read);
    CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_SPEC, &read), DP_RC_SUCCESS);
    CHECK_BYTES(&read, &report, 12);
    CHECK_INT(read.STAT, 0x16);
    CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_AUTO, &read), DP_RC_SUCCESS);
    CHECK_BYTES(&read, &report, 12);

    for (layout = DP_LAYOUT_AUTO; layout <= DP_LAYOUT_FIRMWARE; layout += DP_LAYOUT_FIRMWARE) {
        CHECK_INT(dp_build_status_report(&message, &report, layout), DP_RC_SUCCESS);
        is_frame('s', FIRMWARE, 16);
    }
    /* What shipped firmware sends in the reserved bits and the padding. */
    memcpy(message.data + 12, "\xF6\xDE\xAD\xBE", 4);
    for (size = -1; size <= DP_DATA_MAX_SIZE + 1; ++size) {
        int fits = size >= 13 && size <= DP_DATA_MAX_SIZE;
        message.data_s = size;
        memset(&read, 0, sizeof read);
        CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_FIRMWARE, &read), fits ? 0 : DP_RC_ERROR_GENERIC);
        CHECK_INT(read.STAT, fits ? 0x16 : 0);
        CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_SPEC, &read), size == 13 ? 0 : DP_RC_ERROR_GENERIC);
        CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_AUTO, &read), fits ? 0 : DP_RC_ERROR_GENERIC);
        if (fits)
            CHECK_INT(read.STAT, 0x16);
    }
    CHECK_INT(dp_read_status_report(&message, 3, &read), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_status_report(&message, &report, -1), DP_RC_ERROR_GENERIC);

    /* 13 bytes: the reading in which more is plausible; floats first where both are alike. */
    memset(message.data, 0, 16);
    message.data_s = 13;
    message.data[0] = 0x33;
    message.data[12] = (char)0xE3;
    CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_AUTO, &read), DP_RC_SUCCESS);
    CHECK_INT(read.STAT, 3);
    message.data[0] = 0x01;
    CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_AUTO, &read), DP_RC_SUCCESS);
    CHECK_INT(read.STAT, 3);
    message.data[12] = 0x3F;
    CHECK_INT(dp_read_status_report(&message, DP_LAYOUT_AUTO, &read), DP_RC_SUCCESS);
    CHECK_INT(read.STAT, 1);
}
#endif

static void says(const char *expected)
{
    char text[DP_MSG_TEXT_MAX + 8];
    int cap, length = (int)strlen(expected);

    for (cap = 0; cap <= DP_MSG_TEXT_MAX; ++cap) {
        int kept = cap == 0 ? 0 : cap <= length ? cap - 1 : length;
        memset(text, '#', sizeof text);
        CHECK_INT(dp_msg_format(&message, text, cap), length);
        CHECK(strncmp(text, expected, (size_t)kept) == 0);
        if (cap > 0)
            CHECK_INT(text[kept], '\0');
        CHECK_INT(text[cap > 0 ? kept + 1 : 0], '#');
    }
    CHECK_INT(dp_msg_format(&message, NULL, 0), length);
}

static void texts(void)
{
    static const char *const NAMES[] = {"ACK", "NACK", "HOMING!", "HOMING_REPLY", "STATUS?",
                                        "MOVE!", "CANCEL!", "STATUS_REPLY", "MOVE_REPLY", "GENERAL_ERROR"};
    const char *all = DP_PROTO_ALL_OPCODES; /* "ANHhSMCsme" in another order */
    static const char ORDER[] = "ANHhSMCsme";
    int opcode, i;

    CHECK_INT(strlen(all), strlen(ORDER));
    for (opcode = 0; opcode < 256; ++opcode) {
        const char *expected = "UNKNOWN_OPCODE";
        for (i = 0; i < 10; ++i)
            if (ORDER[i] == opcode)
                expected = NAMES[i];
        CHECK(strcmp(dp_opcode_name((unsigned char)opcode), expected) == 0);
        message.opcode = (unsigned char)opcode;
        message.data_s = -1; /* any payload of a length that is wrong is not shown */
        says(expected);
    }
    dp_build_ack(&message, DP_OPCODE_MOVE);
    says("ACK: (MOVE!)");
    dp_build_nack(&message, DP_OPCODE_MOVE);
    says("NACK");
#if DP_DATA_MAX_SIZE >= 16
    {
        static const struct protocol_msg_position TARGET = {1, 2, -3.5f};
        static const struct protocol_msg_status_report REPORT = {0, -1e-7f, 1e9f, 0x0C};
        dp_build_move(&message, &TARGET);
        says("MOVE!:  DA=1  DB=2  DC=-3.5");
        dp_build_status_report(&message, &REPORT, DP_LAYOUT_SPEC);
        says("STATUS_REPLY: IDLE  DA=0  DB=-1e-07  DC=1e+09 STP_A STP_B");
    }
#endif
}

/* The numbers in the texts against the C library's. */
static void numbers(unsigned long count)
{
#if DP_DATA_MAX_SIZE >= 12
    unsigned long seed = 99, i;
    char text[DP_MSG_TEXT_MAX], expected[DP_MSG_TEXT_MAX];
    unsigned int bits[3];
    struct protocol_msg_position at;

    for (i = 0; i < count; ++i) {
        bits[0] = wire_random(&seed) << 16 ^ wire_random(&seed);
        /* Of the size that displacements have; and at the edges: few bits set, all exponents. */
        bits[1] = (117 + wire_random(&seed) % 20) << 23 | (wire_random(&seed) & 0x7FFFFF);
        bits[2] = wire_random(&seed) % 512 << 23 | (wire_random(&seed) % 8) << (wire_random(&seed) % 21);
        memcpy(&at, bits, sizeof at);
        dp_build_move(&message, &at);
        dp_msg_format(&message, text, (int)sizeof text);
        sprintf(expected, "MOVE!:  DA=%g  DB=%g  DC=%g", at.DA, at.DB, at.DC);
        if (!CHECK(strcmp(text, expected) == 0))
            fprintf(stderr, "    %s\n    %s\n", text, expected);
    }
#else
    (void)count;
#endif
}

static void null_is_refused(void)
{
    struct protocol_msg_position at;
    struct protocol_msg_status_report report;
    unsigned char opcode;
    char text[8];

    memset(&at, 0, sizeof at);
    memset(&report, 0, sizeof report);
    CHECK_INT(dp_build(NULL, DP_OPCODE_HOMING), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_ack(NULL, 'H'), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_nack(NULL, 'H'), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_move(NULL, &at), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_move(&message, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_status_report(NULL, &report, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_build_status_report(&message, NULL, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_msg_check(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_read_answer(NULL, &opcode), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_read_move(NULL, &at), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_read_status_report(NULL, 0, &report), DP_RC_ERROR_GENERIC);
    dp_build_ack(&message, 'H');
    CHECK_INT(dp_read_answer(&message, NULL), DP_RC_ERROR_GENERIC);
    message.opcode = DP_OPCODE_MOVE;
    message.data_s = 12;
    CHECK_INT(dp_read_move(&message, NULL), DP_RC_ERROR_GENERIC);
    message.opcode = DP_OPCODE_STATUS_REPL;
    message.data_s = 13;
    CHECK_INT(dp_read_status_report(&message, 0, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_msg_format(NULL, text, 8), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_msg_format(&message, NULL, 8), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_msg_format(&message, text, -1), -DP_RC_ERROR_GENERIC);
}

int main(int argc, char **argv)
{
    without_payload();
    answers();
    moves();
#if DP_DATA_MAX_SIZE >= 16
    reports();
#endif
    texts();
    numbers(argc > 1 ? strtoul(argv[1], NULL, 10) : 30000);
    null_is_refused();
    return check_summary("payload");
}
