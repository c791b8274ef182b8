/* line_device.h: what is answered to each line, in which order, and what is executed how often. */
#include "libdeltarobot/line_device.h"

#include "check.h"

#include <limits.h>

#define ID "9o5qzg"

static struct olp_device device;
static int usr_object;
static unsigned long now;

static char sent[4096]; /* the lines sent */
static struct {
    int executed, refuses, reenters, adds; /* adds: so many bytes more in the answer */
    long state;
    const char *bad; /* what is wrong with the answer */
} board;

static int send_line(const void *line, int bytes, void *usr)
{
    CHECK(usr == &usr_object);
    CHECK(bytes > 0 && bytes <= (OLP_REPLY_MAX > 255 ? OLP_REPLY_MAX : 255));
    CHECK_INT(((const char *)line)[bytes - 1], '\n');
    CHECK(memchr(line, '\n', (size_t)bytes) == (const char *)line + bytes - 1);
    if (strlen(sent) + (size_t)bytes < sizeof sent)
        strncat(sent, line, (size_t)bytes);
    return -1; /* is ignored */
}

static int setswitch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    int i;

    CHECK(usr == &usr_object);
    ++board.executed;
    if (olp_get_int(command, "state", 0, &board.state) != OLP_RC_SUCCESS || board.refuses)
        return -7;
    olp_add_int(answer, "state", board.state);
    for (i = 0; i < board.adds; ++i)
        olp_add_string(answer, "x", "");
    if (board.bad != NULL)
        olp_add_int(answer, board.bad, 1);
    if (board.reenters) {
        char line[OLP_REPLY_MAX];
        struct olp_encoder event;

        CHECK_INT(olp_device_receive(&device, "c=x\n", 4, now), 0);
        CHECK_INT(olp_device_poll(&device, now), OLP_RC_BUSY);
        olp_begin(&event, line, sizeof line, "button");
        CHECK_INT(olp_device_event(&device, &event, "but.1"), OLP_RC_SUCCESS);
        if (board.reenters == 2)
            CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    } else {
        olp_add_int(answer, "pwm", 254);
    }
    return 0;
}

static int go(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    long c, x;

    (void)usr;
    ++board.executed;
    CHECK(olp_is(command, "c", 0, "go"));
    CHECK_INT(olp_get_int(command, "c", 1, &c), OLP_RC_SUCCESS);
    CHECK_INT(olp_get_int(command, "x", 0, &x), OLP_RC_SUCCESS);
    olp_add_int(answer, "c", c + x);
    return 0;
}

static int greet(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    char text[32];

    (void)usr;
    ++board.executed;
    CHECK(olp_get_string(command, "text", 0, text, sizeof text) >= 0);
    olp_add_string(answer, "text", text);
    return 0;
}

static const struct olp_device_info DEVICES[] = {
    {"IDMANG", "OzekiIDManager", 1, NULL, "1.0.0"},
    {ID, "OzekiSwitchController", 7, "F 1", NULL},
    {"but.1", "OzekiButtonController", 0, NULL, NULL},
};
static const struct olp_command COMMANDS[] = {
    {ID, "setswitch", setswitch},
    {"but.1", "setswitch", NULL},
    {"IDMANG", "go", go},
    {NULL, "greet", greet},
};
static const struct olp_device_table TABLE = {DEVICES, 3, COMMANDS, 4, send_line, 0};

static int poll_all(void)
{
    int rc, last = OLP_RC_NO_EVENT, rounds = 0;
    while ((rc = olp_device_poll(&device, now)) != OLP_RC_NO_EVENT && ++rounds < 20)
        last = rc;
    return last;
}

static int is_sent(const char *expected)
{
    int same = strcmp(sent, expected) == 0;
    if (!same)
        fprintf(stderr, "    expected %s    got %s\n", expected, sent);
    sent[0] = '\0';
    return same;
}

/* All bytes, in whatever pieces the device takes them; what it sends goes to `sent`. */
static int receive(const char *bytes, int count)
{
    int last = OLP_RC_NO_EVENT;
    while (count > 0) {
        int taken = olp_device_receive(&device, bytes, count, now), rc;
        CHECK(taken >= 0 && taken <= count);
        if (taken < 0)
            return last;
        bytes += taken;
        count -= taken;
        if ((rc = poll_all()) != OLP_RC_NO_EVENT)
            last = rc;
    }
    return last;
}

static int answers(const char *line, const char *expected)
{
    receive(line, (int)strlen(line));
    return is_sent(expected);
}

/* The line with its checksum. */
static int answers_checked(const char *text, const char *expected)
{
    char line[256];
    sprintf(line, "%s&s=%04x\n", text, olp_fletcher16(text, (int)strlen(text)));
    return answers(line, expected);
}

static const char WELCOMES[] = "c=welcome&id=IDMANG&type=OzekiIDManager&pos=1&version=1.0.0\n"
                               "c=welcome&id=" ID "&type=OzekiSwitchController&pos=7&name=F%201\n"
                               "c=welcome&id=but.1&type=OzekiButtonController\n";

static void begin(void)
{
    memset(&board, 0, sizeof board);
    memset(&device, 0x5A, sizeof device);
    now = 0xFFFFFF00ul; /* wraps soon */
    CHECK_INT(olp_device_init(&device, &TABLE, &usr_object), OLP_RC_SUCCESS);
    sent[0] = '\0';
    CHECK_INT(poll_all(), OLP_RC_SUCCESS);
    CHECK(is_sent(WELCOMES));
}

static const char SET_ON[] = "c=setswitch&state=1&t=11&id=" ID "\n";
/* Without t: executed each time. */
static const char SET_ON_ONCE[] = "c=setswitch&state=1&id=" ID "\n";
static const char IS_ON[] = "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=12\n";

/* All settings are off at first: only the answer. */
static void commands_are_executed_and_answered(void)
{
    begin();
    CHECK(answers(SET_ON, IS_ON));
    CHECK_INT(board.executed, 1);
    CHECK_INT(board.state, 1);
    CHECK(answers("c=setswitch&state=0&t=14&id=" ID "\r\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=15\n"));
    CHECK(answers("c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IDMANG\n", "c=go_resp&c=60&id=IDMANG&t=16\n"));
    CHECK(answers("c=greet&text=a+b%26c%3D&t=16&id=but.1\n", "c=greet_resp&text=a%20b%26c%3D&id=but.1&t=17\n"));
    CHECK(answers("c=greet&text=&t=17&id=IDMANG\n", "c=greet_resp&text=&id=IDMANG&t=18\n"));
    CHECK(answers("\n\r\n", ""));
    /* A checksum is accepted without being asked for. */
    CHECK(answers("c=setswitch&state=1&t=18&id=" ID "&s=0000\n", "c=onerror&code=checksum&t=19&id=IDMANG\n"));
    CHECK(answers_checked("c=setswitch&state=1&t=19&id=" ID, "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=20\n"));
    CHECK_INT(board.executed, 6);
}

static void what_cannot_be_executed_is_an_error(void)
{
    char line[80];

    begin();
    CHECK(answers("c=setswitch&state=1&t=5&id=nobody\n", "c=onerror&code=unknownid&t=5&id=nobody\n"));
    CHECK(answers("c=setswitch&state=1&t=6\n", "c=onerror&code=unknownid&t=6\n"));
    CHECK(answers("c=setswitch&state=1&t=7&id=a%26b\n", "c=onerror&code=unknownid&t=7\n"));
    CHECK(answers("c=setfan&t=8&id=" ID "\n", "c=onerror&code=unknowncommand&t=8&id=" ID "\n"));
    CHECK(answers("c=&t=9&id=" ID "\n", "c=onerror&code=unknowncommand&t=9&id=" ID "\n"));
    /* No function, and one that refuses. */
    CHECK(answers("c=setswitch&t=10&id=but.1\n", "c=onerror&code=refused&t=10&id=but.1\n"));
    CHECK_INT(board.executed, 0);
    board.refuses = 1;
    CHECK(answers(SET_ON, "c=onerror&code=refused&t=11&id=" ID "\n"));
    CHECK(answers(SET_ON, "c=onerror&code=refused&t=11&id=" ID "\n"));
    CHECK_INT(board.executed, 1);
    /* What was not read carries the counter's t. */
    CHECK(answers("x=1&c=setswitch\n", "c=onerror&code=malformed&t=12&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=%4&t=1\n", "c=onerror&code=malformed&t=13&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=256&id=" ID "\n", "c=onerror&code=malformed&t=14&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=&id=" ID "\n", "c=onerror&code=malformed&t=15&id=IDMANG\n"));
    memset(line, 'x', sizeof line);
    line[63] = '\n';
    receive(line, 64);
    CHECK(is_sent("c=onerror&code=malformed&t=16&id=IDMANG\n"));
    line[63] = 'x';
    line[64] = '\n';
    receive(line, 65);
    CHECK(is_sent("c=onerror&code=overflow&t=17&id=IDMANG\n"));
    /* 63 bytes, the end not counted. */
    CHECK(answers("c=greet&text=yyyyyyyyyyyyyyyyyyyyyyyyyyyy&zzzzzz&t=18&id=" ID "\r\n",
                  "c=greet_resp&text=yyyyyyyyyyyyyyyyyyyyyyyyyyyy&id=" ID "&t=19\n"));
    CHECK_INT(olp_device_get_health(&device)->commands, 9);
    CHECK_INT(olp_device_get_health(&device)->repeats, 1);
    CHECK_INT(olp_device_get_health(&device)->refused, 7);
    CHECK_INT(olp_device_get_health(&device)->malformed, 5);
    CHECK_INT(olp_device_get_health(&device)->overflows, 1);
    CHECK_INT(olp_device_get_health(&device)->checksums, 0);
}

static void acks_come_first(void)
{
    begin();
    /* The ack of a linksetup has the new setting; without checksum the sum is null. */
    CHECK(answers("c=linksetup&ack=on&t=1&id=IDMANG\n", "c=ack&checksum=null&t=1&id=IDMANG\n"
                                                        "c=linksetup_resp&ack=on&checksum=none&id=IDMANG&t=2\n"));
    CHECK(answers(SET_ON, "c=ack&checksum=null&t=11&id=" ID "\nc=setswitch_resp&state=1&pwm=254&id=" ID "&t=12\n"));
    CHECK(answers(SET_ON, "c=ack&checksum=null&t=11&id=" ID "\nc=setswitch_resp&state=1&pwm=254&id=" ID "&t=12\n"));
    CHECK(answers("c=nothing&t=15&id=" ID "\n", "c=ack&checksum=null&t=15&id=" ID "\n"
                                                "c=onerror&code=unknowncommand&t=15&id=" ID "\n"));
    CHECK(answers("c=nothing&t=16&id=nobody\n", "c=ack&checksum=null&t=16&id=nobody\n"
                                                "c=onerror&code=unknownid&t=16&id=nobody\n"));
    CHECK(answers("c=setswitch&state=1&id=" ID "\n", "c=ack&checksum=null&id=" ID "\n"
                                                     "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=17\n"));
    CHECK(answers("c=linksetup&ack=off&t=18&id=IDMANG\n", "c=linksetup_resp&ack=off&checksum=none&id=IDMANG&t=19\n"));
    /* The page's own numbers, but for its window and ids. */
    CHECK(answers("c=linksetup&ack=on&checksum=fletcher16&t=20&id=" ID "\n",
                  "c=ack&checksum=c703&t=20&id=" ID "\nc=linksetup_resp&ack=on&checksum=fletcher16&id=" ID "&t=21\n"));
    CHECK(answers_checked("c=setswitch&state=1&t=11&id=" ID,
                          "c=ack&checksum=a3d6&t=11&id=" ID "\nc=setswitch_resp&state=1&pwm=254&id=" ID "&t=22\n"));
    CHECK_INT(board.executed, 3);
}

static void checksums_in_force_are_needed(void)
{
    begin();
    CHECK(answers("c=linksetup&checksum=fletcher16&t=2&id=" ID "\n",
                  "c=linksetup_resp&ack=off&checksum=fletcher16&id=" ID "&t=3\n"));
    CHECK(answers(SET_ON, "c=onerror&code=checksum&t=4&id=IDMANG\n"));
    CHECK(answers(SET_ON, "c=onerror&code=checksum&t=5&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=11&id=" ID "&s=a3d7\n", "c=onerror&code=checksum&t=6&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=0&t=11&id=" ID "&s=a3d6\n", "c=onerror&code=checksum&t=7&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=11&id=" ID "&s=a3d\n", "c=onerror&code=checksum&t=8&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=11&s=a3d6&id=" ID "\n", "c=onerror&code=checksum&t=9&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=256&id=" ID "&s=a3d6\n", "c=onerror&code=checksum&t=10&id=IDMANG\n"));
    CHECK_INT(board.executed, 0);
    CHECK(answers("c=setswitch&state=1&t=11&id=" ID "&s=A3D6\n", IS_ON));
    CHECK_INT(board.executed, 1);
    CHECK_INT(olp_device_get_health(&device)->checksums, 7);

    /* A host that was restarted gets through: with a checksum at once, without when it repeats. */
    CHECK(answers_checked("c=linksetup&ack=on&t=0&id=" ID, "c=ack&checksum=cf5f&t=0&id=" ID "\n"
                                                           "c=linksetup_resp&ack=on&checksum=fletcher16&id=" ID "&t=13\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n", "c=onerror&code=checksum&t=14&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=on&t=0&id=" ID "\n", "c=onerror&code=checksum&t=15&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n", "c=onerror&code=checksum&t=16&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n", "c=linksetup_resp&ack=off&checksum=fletcher16&id=" ID "&t=17\n"));
    CHECK(answers("c=linksetup&checksum=none&t=0&id=" ID "\n", "c=onerror&code=checksum&t=18&id=IDMANG\n"));
    CHECK(answers("c=linksetup&checksum=none&t=0&id=" ID "\n", "c=linksetup_resp&ack=off&checksum=none&id=" ID "&t=19\n"));
    CHECK(answers("c=setswitch&state=1&t=19&id=" ID "\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=20\n"));
}

static void setups_are_settled(void)
{
    char expected[512];

    begin();
    sprintf(expected, "c=linksetup_resp&windowsize=%d&ack=off&checksum=none&id=IDMANG&t=1\n", OLP_WINDOW_MAX);
    CHECK(answers("c=linksetup&windowsize=65535&t=0&id=IDMANG\n", expected));
    CHECK(answers("c=linksetup&windowsize=0&t=1&id=IDMANG\n",
                  "c=linksetup_resp&windowsize=1&ack=off&checksum=none&id=IDMANG&t=2\n"));
    /* What is not said, or not understood, stays. */
    CHECK(answers("c=linksetup&t=2&id=IDMANG\n", "c=linksetup_resp&ack=off&checksum=none&id=IDMANG&t=3\n"));
    CHECK(answers("c=linksetup&ack=yes&checksum=crc16&t=3&id=IDMANG\n", "c=linksetup_resp&ack=off&checksum=none&id=IDMANG&t=4\n"));
    CHECK(answers("c=linksetup&ack=on&t=4&id=nobody\n", "c=onerror&code=unknownid&t=4&id=nobody\n"));
    CHECK(answers("c=setswitch&state=1&t=4&id=" ID "\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=5\n"));

    /* Its own. */
    CHECK_INT(olp_device_linksetup(&device, 1, 1, 1), OLP_RC_SUCCESS);
    CHECK_INT(poll_all(), OLP_RC_SUCCESS);
    CHECK(is_sent("c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=6&id=IDMANG\n"));
    CHECK(answers("c=setswitch&state=1&t=7&id=" ID "\n", "c=onerror&code=checksum&t=7&id=IDMANG\n"));
    CHECK(answers_checked("c=setswitch&state=1&t=11&id=" ID,
                          "c=ack&checksum=a3d6&t=11&id=" ID "\nc=setswitch_resp&state=1&pwm=254&id=" ID "&t=12\n"));

    /* A new connection begins like the first; an own setup comes behind the welcomes, and not again with the next. */
    CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    CHECK_INT(olp_device_linksetup(&device, 0, 0, OLP_WINDOW_MAX), OLP_RC_SUCCESS);
    CHECK_INT(poll_all(), OLP_RC_SUCCESS);
    sprintf(expected, "%sc=linksetup&windowsize=%d&ack=off&checksum=none&t=0&id=IDMANG\n", WELCOMES, OLP_WINDOW_MAX);
    CHECK(is_sent(expected));
    CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    CHECK_INT(poll_all(), OLP_RC_SUCCESS);
    CHECK(is_sent(WELCOMES));
}

/* A window's worth of commands is remembered, for a time. */
static void repeats_are_answered_but_not_executed(void)
{
    char line[80], answer[80];
    int i;

    begin();
    sprintf(line, "c=linksetup&windowsize=%d&t=0&id=IDMANG\n", OLP_WINDOW_MAX);
    receive(line, (int)strlen(line));
    sent[0] = '\0';
    for (i = 0; i < 3 * OLP_WINDOW_MAX; ++i) {
        int back, executed = board.executed;

        now += 2999;
        sprintf(line, "c=setswitch&state=%d&t=%d&id=" ID "\n", i, 10 + i);
        sprintf(answer, "c=setswitch_resp&state=%d&pwm=254&id=" ID "&t=%d\n", i, 11 + i);
        CHECK(answers(line, answer));
        for (back = 0; back < OLP_WINDOW_MAX && back <= i; ++back) {
            sprintf(line, "c=setswitch&state=%d&t=%d&id=" ID "\n", i - back, 10 + i - back);
            sprintf(answer, "c=setswitch_resp&state=%d&pwm=254&id=" ID "&t=%d\n", i - back, 11 + i - back);
            CHECK(answers(line, answer));
        }
        CHECK_INT(board.executed, executed + 1);
    }
    /* The window in force counts, not what could be: the last is remembered, the last but one not. */
    begin();
    receive(line, sprintf(line, "c=linksetup&windowsize=%d&t=0&id=IDMANG\n", OLP_WINDOW_MAX));
    sent[0] = '\0';
    CHECK(answers("c=linksetup&windowsize=1&t=100&id=IDMANG\n",
                  "c=linksetup_resp&windowsize=1&ack=off&checksum=none&id=IDMANG&t=101\n"));
    CHECK(answers("c=setswitch&state=1&t=101&id=" ID "\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=102\n"));
    CHECK(answers("c=setswitch&state=2&t=102&id=" ID "\n", "c=setswitch_resp&state=2&pwm=254&id=" ID "&t=103\n"));
    CHECK(answers("c=setswitch&state=2&t=102&id=" ID "\n", "c=setswitch_resp&state=2&pwm=254&id=" ID "&t=103\n"));
    CHECK(answers("c=setswitch&state=1&t=101&id=" ID "\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=104\n"));
    CHECK_INT(board.executed, 3);
    /* Another command of the same t is another command. */
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    CHECK_INT(board.executed, 4);
    /* Neither a damaged repeat nor an unknown command takes an answer's place. */
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "&s=1111\n", "c=onerror&code=checksum&t=106&id=IDMANG\n"));
    CHECK(answers("c=unheard&t=101&id=" ID "\n", "c=onerror&code=unknowncommand&t=101&id=" ID "\n"));
    CHECK(answers("c=unheard&t=101&id=IDMANG.1\n", "c=onerror&code=unknownid&t=101&id=IDMANG.1\n"));
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    CHECK_INT(board.executed, 4);
    /* Time. The counter of times wraps in here. */
    now += 2999;
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    now += 2999;
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    CHECK_INT(board.executed, 4);
    now += 3000;
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=107\n"));
    CHECK_INT(board.executed, 5);
    /* A linksetup begins anew: a host that starts counting again is heard. */
    CHECK(answers("c=linksetup&t=0&id=IDMANG\n", "c=linksetup_resp&ack=off&checksum=none&id=IDMANG&t=108\n"));
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=109\n"));
    CHECK_INT(board.executed, 6);
}

static void setting_of_time(void)
{
    struct olp_device_table table = TABLE;

    begin();
    table.repeat_ms = 10;
    CHECK_INT(olp_device_init(&device, &table, &usr_object), OLP_RC_SUCCESS);
    poll_all();
    sent[0] = '\0';
    CHECK(answers(SET_ON, IS_ON));
    now += 9;
    CHECK(answers(SET_ON, IS_ON));
    now += 10;
    CHECK(answers(SET_ON, "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=13\n"));
    CHECK_INT(board.executed, 2);
}

static int event(const char *name, const char *id)
{
    char line[OLP_REPLY_MAX];
    struct olp_encoder encoder;

    olp_begin(&encoder, line, sizeof line, name);
    olp_add_float(&encoder, "temp", 110.44f, 2);
    return olp_device_event(&device, &encoder, id);
}

/* The same command with the same t, 256 messages later, is a new one, however few commands came in between. */
static void counters_come_round(void)
{
    int i, executed_at = -1;

    begin();
    CHECK(answers(SET_ON, IS_ON));
    for (i = 0; i < 255; ++i) {
        CHECK_INT(event("heaterinfo", ID), OLP_RC_SUCCESS);
        if (i == 100 || i == 180) {
            sent[0] = '\0';
            CHECK(answers(SET_ON, IS_ON));
        }
        sent[0] = '\0';
    }
    CHECK_INT(board.executed, 1);
    CHECK(answers(SET_ON, IS_ON)); /* t comes to be 12 again */
    CHECK_INT(board.executed, 2);

    /* When it is forgotten. */
    begin();
    CHECK(answers(SET_ON, IS_ON));
    for (i = 0; i < 255 && executed_at < 0; ++i) {
        CHECK_INT(event("heaterinfo", ID), OLP_RC_SUCCESS);
        receive(SET_ON, (int)strlen(SET_ON));
        if (board.executed == 2)
            executed_at = i;
        sent[0] = '\0';
    }
    CHECK_INT(executed_at, 189);
}

static void events_count(void)
{
    char line[OLP_REPLY_MAX], small[20];
    struct olp_encoder encoder;

    begin();
    CHECK_INT(event("heaterinfo", ID), OLP_RC_SUCCESS);
    CHECK(is_sent("c=heaterinfo&temp=110.44&id=" ID "&t=0\n"));
    CHECK_INT(event("heaterinfo", "but.1"), OLP_RC_SUCCESS);
    CHECK(is_sent("c=heaterinfo&temp=110.44&id=but.1&t=1\n"));
    CHECK(answers(SET_ON, IS_ON));
    /* What can't be sent counts not. */
    CHECK_INT(event("heaterinfo", "nobody"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(event("heaterinfo", NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(event("heater info", ID), OLP_RC_NAME);
    olp_begin(&encoder, small, sizeof small, "button");
    CHECK_INT(olp_device_event(&device, &encoder, ID), OLP_RC_TOO_LONG);
    CHECK_INT(olp_device_event(&device, &encoder, ID), OLP_RC_TOO_LONG);
    CHECK_INT(olp_device_event(&device, NULL, ID), OLP_RC_ERROR_GENERIC);
    CHECK(is_sent(""));
    olp_begin(&encoder, line, sizeof line, "button");
    CHECK_INT(olp_device_event(&device, &encoder, ID), OLP_RC_SUCCESS);
    CHECK(is_sent("c=button&id=" ID "&t=13\n"));
    CHECK_INT(olp_device_event(&device, &encoder, ID), OLP_RC_ERROR_GENERIC); /* is sent already */
    CHECK(is_sent(""));
    /* Welcomes come first. */
    CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    CHECK_INT(event("heaterinfo", ID), OLP_RC_BUSY);
    poll_all();
    CHECK_INT(event("heaterinfo", ID), OLP_RC_SUCCESS);
}

static void answers_that_do_not_fit(void)
{
    begin();
    board.adds = 1;
    CHECK(answers("c=setswitch&state=1&t=0&id=" ID "\n", "c=setswitch_resp&state=1&x=&pwm=254&id=" ID "&t=1\n"));
    for (board.adds = 2; board.adds < OLP_REPLY_MAX; board.adds += 5) {
        char line[80], error[80];
        int executed = board.executed, length, rc;

        sprintf(line, "c=setswitch&state=1&t=%d&id=" ID "\n", board.adds);
        sprintf(error, "c=onerror&code=toolong&t=%d&id=" ID "\n", board.adds);
        length = (int)strlen("c=setswitch_resp&state=1&pwm=254&id=" ID "&t=\n") + 3 * board.adds;
        length += board.adds + 1 < 10 ? 1 : board.adds + 1 < 100 ? 2 : 3;
        rc = receive(line, (int)strlen(line));
        CHECK_INT(board.executed, executed + 1);
        if (length <= OLP_REPLY_MAX) {
            CHECK_INT(rc, OLP_RC_SUCCESS);
            CHECK_INT(strlen(sent), length);
            sent[0] = '\0';
        } else {
            CHECK_INT(rc, OLP_RC_TOO_LONG);
            CHECK(is_sent(error));
            CHECK(answers(line, error)); /* a repeat */
            CHECK_INT(board.executed, executed + 1);
        }
    }
    board.adds = 0;
    board.bad = "no name";
    CHECK_INT(receive(SET_ON, (int)strlen(SET_ON)), OLP_RC_NAME);
    CHECK(is_sent("c=onerror&code=toolong&t=11&id=" ID "\n"));
    board.bad = NULL;
    receive(SET_ON_ONCE, (int)strlen(SET_ON_ONCE));
    CHECK(strncmp(sent, IS_ON, strlen(IS_ON) - 3) == 0);
}

static void functions_may_call_again(void)
{
    begin();
    board.reenters = 1;
    CHECK(answers(SET_ON, "c=button&id=but.1&t=12\nc=setswitch_resp&state=1&id=" ID "&t=13\n"));
    CHECK(answers(SET_ON, "c=setswitch_resp&state=1&id=" ID "&t=13\n"));
    CHECK_INT(board.executed, 1);
    /* One that begins anew has nothing to answer. */
    board.reenters = 2;
    now += 3000;
    receive(SET_ON, (int)strlen(SET_ON));
    CHECK(strncmp(sent, "c=button&id=but.1&t=14\nc=welcome&", 33) == 0);
    CHECK(strstr(sent, "setswitch_resp") == NULL);
    poll_all();
    sent[0] = '\0';
    board.reenters = 0;
    CHECK(answers(SET_ON, IS_ON));
}

/* A line a call, a thing a call. */
static void one_thing_at_a_time(void)
{
    char both[160];
    int length, taken;

    begin();
    length = sprintf(both, "%s%s", SET_ON, "c=setswitch&state=0&t=12&id=" ID "\n");
    taken = olp_device_receive(&device, both, length, now);
    CHECK_INT(taken, strlen(SET_ON));
    CHECK_INT(olp_device_receive(&device, both + taken, length - taken, now), 0);
    CHECK_INT(board.executed, 0);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_SUCCESS);
    CHECK(is_sent(IS_ON));
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_NO_EVENT);
    CHECK_INT(olp_device_receive(&device, both + taken, length - taken, now), length - taken);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_SUCCESS);
    CHECK(is_sent("c=setswitch_resp&state=0&pwm=254&id=" ID "&t=13\n"));
    /* Byte by byte. */
    for (taken = 0; taken < (int)strlen(SET_ON) - 1; ++taken) {
        CHECK_INT(olp_device_receive(&device, SET_ON + taken, 1, now), 1);
        CHECK_INT(olp_device_poll(&device, now), OLP_RC_NO_EVENT);
    }
    CHECK(answers("\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=14\n") || OLP_WINDOW_MAX > 1);
    /* A welcome a call. */
    CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_SUCCESS);
    CHECK(is_sent("c=welcome&id=IDMANG&type=OzekiIDManager&pos=1&version=1.0.0\n"));
}

/* The page's sample: the same devices, the same commands, the same lines. */

static float temperatures[] = {110.44f, 121.01f, 125.93f, 128.28f, 129.48f, 129.87f, 130.47f,
                               131.15f, 131.15f, 131.71f, 131.65f, 132.22f};

static int setpushinfo(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    long state, interval;

    (void)usr;
    CHECK_INT(olp_get_int(command, "state", 0, &state), OLP_RC_SUCCESS);
    CHECK_INT(olp_get_int(command, "interval", 0, &interval), OLP_RC_SUCCESS);
    olp_add_int(answer, "state", state);
    olp_add_int(answer, "interval", interval);
    return 0;
}

static void heaterinfo(int place)
{
    char line[OLP_REPLY_MAX];
    struct olp_encoder encoder;

    olp_begin(&encoder, line, sizeof line, "heaterinfo");
    olp_add_float(&encoder, "temp", temperatures[place], 2);
    olp_add_float(&encoder, "desiredtemp", -1000, 2);
    olp_add_int(&encoder, "state", 0);
    CHECK_INT(olp_device_event(&device, &encoder, "M1F910"), OLP_RC_SUCCESS);
}

static void speaks_like_the_sample(void)
{
    static const struct olp_device_info devices[] = {
        {"0uAAly", "OzekiIDManager", 1, NULL, "1.0.0"},
        {"6O1KiA", "OzekiStepperMotorMultiController", 2, NULL, "1.0.0"},
        {"3Mx14T", "OzekiButtonController", 3, "StopYmin", "1.0.0"},
        {"xvnuu3", "OzekiButtonController", 4, "StopYmax", "1.0.0"},
        {"1988L4", "OzekiButtonController", 5, "StopZmin", "1.0.0"},
        {"M1F910", "OzekiTemperatureController", 6, "HeaterExt1", "1.0.0"},
        {"9o5qzg", "OzekiSwitchController", 7, "FanExt1", "1.0.0"},
    };
    static const struct olp_command commands[] = {{"M1F910", "setpushinfo", setpushinfo}, {"9o5qzg", "setswitch", setswitch}};
    static const struct olp_device_table table = {devices, 7, commands, 2, send_line, 0};
    int i;

    memset(&board, 0, sizeof board);
    sent[0] = '\0';
    CHECK_INT(olp_device_init(&device, &table, &usr_object), OLP_RC_SUCCESS);
    poll_all();
    CHECK(is_sent("c=welcome&id=0uAAly&type=OzekiIDManager&pos=1&version=1.0.0\n"
                  "c=welcome&id=6O1KiA&type=OzekiStepperMotorMultiController&pos=2&version=1.0.0\n"
                  "c=welcome&id=3Mx14T&type=OzekiButtonController&pos=3&name=StopYmin&version=1.0.0\n"
                  "c=welcome&id=xvnuu3&type=OzekiButtonController&pos=4&name=StopYmax&version=1.0.0\n"
                  "c=welcome&id=1988L4&type=OzekiButtonController&pos=5&name=StopZmin&version=1.0.0\n"
                  "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=6&name=HeaterExt1&version=1.0.0\n"
                  "c=welcome&id=9o5qzg&type=OzekiSwitchController&pos=7&name=FanExt1&version=1.0.0\n"));
    CHECK(answers("c=setpushinfo&interval=2000&state=1&t=0&id=M1F910\n",
                  "c=setpushinfo_resp&state=1&interval=2000&id=M1F910&t=1\n"));
    for (i = 0; i < 9; ++i)
        heaterinfo(i);
    CHECK(is_sent("c=heaterinfo&temp=110.44&desiredtemp=-1000.00&state=0&id=M1F910&t=2\n"
                  "c=heaterinfo&temp=121.01&desiredtemp=-1000.00&state=0&id=M1F910&t=3\n"
                  "c=heaterinfo&temp=125.93&desiredtemp=-1000.00&state=0&id=M1F910&t=4\n"
                  "c=heaterinfo&temp=128.28&desiredtemp=-1000.00&state=0&id=M1F910&t=5\n"
                  "c=heaterinfo&temp=129.48&desiredtemp=-1000.00&state=0&id=M1F910&t=6\n"
                  "c=heaterinfo&temp=129.87&desiredtemp=-1000.00&state=0&id=M1F910&t=7\n"
                  "c=heaterinfo&temp=130.47&desiredtemp=-1000.00&state=0&id=M1F910&t=8\n"
                  "c=heaterinfo&temp=131.15&desiredtemp=-1000.00&state=0&id=M1F910&t=9\n"
                  "c=heaterinfo&temp=131.15&desiredtemp=-1000.00&state=0&id=M1F910&t=10\n"));
    CHECK(answers("c=setswitch&state=1&t=11&id=9o5qzg\n", "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12\n"));
    heaterinfo(9);
    CHECK(is_sent("c=heaterinfo&temp=131.71&desiredtemp=-1000.00&state=0&id=M1F910&t=13\n"));
    CHECK(answers("c=setswitch&state=0&t=14&id=9o5qzg\n", "c=setswitch_resp&state=0&pwm=254&id=9o5qzg&t=15\n"));
    heaterinfo(10);
    heaterinfo(11);
    CHECK(is_sent("c=heaterinfo&temp=131.65&desiredtemp=-1000.00&state=0&id=M1F910&t=16\n"
                  "c=heaterinfo&temp=132.22&desiredtemp=-1000.00&state=0&id=M1F910&t=17\n"));
}

/* Bytes from the wire: any; and whole commands among them are answered all the same. */
static void noise_does_no_harm(void)
{
    static const char ALPHABET[] = "c=&%s0123456789abcdef+\n\ris_t=\xFF";
    unsigned long seed = 0x2545F491;
    int round, i;

    begin();
    for (round = 0; round < 3000; ++round) {
        char bytes[200];
        int count = (int)(seed >> 8) % 200;

        for (i = 0; i < count; ++i) {
            seed = (seed * 1103515245ul + 12345ul) & 0xFFFFFFFFul;
            bytes[i] = seed & 0x800000 ? (char)(seed >> 16) : ALPHABET[(seed >> 16) % (sizeof ALPHABET - 1)];
        }
        now += 4000;
        receive(bytes, count);
        receive("\n", 1);
        CHECK_INT(board.executed, round);
        sent[0] = '\0';
        receive(SET_ON_ONCE, (int)strlen(SET_ON_ONCE));
        CHECK_INT(board.executed, round + 1);
        CHECK(strncmp(sent, IS_ON, strlen(IS_ON) - 3) == 0);
        sent[0] = '\0';
    }
}

/* A device whose private contents were overwritten, but for what it was made of, still stays within them. */
static void damaged_devices_do_no_harm(void)
{
    static struct {
        unsigned char before[64];
        struct olp_device device;
        unsigned char after[64];
    } guarded;
    static const unsigned char FILLS[] = {0x00, 0x01, 0x3F, 0x7F, 0x80, 0xFE, 0xFF};
    size_t i, k;

    for (i = 0; i < sizeof FILLS; ++i) {
        memset(&guarded, 0xA5, sizeof guarded);
        CHECK_INT(olp_device_init(&guarded.device, &TABLE, &usr_object), OLP_RC_SUCCESS);
        memset(&guarded.device.link, FILLS[i], sizeof guarded.device.link);
        memset(&guarded.device.input, FILLS[i], sizeof guarded.device.input);
        guarded.device.welcomed = FILLS[i] & 1 ? INT_MAX : INT_MIN;
        for (k = 0; k < 20; ++k) {
            olp_device_receive(&guarded.device, SET_ON, (int)strlen(SET_ON), now);
            olp_device_poll(&guarded.device, now);
            sent[0] = '\0';
        }
        for (k = 0; k < 64; ++k)
            CHECK(guarded.before[k] == 0xA5 && guarded.after[k] == 0xA5);
    }
    memset(&board, 0, sizeof board);
}

static int init_with(const struct olp_device_info *info, int count)
{
    static struct olp_device_table table; /* the device goes on with it */

    table = TABLE;
    table.devices = info;
    table.device_count = count;
    return olp_device_init(&device, &table, &usr_object);
}

static void bad_tables_are_refused(void)
{
    static const char *const BAD_IDS[] = {NULL, "", "12345678901", "a b", "a&b", "a%b", "\xC3\xA4"};
    struct olp_device_info info = {"M1F910", "X", INT_MIN, NULL, NULL};
    struct olp_command command = {NULL, NULL, setswitch};
    struct olp_device_table table = TABLE;
    char name[OLP_REPLY_MAX + 1];
    size_t i;

    CHECK_INT(olp_device_init(NULL, &TABLE, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_init(&device, NULL, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_ERROR_GENERIC);
    CHECK_INT(init_with(&info, 1), OLP_RC_SUCCESS);
    CHECK_INT(init_with(&info, 0), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_ERROR_GENERIC);
    CHECK_INT(init_with(&info, -1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(init_with(NULL, 1), OLP_RC_ERROR_GENERIC);
    for (i = 0; i < sizeof BAD_IDS / sizeof BAD_IDS[0]; ++i) {
        info.id = BAD_IDS[i];
        CHECK_INT(init_with(&info, 1), OLP_RC_ERROR_GENERIC);
    }
    info.id = "1234567890";
    CHECK_INT((int)strlen(info.id), OLP_ID_MAX);
    CHECK_INT(init_with(&info, 1), OLP_RC_SUCCESS);
    info.type = NULL;
    CHECK_INT(init_with(&info, 1), OLP_RC_ERROR_GENERIC);
    /* The longest welcome. */
    info.type = "X";
    info.pos = 0;
    memset(name, 'n', sizeof name);
    name[OLP_REPLY_MAX - strlen("c=welcome&id=1234567890&type=X&name=\n")] = '\0';
    info.name = name;
    CHECK_INT(init_with(&info, 1), OLP_RC_SUCCESS);
    sent[0] = '\0';
    poll_all();
    CHECK_INT(strlen(sent), OLP_REPLY_MAX);
    name[strlen(name)] = 'n';
    name[OLP_REPLY_MAX] = '\0';
    CHECK_INT(init_with(&info, 1), OLP_RC_TOO_LONG);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_ERROR_GENERIC);

    table.send = NULL;
    CHECK_INT(olp_device_init(&device, &table, NULL), OLP_RC_ERROR_GENERIC);
    table = TABLE;
    table.commands = NULL;
    CHECK_INT(olp_device_init(&device, &table, NULL), OLP_RC_ERROR_GENERIC);
    table.command_count = -1;
    CHECK_INT(olp_device_init(&device, &table, NULL), OLP_RC_ERROR_GENERIC);
    table.command_count = 0;
    CHECK_INT(olp_device_init(&device, &table, &usr_object), OLP_RC_SUCCESS);
    poll_all();
    sent[0] = '\0';
    CHECK(answers(SET_ON, "c=onerror&code=unknowncommand&t=11&id=" ID "\n"));
    table.commands = &command;
    table.command_count = 1;
    CHECK_INT(olp_device_init(&device, &table, NULL), OLP_RC_ERROR_GENERIC);
}

static void bad_arguments_are_refused(void)
{
    struct olp_encoder encoder;

    begin();
    CHECK_INT(olp_device_receive(&device, NULL, 1, now), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_receive(&device, "x", INT_MIN, now), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_receive(&device, NULL, 0, now), 0);
    CHECK_INT(olp_device_linksetup(&device, 0, 0, 0), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(&device, 0, 0, -1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(&device, 0, 0, OLP_WINDOW_MAX + 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(&device, 0, 0, 65536 + 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_NO_EVENT);

    memset(&device, 0, sizeof device);
    memset(&encoder, 0, sizeof encoder);
    CHECK_INT(olp_device_receive(&device, "x", 1, now), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_restart(&device), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(&device, 1, 1, 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_event(&device, &encoder, ID), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_get_health(&device)->commands, 0);

    CHECK_INT(olp_device_receive(NULL, "x", 1, now), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(NULL, now), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_restart(NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(NULL, 1, 1, 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_event(NULL, &encoder, ID), OLP_RC_ERROR_GENERIC);
    CHECK(olp_device_get_health(NULL) == NULL);
}

int main(void)
{
    commands_are_executed_and_answered();
    what_cannot_be_executed_is_an_error();
    acks_come_first();
    checksums_in_force_are_needed();
    setups_are_settled();
    repeats_are_answered_but_not_executed();
    setting_of_time();
    counters_come_round();
    events_count();
    answers_that_do_not_fit();
    functions_may_call_again();
    one_thing_at_a_time();
    if (OLP_REPLY_MAX >= 96)
        speaks_like_the_sample();
    noise_does_no_harm();
    damaged_devices_do_no_harm();
    bad_tables_are_refused();
    bad_arguments_are_refused();
    return check_summary("line_device");
}
