/* line_device.h, the rest: events, functions that call again, the page's sample, noise, tables that can't be. */
#include "device_steps.h"
#include "sample.h"
#include "wire.h"

#include <limits.h>

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
    now += 5000;
    receive(SET_ON, (int)strlen(SET_ON));
    CHECK(strncmp(sent, "c=button&id=but.1&t=14\nc=welcome&", 33) == 0);
    CHECK(strstr(sent, "setswitch_resp") == NULL);
    poll_all();
    sent[0] = '\0';
    board.reenters = 0;
    CHECK(answers(SET_ON, IS_ON));
}

static void sending_may_call_again(void)
{
    begin();
    /* Nothing is taken that would be lost. */
    board.receives = 1;
    CHECK(answers(SET_ON, IS_ON));
    CHECK(answers("c=linksetup&ack=on&t=12&id=IDMANG\n", "c=ack&checksum=null&t=12&id=IDMANG\n"
                                                          "c=linksetup_resp&ack=on&checksum=none&id=IDMANG&t=13\n"));
    /* One that begins anew has nothing to answer, nor to execute. */
    board.receives = 0;
    board.restarts = 1;
    receive("c=setswitch&state=1&t=13&id=" ID "\n", (int)strlen("c=setswitch&state=1&t=13&id=" ID "\n"));
    CHECK(strncmp(sent, "c=ack&checksum=null&t=13&id=" ID "\nc=welcome&", 44) == 0);
    CHECK(strstr(sent, "onerror") == NULL && strstr(sent, "_resp") == NULL);
    CHECK_INT(board.executed, 1);
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
    for (taken = 0; taken < (int)strlen(SET_ON_ONCE) - 1; ++taken) {
        CHECK_INT(olp_device_receive(&device, SET_ON_ONCE + taken, 1, now), 1);
        CHECK_INT(olp_device_poll(&device, now), OLP_RC_NO_EVENT);
    }
    CHECK(answers("\n", "c=setswitch_resp&state=1&pwm=254&id=" ID "&t=14\n"));
    /* A welcome a call. */
    CHECK_INT(olp_device_restart(&device), OLP_RC_SUCCESS);
    CHECK_INT(olp_device_poll(&device, now), OLP_RC_SUCCESS);
    CHECK(is_sent("c=welcome&id=IDMANG&type=OzekiIDManager&pos=1&version=1.0.0\n"));
}

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

/* With the temperature of that line. */
static void heaterinfo(const char *of)
{
    char line[OLP_REPLY_MAX];
    struct olp_encoder encoder;
    struct olp_message message;
    float temp;

    CHECK_INT(olp_parse(of, (int)strlen(of), &message), OLP_RC_SUCCESS);
    CHECK_INT(olp_get_float(&message, "temp", 0, &temp), OLP_RC_SUCCESS);
    olp_begin(&encoder, line, sizeof line, "heaterinfo");
    olp_add_float(&encoder, "temp", temp, 2);
    olp_add_float(&encoder, "desiredtemp", -1000, 2);
    olp_add_int(&encoder, "state", 0);
    CHECK_INT(olp_device_event(&device, &encoder, "M1F910"), OLP_RC_SUCCESS);
}

/* The same devices, the same commands, the same lines, but for those of the motors and of the disc. */
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
    static const struct olp_command commands[] = {
        {"M1F910", "setpushinfo", setpushinfo},
        {"9o5qzg", "setswitch", setswitch},
    };
    static const struct olp_device_table table = {devices, 7, commands, 2, send_line, 0};
    int i, compared = 0;

    memset(&board, 0, sizeof board);
    sent[0] = '\0';
    CHECK_INT(olp_device_init(&device, &table, &usr_object), OLP_RC_SUCCESS);
    for (i = 0; i < SAMPLE_LINES; ++i) {
        const char *line = SAMPLE[i];
        char expected[OLP_REPLY_MAX + 2];

        sprintf(expected, "%.*s\n", OLP_REPLY_MAX, line + (*line == '>'));
        if (*line == '>') {
            receive(expected, (int)strlen(expected));
            continue; /* the answer is the next line */
        }
        if (strncmp(line, "c=motor", 7) == 0 || strstr(line, "OZPDSC") != NULL)
            continue;
        if (strncmp(line, "c=welcome", 9) == 0)
            CHECK_INT(olp_device_poll(&device, now), OLP_RC_SUCCESS);
        if (strncmp(line, "c=heaterinfo", 12) == 0)
            heaterinfo(line);
        CHECK(is_sent(expected));
        ++compared;
    }
    CHECK_INT(compared, 7 + 3 + 12);
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
        int count = (int)(wire_random(&seed) % 200);

        wire_random_bytes(&seed, bytes, (size_t)count);
        for (i = 0; i < count; ++i)
            if (wire_random(&seed) % 2)
                bytes[i] = ALPHABET[wire_random(&seed) % (sizeof ALPHABET - 1)];
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
        /* All but the addresses of the table and of usr. */
        for (k = 0; k < sizeof guarded.device / sizeof *guarded.device.opaque; ++k)
            if (guarded.device.opaque[k] != (LIBDELTAROBOT_WORD)&TABLE &&
                guarded.device.opaque[k] != (LIBDELTAROBOT_WORD)&usr_object)
                memset(&guarded.device.opaque[k], FILLS[i], sizeof *guarded.device.opaque);
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

/* The page's conversation with acks and checksums, and its full linksetup, longer than the page allows. */
static void as_the_page_prints_it(void)
{
    static const struct olp_device_info MANAGER = {"sf6z34", "OzekiIDManager", 1, NULL, NULL};

    memset(&board, 0, sizeof board);
    CHECK_INT(init_with(&MANAGER, 1), OLP_RC_SUCCESS);
    poll_all();
    sent[0] = '\0';
    CHECK(answers("c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34\n",
                  "c=ack&checksum=d293&t=2&id=sf6z34\n"
                  "c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=3\n"));
    CHECK_INT(init_with(&MANAGER, 1), OLP_RC_SUCCESS);
    poll_all();
    sent[0] = '\0';
    CHECK(answers("c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=2&id=sf6z34\n",
                  "c=ack&checksum=7b7f&t=2&id=sf6z34\n"
                  "c=linksetup_resp&windowsize=1&ack=on&checksum=fletcher16&id=sf6z34&t=3\n"));
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
    CHECK_INT(init_with(&DEVICES[1], 1), OLP_RC_SUCCESS);
    {
        struct olp_device_info twins[3];
        twins[0] = DEVICES[0];
        twins[1] = DEVICES[1];
        twins[2] = DEVICES[0];
        CHECK_INT(init_with(twins, 2), OLP_RC_SUCCESS);
        CHECK_INT(init_with(twins, 3), OLP_RC_ERROR_GENERIC);
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
    struct olp_device_health counters;
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
    CHECK_INT(health().commands, 0);

    CHECK_INT(olp_device_receive(NULL, "x", 1, now), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_poll(NULL, now), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_restart(NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_linksetup(NULL, 1, 1, 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_event(NULL, &encoder, ID), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_get_health(NULL, &counters), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_device_get_health(&device, NULL), OLP_RC_ERROR_GENERIC);
}

int main(void)
{
    events_count();
    answers_that_do_not_fit();
    functions_may_call_again();
    sending_may_call_again();
    one_thing_at_a_time();
    if (OLP_REPLY_MAX >= 96)
        speaks_like_the_sample();
    noise_does_no_harm();
    damaged_devices_do_no_harm();
    as_the_page_prints_it();
    bad_tables_are_refused();
    bad_arguments_are_refused();
    return check_summary("line_device_calls");
}
