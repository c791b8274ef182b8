/* line_device.h: what is answered to each line, in which order, and what is executed how often. */
#include "device_steps.h"

/* The line with its checksum. */
static int answers_checked(const char *text, const char *expected)
{
    char line[256];
    sprintf(line, "%s&s=%04x\n", text, olp_fletcher16(text, (int)strlen(text)));
    return answers(line, expected);
}

/* All settings are off at first: only the answer. */
static void commands_are_executed_and_answered(void)
{
    begin();
    CHECK(answers(SET_ON, IS_ON));
    CHECK_INT(board.executed, 1);
    CHECK_INT(board.state, 1);
    CHECK(answers("c=setswitch&state=0&t=14&id=" ID "\r\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=15\n"));
    CHECK(answers("c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IDMANG\n",
                  "c=go_resp&c=60&id=IDMANG&t=16\n"));
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
    char line[81];

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
    line[79] = '\n';
    receive(line, 80);
    CHECK(is_sent("c=onerror&code=malformed&t=16&id=IDMANG\n"));
    line[79] = 'x';
    line[80] = '\n';
    receive(line, 81);
    CHECK(is_sent("c=onerror&code=overflow&t=17&id=IDMANG\n"));
    /* 63 bytes, the end not counted. */
    CHECK(answers("c=greet&text=yyyyyyyyyyyyyyyyyyyyyyyyyyyy&zzzzzz&t=18&id=" ID "\r\n",
                  "c=greet_resp&text=yyyyyyyyyyyyyyyyyyyyyyyyyyyy&id=" ID "&t=19\n"));
    CHECK_INT(health().commands, 9);
    CHECK_INT(health().repeats, 1);
    CHECK_INT(health().refused, 7);
    CHECK_INT(health().malformed, 5);
    CHECK_INT(health().overflows, 1);
    CHECK_INT(health().checksums, 0);
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
    CHECK_INT(health().checksums, 7);

    /* A host that was restarted gets through: with a checksum at once, without when it repeats. */
    CHECK(answers_checked("c=linksetup&ack=on&t=0&id=" ID,
                          "c=ack&checksum=cf5f&t=0&id=" ID "\n"
                          "c=linksetup_resp&ack=on&checksum=fletcher16&id=" ID "&t=13\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n", "c=onerror&code=checksum&t=14&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=on&t=0&id=" ID "\n", "c=onerror&code=checksum&t=15&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n", "c=onerror&code=checksum&t=16&id=IDMANG\n"));
    CHECK(answers("c=linksetup&ack=off&t=0&id=" ID "\n",
                  "c=linksetup_resp&ack=off&checksum=fletcher16&id=" ID "&t=17\n"));
    CHECK(answers("c=linksetup&checksum=none&t=0&id=" ID "\n", "c=onerror&code=checksum&t=18&id=IDMANG\n"));
    CHECK(answers("c=linksetup&checksum=none&t=0&id=" ID "\n",
                  "c=linksetup_resp&ack=off&checksum=none&id=" ID "&t=19\n"));
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
    CHECK(answers("c=linksetup&ack=yes&checksum=crc16&t=3&id=IDMANG\n",
                  "c=linksetup_resp&ack=off&checksum=none&id=IDMANG&t=4\n"));
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

        now += 4999;
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
    now += 4999;
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    now += 4999;
    CHECK(answers("c=setswitch&state=0&t=101&id=" ID "\n", "c=setswitch_resp&state=0&pwm=254&id=" ID "&t=105\n"));
    CHECK_INT(board.executed, 4);
    now += 5000;
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
    /* What was forgotten, by a quarter of a second later, stays so when the clock has come round. */
    now += 10 + 256;
    poll_all();
    now -= 10 + 256;
    CHECK(answers(SET_ON, "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=14\n"));
    CHECK_INT(board.executed, 3);
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
    return check_summary("line_device");
}
