/* line_host.h, the rest: setting up the link, devices that start anew, numbers, lines that are lost, bad arguments. */
#include "host_steps.h"
#include "wire.h"

#include <limits.h>

static const char GO[] = "c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1";

static void setting_up(void)
{
    char text[128];
    int handle, i;

    /* Never answered: with and without a checksum in turn, as the device may have them in force. */
    begin();
    handle = olp_host_setup(&host, "sf6z34", 1, 1, -1);
    for (i = 0; i < 4; ++i) {
        CHECK(sends(i % 2 ? "c=linksetup&ack=on&checksum=fletcher16&t=0&id=sf6z34&s=bc91\n"
                          : "c=linksetup&ack=on&checksum=fletcher16&t=0&id=sf6z34\n"));
        time_out();
    }
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));
    /* Acknowledged, so it must be in force. */
    handle = olp_host_setup(&host, "sf6z34", 1, 1, -1);
    CHECK(sends("c=linksetup&ack=on&checksum=fletcher16&t=1&id=sf6z34\n"));
    acks_last();
    CHECK(acked(handle));
    for (i = 0; i < 4; ++i) {
        CHECK(tells_nothing());
        CHECK_INT(olp_host_output(&host, out, ALL, now) > 0, i > 0);
        time_out();
    }
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));
    CHECK(linked(1, 1, 1));

    /* A device that has checksums in force says so. */
    begin();
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    comes("c=onerror&code=checksum&t=80&id=9o5qzg");
    CHECK(tells(OLP_HOST_ERROR));
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 1, 1));
    CHECK(tells_nothing());
    CHECK_INT(olp_host_output(&host, text, sizeof text, now), 41);
    text[41] = '\0';
    CHECK(!strncmp(text, "c=setswitch&state=1&t=0&id=9o5qzg&s=", 36));

    /* What is asked for has to be answered legibly. */
    begin();
    handle = olp_host_setup(&host, "sf6z34", 1, 0, -1);
    CHECK(sends("c=linksetup&ack=on&checksum=none&t=0&id=sf6z34\n"));
    comes("c=linksetup_resp&abk=on&checksum=none&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINE));
    comes("c=linksetup_resp&ack=oo&checksum=none&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINE));
    comes("c=linksetup_resp&windowsize=99999&ack=on&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINE));
    comes("c=linksetup_resp&windowsize=7&ack=off&checksum=none&id=sf6z34"); /* less than was asked for */
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 0, 1)); /* of the window, never more */
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    /* A late one counts too, though nothing waits for it. */
    comes("c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=2");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(1, 1, 1));
    CHECK(tells(OLP_HOST_LINE));

    /* Its parameters, and what does not fit. */
    begin();
    CHECK_INT(olp_host_setup(&host, "sf6z34", 1, 1, 1), -OLP_RC_TOO_LONG);
    CHECK(olp_host_setup(&host, "sf6z34", -1, -1, 65535) > 0);
    CHECK(sends("c=linksetup&windowsize=65535&t=0&id=sf6z34\n"));
    comes("c=linksetup_resp&ack=off&id=sf6z34&windowsize=3&t=1");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 0, 3));
    CHECK(tells(OLP_HOST_ENDED));
    CHECK(olp_host_setup(&host, "sf6z34", 0, -1, -1) > 0);
    CHECK(sends("c=linksetup&ack=off&t=2&id=sf6z34\n"));

    /* Too long only when its turn comes. */
    begin();
    olp_host_setup(&host, "sf6z34", -1, 1, -1);
    CHECK(sends("c=linksetup&checksum=fletcher16&t=0&id=sf6z34\n"));
    if (OLP_WINDOW_MAX > 1) {
        handle = asks(GO, "IqlZci");
        comes("c=linksetup_resp&ack=off&checksum=fletcher16&id=sf6z34&t=1");
        CHECK(tells(OLP_HOST_LINKSETUP));
        CHECK(tells(OLP_HOST_ENDED));
        CHECK_INT(olp_host_output(&host, out, ALL, now), 0);
        CHECK(ended(handle, OLP_HOST_NOT_SENT));
        CHECK_INT(asks(GO, "IqlZci"), -OLP_RC_TOO_LONG);
    }
}

static void device_starts_anew(void)
{
    int handle, setup;

    begin_linked(LINK_ALL, 1, 1, 1);
    comes("c=welcome&id=sf6z34&type=OzekiIDManager");
    CHECK(tells(OLP_HOST_WELCOME));
    comes("c=welcome&id=9o5qzg&type=OzekiSwitchController");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK(linked(1, 1, 1));
    comes("c=heaterinfo&t=9");
    CHECK(tells(OLP_HOST_LINE));
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(tells_nothing());
    CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
    setup = OLP_WINDOW_MAX > 1 ? olp_host_setup(&host, "sf6z34", 1, 0, -1) : 0;
    comes("c=welcome&id=sf6z34&type=OzekiIDManager");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 0, 1));
    CHECK(ended(handle, OLP_HOST_RESTARTED));
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK_INT(event.device, 0);
    /* What was not sent yet is. */
    if (setup) {
        CHECK(sends("c=linksetup&ack=on&checksum=none&t=0&id=sf6z34\n"));
        comes("c=welcome&id=9o5qzg&type=OzekiSwitchController"); /* of the same start */
        CHECK(tells(OLP_HOST_WELCOME));
        CHECK(tells_nothing());
        comes("c=linksetup_resp&ack=on&checksum=none&id=sf6z34&t=1");
        CHECK(tells(OLP_HOST_LINKSETUP));
        CHECK(ended(setup, OLP_HOST_ANSWERED));
        CHECK(linked(1, 0, 1));
    } else {
        comes("c=welcome&id=9o5qzg&type=OzekiSwitchController");
        CHECK(tells(OLP_HOST_WELCOME));
    }
    CHECK_INT(health().restarts, 1);

    /* Once more, with its own linksetup first; the setup under way goes on. */
    setup = olp_host_setup(&host, "sf6z34", 0, 0, -1);
    CHECK(tells_nothing());
    CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
    comes(LINK_ALL);
    CHECK(tells(OLP_HOST_LINKSETUP));
    comes("c=welcome&id=9o5qzg");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK(linked(1, 1, 1));
    CHECK_INT(health().restarts, 2);
    comes("c=linksetup_resp&ack=off&checksum=none&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(ended(setup, OLP_HOST_ANSWERED));
}

#define LONG_ID "abcdefghijklmno"

/* What was asked for is asked for again, in front of the next command; of that no end is told. */
static void a_restarted_device_is_set_up_again(void)
{
    int handle;

    begin();
    comes("c=welcome&id=sf6z34&type=OzekiIDManager");
    CHECK(tells(OLP_HOST_WELCOME));
    handle = olp_host_setup(&host, "sf6z34", 1, 1, -1);
    CHECK(sends("c=linksetup&ack=on&checksum=fletcher16&t=0&id=sf6z34\n"));
    comes("c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    handle = olp_host_setup(&host, "sf6z34", -1, -1, 2);
    CHECK(tells_nothing());
    CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
    comes("c=linksetup_resp&windowsize=2&ack=on&checksum=fletcher16&id=sf6z34&t=3");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    CHECK(linked(1, 1, 2));

    comes("c=welcome&id=sf6z34&type=OzekiIDManager");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 0, 1));
    CHECK(tells(OLP_HOST_WELCOME));
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(handle > 0);
    CHECK(sends("c=linksetup&ack=on&checksum=fletcher16&t=1&id=sf6z34\n"));
    acks_last();
    CHECK(tells_nothing());
    comes("c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=2");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(1, 1, 1));
    CHECK(sends("c=linksetup&windowsize=2&t=3&id=sf6z34&s=909e\n"));
    acks_last();
    CHECK(tells_nothing());
    comes("c=linksetup_resp&windowsize=2&ack=on&checksum=fletcher16&id=sf6z34&t=4");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(1, 1, 2));
    CHECK(sends("c=setswitch&state=1&t=5&id=9o5qzg&s=6fa9\n"));
    acks_last();
    CHECK(acked(handle));
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=6");
    CHECK(ended(handle, OLP_HOST_ANSWERED));

    /* One that says by itself, before its welcomes or behind them, that it has all of that is not asked. */
    comes("c=linksetup&windowsize=2&ack=on&checksum=fletcher16&t=0&id=sf6z");
    CHECK(tells(OLP_HOST_LINKSETUP));
    comes("c=welcome&id=sf6z34&type=OzekiIDManager");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK(linked(1, 1, 2));
    CHECK(sends(""));
    CHECK_INT(health().restarts, 2);

    /* With the longest id, checksums that come into force meanwhile make it too long: nothing is told of that either. */
    begin();
    comes("c=welcome&id=" LONG_ID);
    CHECK(tells(OLP_HOST_WELCOME));
    handle = olp_host_setup(&host, LONG_ID, 1, 1, -1);
    CHECK(sends("c=linksetup&ack=on&checksum=fletcher16&t=0&id=" LONG_ID "\n"));
    comes("c=linksetup_resp&ack=on&checksum=fletcher16&id=" LONG_ID);
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    comes("c=welcome&id=" LONG_ID);
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK(linked(0, 0, 1));
    comes("c=linksetup&ack=off&checksum=fletcher16");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(0, 1, 1));
    CHECK(sends(""));
    CHECK(tells_nothing());
    CHECK_INT(olp_host_next_deadline(&host, now), -1);
}

/* A device that counts its own messages alone, as the device pages have it. */
static void numbers_of_each_end_apart(void)
{
    char line[64];
    int i, handle;

    begin();
    for (i = 0; i < 300; ++i) {
        sprintf(line, "c=x&t=%d", i & 255);
        comes(line);
        CHECK(tells(OLP_HOST_LINE));
        handle = asks("c=y", "x");
        CHECK(tells_nothing());
        CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
        comes("c=y_resp&id=x");
        CHECK(ended(handle, OLP_HOST_ANSWERED));
    }
    CHECK_INT(health().lost, 0);
    comes("c=x&t=47");
    CHECK(tells(OLP_HOST_LOST));
    CHECK_INT(event.lost, 3);
}

static void numbers(void)
{
    char line[128];
    int i, handle;

    /* Gaps. */
    begin();
    comes("c=x&t=250");
    CHECK(tells(OLP_HOST_LINE));
    comes("c=x&t=3");
    CHECK(tells(OLP_HOST_LOST));
    CHECK_INT(event.lost, 8);
    CHECK(tells(OLP_HOST_LINE));
    comes("c=x&t=3"); /* behind */
    CHECK(tells(OLP_HOST_LINE));
    comes("c=x&t=0");
    CHECK(tells(OLP_HOST_LINE));
    CHECK_INT(health().lost, 8);

    /* The same command with the same t, 256 messages later, would be taken for a repeat. */
    begin();
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    comes("c=setswitch_resp&id=9o5qzg&t=1");
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    for (i = 2; i < 256; ++i) {
        sprintf(line, "c=heaterinfo&t=%d", i);
        comes(line);
        CHECK(tells(OLP_HOST_LINE));
    }
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=1&id=9o5qzg\n"));

    /* A line that is too long with three digits gets fewer. */
    begin();
    comes("c=x&t=119");
    CHECK(tells(OLP_HOST_LINE));
    for (i = 0; i < 130; ++i) {
        handle = asks(GO, "IqlZci");
        CHECK(tells_nothing());
        CHECK(olp_host_output(&host, out, ALL - 1, now) <= OLP_COMMAND_MAX);
        CHECK(sent_t() >= 0 && sent_t() < 100);
        CHECK_INT(sent_t(), i % 65); /* one that none of the last 64 had */
        comes("c=go_resp&id=IqlZci&t=120");
        CHECK(ended(handle, OLP_HOST_ANSWERED));
    }
}

static void the_table(void)
{
    struct olp_host_device device;
    char line[400];
    int i;

    begin();
    for (i = 0; i < OLP_DEVICES_MAX; ++i) {
        sprintf(line, "c=welcome&id=d%d&name=Heater%%20%d&pos=%d", i, i, i);
        comes(line);
        CHECK(tells(OLP_HOST_WELCOME));
        CHECK_INT(event.device, i);
        CHECK_INT(event.error, OLP_RC_SUCCESS);
        sprintf(line, "Heater %d", i);
        CHECK_INT(olp_host_get_device(&host, i, &device), OLP_RC_SUCCESS);
        CHECK(!strcmp(device.name, line));
        CHECK_INT(device.pos, i);
    }
    comes("c=welcome&id=last");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK_INT(event.device, -1);
    CHECK_INT(event.error, OLP_RC_OVERFLOW);
    CHECK(has_line("c=welcome&id=last"));
    begin();
    comes("c=welcome&type=x");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK_INT(event.device, -1);
    CHECK_INT(event.error, OLP_RC_NOT_FOUND);
    comes("c=welcome&id=0123456789abcdef");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK_INT(event.device, -1);
    CHECK_INT(event.error, OLP_RC_TOO_LONG);
    comes("c=welcome&id=0123456789abcde&version=0123456789abcdef");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK_INT(event.device, 0);
    CHECK_INT(event.error, OLP_RC_TOO_LONG);
    CHECK_INT(olp_host_get_device(&host, 0, &device), OLP_RC_SUCCESS);
    CHECK(!strcmp(device.id, "0123456789abcde") && !strcmp(device.version, "0123456789abcde") && device.cut);
}

static void lines_that_are_lost(void)
{
    char line[OLP_LINE_MAX + 3];

    begin();
    comes("x=1");
    CHECK(tells(OLP_HOST_DROPPED));
    CHECK_INT(event.error, OLP_RC_MALFORMED);
    CHECK_INT(event.message.length, 0);
    CHECK(event.message.line == NULL);
    memset(line, 'x', sizeof line);
    memcpy(line, "c=", 2);
    line[OLP_LINE_MAX] = '\0';
    comes(line);
    CHECK(tells(OLP_HOST_LINE));
    CHECK_INT(event.message.length, OLP_LINE_MAX);
    line[OLP_LINE_MAX] = 'x';
    line[OLP_LINE_MAX + 1] = '\0';
    comes(line);
    CHECK(tells(OLP_HOST_DROPPED));
    CHECK_INT(event.error, OLP_RC_TOO_LONG);
    comes("");
    comes("c=x&t=300&id=%41"); /* a t that is none does not matter */
    CHECK(tells(OLP_HOST_LINE));
    CHECK_INT(health().malformed, 1);
    CHECK_INT(health().overlong, 1);
}

static void commands_that_can_not_be(void)
{
    static const char *const BAD[] = {"", "x=1", "c=", "c=a b", "c=a-b", "c=a&t=1", "c=a&id=x", "c=a&&b=1", "c=a&s=1234",
                                      "c=a&x=%4", "c=a&x=\x7F", "c=a\nc=b"};
    struct olp_encoder encoder;
    char text[OLP_COMMAND_MAX + 1];
    size_t i;

    begin();
    for (i = 0; i < sizeof BAD / sizeof *BAD; ++i)
        CHECK_INT(asks(BAD[i], "9o5qzg"), -OLP_RC_MALFORMED);
    CHECK_INT(asks("c=a", ""), -OLP_RC_MALFORMED);
    memset(text, 'x', sizeof text);
    memcpy(text, "c=a&b=", 6);
    CHECK(olp_host_send(&host, text, 48, "9o5qzg") > 0);
    CHECK(tells_nothing());
    CHECK_INT(olp_host_output(&host, out, 62, now), 0); /* no room for it */
    CHECK_INT(olp_host_output(&host, out, 63, now), 63);
    CHECK_INT(olp_host_send(&host, text, 49, "9o5qzg"), OLP_WINDOW_MAX > 1 ? -OLP_RC_TOO_LONG : -OLP_RC_BUSY);
    begin();
    comes(LINK_ALL);
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK_INT(olp_host_send(&host, text, 42, "9o5qzg"), -OLP_RC_TOO_LONG);
    CHECK(olp_host_send(&host, text, 41, "9o5qzg") > 0);

    /* As the encoder builds it. */
    begin();
    CHECK_INT(olp_begin_command(&encoder, text, OLP_COMMAND_MAX, "say"), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_string(&encoder, "what", "a&b"), OLP_RC_SUCCESS);
    CHECK(olp_host_send(&host, text, encoder.length, "a b") > 0);
    CHECK(sends("c=say&what=a%26b&t=0&id=a%20b\n"));
    comes("c=say_resp&id=a+b&t=1");
    CHECK(tells(OLP_HOST_ENDED));
}

static void null_pointers_and_sizes(void)
{
    struct olp_host_health counters;
    struct olp_host_link link;
    struct olp_host_device device;
    struct olp_host before;

    CHECK_INT(olp_host_init(NULL, NULL), OLP_RC_ERROR_GENERIC);
    begin();
    before = host;
    CHECK_INT(olp_host_setup(NULL, "x", 1, 1, 1), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_setup(&host, NULL, 1, 1, 1), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_setup(&host, "x", 1, -1, 65536), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_send(NULL, "c=a", 3, "x"), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_send(&host, NULL, 3, "x"), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_send(&host, "c=a", -1, "x"), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_send(&host, "c=a", INT_MIN, "x"), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_send(&host, "c=a", 3, NULL), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_receive(NULL, "x", 1, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_receive(&host, NULL, 1, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_receive(&host, "x", -1, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_poll(NULL, 0, &event), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_poll(&host, 0, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_output(NULL, out, ALL, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_output(&host, NULL, 1, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_output(&host, out, -1, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_output(&host, NULL, 0, 0), 0);
    CHECK_INT(olp_host_next_deadline(NULL, 0), -1);
    CHECK_INT(olp_host_get_link(NULL, &link), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_get_link(&host, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_get_device(NULL, 0, &device), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_get_device(&host, 0, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_get_device(&host, -1, &device), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_host_get_device(&host, INT_MAX, &device), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_host_get_health(NULL, &counters), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_host_get_health(&host, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_BYTES(&host, &before, sizeof host);
}

/* Any memory at all: nothing is touched that should not be, and nothing hangs. */
static void any_memory(void)
{
    static const char LIKELY[] = "c=ack&checksum=null&t=1&id=x\nc=onerror\nc=welcome&id=";
    unsigned long seed = 7;
    int round, i;

    for (round = 0; round < 400; ++round) {
        wire_any_memory(&seed, &host, sizeof host);
        for (i = 0; i < 60; ++i) {
            char text[64];
            int length = 0, rc;
            while (length < 60 && i % 3)
                text[length++] = LIKELY[wire_random(&seed) % (sizeof LIKELY - 1)];
            rc = olp_host_receive(&host, text, length, now);
            CHECK(rc >= 0 && rc <= length);
            CHECK(olp_host_send(&host, "c=x", 3, "x") != 0);
            olp_host_setup(&host, "x", 1, 1, -1);
            rc = polled();
            CHECK(rc == (event.kind ? OLP_RC_SUCCESS : OLP_RC_NO_EVENT));
            rc = olp_host_output(&host, out, ALL, now);
            CHECK(rc >= 0 && rc <= ALL);
            CHECK(olp_host_next_deadline(&host, now) >= -1);
            pass(300);
        }
    }
    /* All zero is a session. */
    memset(&host, 0, sizeof host);
    CHECK_INT(asks(SWITCH_ON, "9o5qzg"), 1);
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
}

int main(void)
{
    setting_up();
    if (OLP_DEVICES_MAX >= 2)
        device_starts_anew();
    if (OLP_LINE_MAX >= 80) /* a linksetup_resp with all it may have */
        a_restarted_device_is_set_up_again();
    numbers_of_each_end_apart();
    numbers();
    the_table();
    lines_that_are_lost();
    commands_that_can_not_be();
    null_pointers_and_sizes();
    any_memory();
    return check_summary("line_host_link");
}
