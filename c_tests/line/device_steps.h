/* A device of the line protocol and the board behind it: what the tests of line_device.h share. */
#ifndef LINE_DEVICE_STEPS_H
#define LINE_DEVICE_STEPS_H

#include "libdeltarobot/line_device.h"

#include "check.h"

#define ID "9o5qzg"

static struct olp_device device;
static int usr_object;
static unsigned long now;

static char sent[4096]; /* the lines sent */
static struct {
    int executed, refuses, reenters, adds; /* adds: so many bytes more in the answer */
    int receives, restarts;                /* while a line is sent */
    long state;
    const char *bad; /* what is wrong with the answer */
} board;

static struct olp_device_health health(void)
{
    struct olp_device_health counters;
    memset(&counters, 0xA5, sizeof counters);
    CHECK_INT(olp_device_get_health(&device, &counters), OLP_RC_SUCCESS);
    return counters;
}

static int send_line(const void *line, int bytes, void *usr)
{
    CHECK(usr == &usr_object);
    CHECK(bytes > 0 && bytes <= (OLP_REPLY_MAX > 255 ? OLP_REPLY_MAX : 255));
    CHECK_INT(((const char *)line)[bytes - 1], '\n');
    CHECK(memchr(line, '\n', (size_t)bytes) == (const char *)line + bytes - 1);
    if (strlen(sent) + (size_t)bytes < sizeof sent)
        strncat(sent, line, (size_t)bytes);
    if (board.receives)
        CHECK_INT(olp_device_receive(&device, "c=x\n", 4, now), 0);
    if (board.restarts && strncmp(line, "c=ack", 5) == 0)
        CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
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

static int event(const char *name, const char *id)
{
    char line[OLP_REPLY_MAX];
    struct olp_encoder encoder;

    olp_begin(&encoder, line, sizeof line, name);
    olp_add_float(&encoder, "temp", 110.44f, 2);
    return olp_device_event(&device, &encoder, id);
}

#endif
