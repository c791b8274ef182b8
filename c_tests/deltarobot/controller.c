/* controller.h: what is answered to each request in each state, in which order, and what the firmware is asked. */
#include "libdeltarobot/controller.h"

#include "check.h"
#include "wire.h"

#include <limits.h>

#if DP_DATA_MAX_SIZE >= 16

static struct dp_controller controller;
static int usr_object;

static struct {
    int state, refuses, reenters, unmakes;
    float at[3];
    struct protocol_msg_position target;
} robot;

static char story[64];  /* what was called and sent: h m c for the calls, then the frames as they are named below */
static unsigned char last_report[16];
static int last_report_size;

static void happens(const char *what)
{
    if (strlen(story) + strlen(what) < sizeof story)
        strcat(story, what);
}

static int home(void *usr)
{
    CHECK(usr == &usr_object);
    happens("home ");
    if (robot.refuses)
        return 1;
    robot.state = DP_STATUS_HOMING;
    return 0;
}

static int move(const struct protocol_msg_position *target, void *usr)
{
    CHECK(usr == &usr_object);
    happens("move ");
    if (robot.refuses)
        return -1;
    robot.target = *target;
    robot.state = DP_STATUS_MOVING;
    /* The library may be called on the same controller. */
    if (robot.reenters) {
        robot.reenters = 0;
        CHECK_INT(dp_controller_receive(&controller, "$S\0\xB1:", 5), 5);
        CHECK_INT(dp_controller_poll(&controller), DP_RC_SUCCESS);
    }
    if (robot.unmakes)
        CHECK_INT(dp_controller_init(&controller, NULL, NULL, 0, 0), DP_RC_ERROR_GENERIC);
    return 0;
}

static int cancel(void *usr)
{
    CHECK(usr == &usr_object);
    happens("cancel ");
    if (robot.refuses)
        return 1;
    robot.state = DP_STATUS_IDLE;
    return 0;
}

static void read_status(struct protocol_msg_status_report *report, void *usr)
{
    CHECK(usr == &usr_object);
    memcpy(&report->DA, &robot.at[0], 4);
    memcpy(&report->DB, &robot.at[1], 4);
    memcpy(&report->DC, &robot.at[2], 4);
    report->STAT = (unsigned char)(robot.state | DP_BIT_STAT_STOP_B_BIT | 0xE0);
}

/* "A(H)", "s1" for a report of state 1, "h". */
static int send(void *buf, int bytes, void *usr)
{
    const unsigned char *frame = buf;
    unsigned char expected[WIRE_FRAME_MAX];
    char name[8] = "";

    CHECK(usr == &usr_object);
    CHECK_INT(wire_frame(expected, frame[1], frame + 3, frame[2]), bytes);
    CHECK_BYTES(frame, expected, bytes);
    if (frame[1] == 'A' || frame[1] == 'N') {
        CHECK_INT(frame[2], 1);
        sprintf(name, "%c(%c) ", frame[1], frame[3]);
    } else if (frame[1] == 's') {
        last_report_size = frame[2];
        memcpy(last_report, frame + 3, frame[2] < 16 ? frame[2] : 16);
        sprintf(name, "s%d ", (frame[2] == 13 ? frame[3] : frame[15]) & DP_BIT_STAT_STATUS_BITS);
    } else {
        CHECK_INT(frame[2], 0);
        sprintf(name, "%c ", frame[1]);
    }
    happens(name);
    return -1; /* is ignored */
}

static const struct dp_controller_calls CALLS = {home, move, cancel, read_status, send};

static void set_unknown(void)
{
    static const unsigned char UNKNOWN[4] = {1, 0, 0x80, 0x7F};
    memcpy(&robot.at[1], UNKNOWN, 4);
}

static void begin(int layout, int flags)
{
    memset(&robot, 0, sizeof robot);
    robot.at[0] = 1;
    memset(&controller, 0x5A, sizeof controller);
    CHECK_INT(dp_controller_init(&controller, &CALLS, &usr_object, layout, flags), DP_RC_SUCCESS);
}

/* One request, one call: what happens. */
static int answers(int opcode, const void *payload, int size, const char *expected)
{
    unsigned char frame[WIRE_FRAME_MAX];
    int length = wire_frame(frame, opcode, payload, size);

    story[0] = '\0';
    CHECK_INT(dp_controller_receive(&controller, frame, length), length);
    CHECK_INT(dp_controller_poll(&controller), DP_RC_SUCCESS);
    if (strcmp(story, expected) == 0)
        return 1;
    fprintf(stderr, "    %s\n", story);
    return 0;
}

static int then(const char *expected)
{
    story[0] = '\0';
    CHECK_INT(dp_controller_poll(&controller), *expected ? DP_RC_SUCCESS : DP_RC_NO_FRAME);
    if (strcmp(story, expected) == 0)
        return 1;
    fprintf(stderr, "    %s\n", story);
    return 0;
}

static const unsigned char THERE[12] = {0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0x60, 0xC0};
static const unsigned char ELSEWHERE[12] = {0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0x60, 0x40};
static const unsigned char NOWHERE[12] = {0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0};

/* The contract's table. */
static void answers_like_shipped_firmware(void)
{
    begin(0, 0);
    set_unknown();
    CHECK(answers('S', "", 0, "s0 "));
    CHECK_INT(last_report_size, 16);
    CHECK_BYTES(last_report, "\0\0\x80\x3F\1\0\x80\x7F\0\0\0\0\x08\0\0\0", 16);
    CHECK(answers('M', THERE, 12, "N(M) "));
    CHECK(answers('M', THERE, 11, "N(M) "));
    CHECK(answers('H', "", 0, "home A(H) s1 "));
    robot.at[1] = 0;
    robot.state = DP_STATUS_IDLE;
    CHECK(then("s0 "));
    CHECK(then(""));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    CHECK_BYTES(&robot.target, THERE, 12);
    CHECK_INT(dp_controller_report(&controller), DP_RC_SUCCESS);
    CHECK(then(""));
    CHECK(answers('M', ELSEWHERE, 12, "move A(M) s2 ")); /* goes there instead */
    CHECK(answers('C', "", 0, "cancel A(C) s0 "));
    CHECK(then(""));
    CHECK(answers('C', "", 0, "cancel A(C) s0 "));
    CHECK(answers('M', NOWHERE, 12, "N(M) s0 "));
    CHECK(answers('M', THERE, 11, "N(M) s0 "));
    CHECK(answers('M', THERE, 0, "N(M) s0 "));
    CHECK(answers('H', "x", 1, "N(H) s0 "));
    CHECK(answers('C', "x", 1, "N(C) s0 "));
    robot.state = DP_STATUS_ERROR;
    CHECK(answers('H', "", 0, "N(H) s3 "));
    CHECK(answers('M', THERE, 12, "N(M) s3 "));
    CHECK(answers('C', "", 0, "N(C) s3 "));
    CHECK(answers('S', "", 0, "s3 "));
    set_unknown();
    CHECK(answers('M', THERE, 12, "N(M) "));
    robot.state = DP_STATUS_IDLE;
    robot.refuses = 1;
    CHECK(answers('H', "", 0, "home N(H) s0 "));
    CHECK(answers('C', "", 0, "cancel N(C) s0 "));
    robot.at[1] = 0;
    CHECK(answers('M', THERE, 12, "move N(M) s0 "));
    CHECK(then(""));
}

static void retransmitted_requests_start_nothing(void)
{
    begin(0, 0);
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    CHECK(answers('M', THERE, 12, "A(M) s2 "));
    CHECK(answers('H', "", 0, "home A(H) s1 "));
    CHECK(answers('H', "", 0, "A(H) s1 "));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    robot.state = DP_STATUS_IDLE;
    CHECK(then("s0 "));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
}

static void refuses_when_busy(void)
{
    begin(0, DP_CONTROLLER_REFUSE_BUSY);
    CHECK(answers('H', "", 0, "home A(H) s1 "));
    CHECK(answers('M', THERE, 12, "N(M) s1 "));
    CHECK(answers('H', "", 0, "A(H) s1 "));
    robot.state = DP_STATUS_IDLE;
    CHECK(then("s0 "));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    CHECK(answers('M', ELSEWHERE, 12, "N(M) s2 "));
    CHECK(answers('H', "", 0, "N(H) s2 "));
    CHECK(answers('C', "", 0, "cancel A(C) s0 "));
}

static void reports_ends_as_specified(void)
{
    begin(DP_LAYOUT_SPEC, DP_CONTROLLER_REPORT_END | DP_CONTROLLER_REPORT_ERROR);
    CHECK(answers('H', "", 0, "home A(H) s1 "));
    CHECK_INT(last_report_size, 13);
    CHECK_BYTES(last_report, "\x09\0\0\x80\x3F\0\0\0\0\0\0\0\0", 13);
    CHECK(then(""));
    robot.state = DP_STATUS_IDLE;
    CHECK(then("h s0 "));
    CHECK(then(""));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    robot.state = DP_STATUS_IDLE;
    CHECK(then("m s0 "));
    CHECK(answers('M', THERE, 12, "move A(M) s2 "));
    robot.state = DP_STATUS_ERROR;
    CHECK(then("e s3 "));
    CHECK(then(""));
    robot.state = DP_STATUS_IDLE;
    CHECK(answers('H', "", 0, "home A(H) s1 "));
    CHECK(answers('C', "", 0, "cancel A(C) s0 "));
    CHECK(then(""));
}

static void one_message_a_call(void)
{
    begin(0, 0);
    story[0] = '\0';
    /* What a host does not send is passed over. */
    CHECK_INT(dp_controller_receive(&controller, "$S\0\xB1:$h\0\xC6:x$S\0\xB1:$M", 18), 18);
    CHECK(then("s0 "));
    CHECK(then("s0 "));
    CHECK(then(""));
    /* The beginning of a frame hides what comes behind it until the line is known to be quiet. */
    CHECK_INT(dp_controller_receive(&controller, "\x0C$S\0\xB1:", 6), 6);
    CHECK(then(""));
    CHECK_INT(dp_controller_poll_idle(&controller), DP_RC_SUCCESS);
    CHECK(strcmp(story, "s0 ") == 0);
    CHECK_INT(dp_controller_poll_idle(&controller), DP_RC_NO_FRAME);
}

static void functions_may_call_again(void)
{
    begin(0, 0);
    robot.reenters = 1;
    CHECK(answers('M', THERE, 12, "move s2 A(M) s2 "));

    /* What they do to it may leave nothing to answer with. */
    begin(0, 0);
    robot.unmakes = 1;
    CHECK(answers('M', THERE, 12, "move "));
    CHECK_INT(dp_controller_poll(&controller), DP_RC_ERROR_GENERIC);
}

static void missing_functions_refuse(void)
{
    struct dp_controller_calls calls = {NULL, NULL, NULL, read_status, send};
    begin(0, 0);
    CHECK_INT(dp_controller_init(&controller, &calls, &usr_object, 0, 0), DP_RC_SUCCESS);
    CHECK(answers('H', "", 0, "N(H) s0 "));
    CHECK(answers('M', THERE, 12, "N(M) s0 "));
    CHECK(answers('C', "", 0, "N(C) s0 "));

    calls.read = NULL;
    CHECK_INT(dp_controller_init(&controller, &calls, &usr_object, 0, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_poll(&controller), DP_RC_ERROR_GENERIC);
    calls.read = read_status;
    calls.send = NULL;
    CHECK_INT(dp_controller_init(&controller, &calls, &usr_object, 0, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_report(&controller), DP_RC_ERROR_GENERIC);
}

static void bad_arguments_are_refused(void)
{
    begin(0, 0);
    CHECK_INT(dp_controller_receive(&controller, NULL, 1), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_receive(&controller, "x", INT_MIN), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_receive(&controller, NULL, 0), 0);
    CHECK_INT(dp_controller_init(NULL, &CALLS, NULL, 0, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_init(&controller, NULL, NULL, 0, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_poll(&controller), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_init(&controller, &CALLS, NULL, 3, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_receive(NULL, "x", 1), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_poll(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_poll_idle(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_controller_report(NULL), DP_RC_ERROR_GENERIC);
    memset(&controller, 0, sizeof controller);
    CHECK_INT(dp_controller_poll(&controller), DP_RC_ERROR_GENERIC);
}

static void takes_what_fits(void)
{
    unsigned char bytes[2 * DP_DATA_MAX_SIZE + 64];
    int taken, i;

    memset(bytes, 'x', sizeof bytes);
    memcpy(bytes + sizeof bytes - 5, "$S\0\xB1:", 5);
    begin(0, 0);
    taken = dp_controller_receive(&controller, bytes, (int)sizeof bytes);
    CHECK(taken >= DP_DATA_MAX_SIZE + 5 && taken < (int)sizeof bytes - 5);
    CHECK_INT(dp_controller_receive(&controller, bytes + taken, (int)sizeof bytes - taken), 0);
    for (i = 0; i < 100 && taken < (int)sizeof bytes; ++i) {
        CHECK(then(""));
        taken += dp_controller_receive(&controller, bytes + taken, (int)sizeof bytes - taken);
    }
    CHECK(then("s0 "));
}

/* Puts random bytes into the controller, but for what it keeps the two pointers as. */
static void scribble(unsigned long *seed)
{
    const struct dp_controller_calls *calls = &CALLS;
    const void *usr = &usr_object;
    unsigned char *bytes = (unsigned char *)&controller;
    size_t place, pointers = 0;

    for (place = 0; place < sizeof controller;) {
        if (place + sizeof usr <= sizeof controller &&
            (memcmp(bytes + place, &calls, sizeof calls) == 0 || memcmp(bytes + place, &usr, sizeof usr) == 0)) {
            place += sizeof usr;
            ++pointers;
        } else {
            bytes[place++] = (unsigned char)wire_random(seed);
        }
    }
    CHECK_INT(pointers, 2);
}

/* What the controller keeps for itself is overwritten by anything: it answers, touches nothing else, and ends. */
static void any_memory(void)
{
    static const char OPCODES[] = "HSMC" DP_PROTO_ALL_OPCODES;
    unsigned long seed = 13;
    int round, step, polls;

    for (round = 0; round < 2000; ++round) {
        begin(round % 3, round % 8);
        scribble(&seed);
        for (step = 0; step < 10; ++step) {
            unsigned char frame[WIRE_FRAME_MAX];
            char opcode = OPCODES[wire_random(&seed) % (sizeof OPCODES - 1)];
            int length = wire_frame(frame, opcode, THERE, step % 2 ? 12 : 0);
            int rc = dp_controller_receive(&controller, frame, length);
            CHECK(rc >= 0 && rc <= length);
            robot.state = (int)(wire_random(&seed) % 4);
            for (polls = 0; polls < DP_BUFSIZE && dp_controller_poll_idle(&controller) == DP_RC_SUCCESS; ++polls)
                story[0] = '\0';
            CHECK(polls < DP_BUFSIZE);
        }
    }
}

int main(void)
{
    any_memory();
    answers_like_shipped_firmware();
    retransmitted_requests_start_nothing();
    refuses_when_busy();
    reports_ends_as_specified();
    one_message_a_call();
    functions_may_call_again();
    missing_functions_refuse();
    bad_arguments_are_refused();
    takes_what_fits();
    return check_summary("controller");
}

#else

static void read_status(struct protocol_msg_status_report *report, void *usr)
{
    (void)report;
    (void)usr;
}

static int send(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)usr;
    return bytes;
}

/* No status report fits, and there is no controller without. */
int main(void)
{
    static const struct dp_controller_calls CALLS = {NULL, NULL, NULL, read_status, send};
    static struct dp_controller controller;
    CHECK_INT(dp_controller_init(&controller, &CALLS, NULL, DP_LAYOUT_FIRMWARE, 0), DP_RC_ERROR_GENERIC);
    return check_summary("controller");
}

#endif
