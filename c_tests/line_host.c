/* line_host.h: the PC's end by itself, fed lines by hand. The times are the defaults'. */
#include "libdeltarobot/line_host.h"

#include "check.h"

#include <limits.h>
#include <stdlib.h>

#define ALL ((int)sizeof out)

static struct olp_host host;
static struct olp_host_event event;
static unsigned long now;
static char out[OLP_COMMAND_MAX * (OLP_WINDOW_MAX + 1) + 1];

static const char SWITCH_ON[] = "c=setswitch&state=1";
static const char GO[] = "c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1";

/* Begins a session late in the clock's turn. */
static void begin_with(int repeats, int recognises)
{
    struct olp_host_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.repeats = repeats;
    settings.recognises = recognises;
    now = 0xFFFFFF00ul;
    memset(&host, 0x5A, sizeof host);
    CHECK_INT(olp_host_init(&host, &settings), OLP_RC_SUCCESS);
}

static void begin(void)
{
    begin_with(0, 0);
}

static void pass(unsigned long ms)
{
    now = (now + ms) & 0xFFFFFFFFul;
}

static int polled(void)
{
    memset(&event, 0xA5, sizeof event);
    return olp_host_poll(&host, now, &event);
}

/* The next event is of this kind; its message, if it has one, is in event. */
static int tells(int kind)
{
    int rc = polled();
    if (kind == 0)
        return CHECK_INT(event.kind, 0) & CHECK_INT(rc, OLP_RC_NO_EVENT);
    return CHECK_INT(event.kind, kind) & CHECK_INT(rc, OLP_RC_SUCCESS);
}

static int tells_nothing(void)
{
    return tells(0);
}

static int ended(int handle, int outcome)
{
    return tells(OLP_HOST_ENDED) && CHECK_INT(event.handle, handle) && CHECK_INT(event.outcome, outcome);
}

static int acked(int handle)
{
    return tells(OLP_HOST_ACKED) && CHECK_INT(event.handle, handle);
}

static int linked(int ack, int checksum, unsigned int windowsize)
{
    struct olp_host_link link;
    CHECK_INT(olp_host_get_link(&host, &link), OLP_RC_SUCCESS);
    CHECK_BYTES(&event.link, &link, sizeof link);
    return CHECK_INT(link.ack, ack) & CHECK_INT(link.checksum, checksum) & CHECK_INT(link.windowsize, windowsize);
}

static int has_line(const char *line)
{
    return CHECK_INT(event.message.length, strlen(line)) && CHECK_BYTES(event.message.line, line, strlen(line));
}

/* What is sent now, all of it. */
static int sends(const char *lines)
{
    int length;
    CHECK(tells_nothing());
    length = olp_host_output(&host, out, ALL - 1, now);
    out[length < 0 ? 0 : length] = '\0';
    if (strcmp(out, lines) != 0)
        fprintf(stderr, "    sent: %s", out);
    CHECK_INT(olp_host_output(&host, out, ALL - 1, now), 0);
    return strcmp(out, lines) == 0;
}

/* A line comes in, its LF added here. */
static void comes(const char *line)
{
    int length = (int)strlen(line);
    CHECK_INT(olp_host_receive(&host, line, length, now), length);
    CHECK_INT(olp_host_receive(&host, "\n", 1, now), 1);
}

static int asks(const char *command, const char *id)
{
    return olp_host_send(&host, command, (int)strlen(command), id);
}

/* The t of the line in out. */
static int sent_t(void)
{
    const char *t = strstr(out, "&t=");
    return t ? atoi(t + 3) : -1;
}

/* An ack of the line that is in out. */
static void acks_last(void)
{
    char line[128], text[32];
    struct olp_message message;
    CHECK_INT(olp_parse(out, (int)strlen(out), &message), OLP_RC_SUCCESS);
    olp_get_string(&message, "id", 0, text, sizeof text);
    if (message.checksum == OLP_CHECKSUM_RIGHT)
        sprintf(line, "c=ack&checksum=%04x&t=%d&id=%s", message.sum, sent_t(), text);
    else
        sprintf(line, "c=ack&checksum=null&t=%d&id=%s", sent_t(), text);
    comes(line);
}

/* The link is set up by the device's own event. */
static void begin_linked(const char *linksetup, int ack, int checksum, unsigned int windowsize)
{
    begin();
    comes(linksetup);
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(ack, checksum, windowsize));
}

/* Short enough for the shortest OLP_LINE_MAX. */
#define LINK_ALL "c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=0&id=sf6z"
#define LINK_ALL_8 "c=linksetup&windowsize=8&ack=on&checksum=fletcher16&t=0&id=sf6z"
#define LINK_ACK "c=linksetup&windowsize=1&ack=on&checksum=none&t=0&id=sf6z34"

/* The page's sample. Lines to the device begin with '>'. */
static const char *const SAMPLE[] = {
    "c=welcome&id=0uAAly&type=OzekiIDManager&pos=1&version=1.0.0",
    "c=welcome&id=6O1KiA&type=OzekiStepperMotorMultiController&pos=2&version=1.0.0",
    "c=welcome&id=3Mx14T&type=OzekiButtonController&pos=3&name=StopYmin&version=1.0.0",
    "c=welcome&id=xvnuu3&type=OzekiButtonController&pos=4&name=StopYmax&version=1.0.0",
    "c=welcome&id=1988L4&type=OzekiButtonController&pos=5&name=StopZmin&version=1.0.0",
    "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=6&name=HeaterExt1&version=1.0.0",
    "c=welcome&id=9o5qzg&type=OzekiSwitchController&pos=7&name=FanExt1&version=1.0.0",
    "c=motorsnumber&count=4&id=6O1KiA&t=0",
    "c=motordetails&axis=x&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0",
    "c=motordetails&axis=y&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0",
    "c=motordetails&axis=z&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0",
    "c=motordetails&axis=a&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0",
    "c=welcome&type=Ozeki3DPrinterDisc&id=OZPDSC&version=1.0.0",
    ">c=setpushinfo&interval=2000&state=1&t=0&id=M1F910",
    "c=setpushinfo_resp&state=1&interval=2000&id=M1F910&t=1",
    "c=heaterinfo&temp=110.44&desiredtemp=-1000.00&state=0&id=M1F910&t=2",
    "c=heaterinfo&temp=121.01&desiredtemp=-1000.00&state=0&id=M1F910&t=3",
    "c=heaterinfo&temp=125.93&desiredtemp=-1000.00&state=0&id=M1F910&t=4",
    "c=heaterinfo&temp=128.28&desiredtemp=-1000.00&state=0&id=M1F910&t=5",
    "c=heaterinfo&temp=129.48&desiredtemp=-1000.00&state=0&id=M1F910&t=6",
    "c=heaterinfo&temp=129.87&desiredtemp=-1000.00&state=0&id=M1F910&t=7",
    "c=heaterinfo&temp=130.47&desiredtemp=-1000.00&state=0&id=M1F910&t=8",
    "c=heaterinfo&temp=131.15&desiredtemp=-1000.00&state=0&id=M1F910&t=9",
    "c=heaterinfo&temp=131.15&desiredtemp=-1000.00&state=0&id=M1F910&t=10",
    ">c=setswitch&state=1&t=11&id=9o5qzg",
    "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12",
    "c=heaterinfo&temp=131.71&desiredtemp=-1000.00&state=0&id=M1F910&t=13",
    ">c=setswitch&state=0&t=14&id=9o5qzg",
    "c=setswitch_resp&state=0&pwm=254&id=9o5qzg&t=15",
    "c=heaterinfo&temp=131.65&desiredtemp=-1000.00&state=0&id=M1F910&t=16",
    "c=heaterinfo&temp=132.22&desiredtemp=-1000.00&state=0&id=M1F910&t=17",
};

static void sample_conversation(int chunk)
{
    struct olp_host_device known;
    char command[OLP_COMMAND_MAX], id[16], sent[OLP_COMMAND_MAX + 1], text[64];
    size_t i;
    int handle = 0, welcomes = 0, infos = 0, answers = 0;

    begin();
    for (i = 0; i < sizeof SAMPLE / sizeof *SAMPLE; ++i) {
        const char *line = SAMPLE[i];
        if (*line == '>') {
            /* What the caller says: all in front of t, and the id. */
            const char *t = strstr(++line, "&t=");
            sprintf(command, "%.*s", (int)(t - line), line);
            sprintf(id, "%s", strstr(line, "&id=") + 4);
            handle = asks(command, id);
            CHECK(handle > 0);
            sprintf(sent, "%s\n", line);
            CHECK(sends(sent));
            CHECK_INT(olp_host_next_deadline(&host, now), 500);
            continue;
        }
        sprintf(text, "%.10s", line);
        if (chunk) {
            int length = (int)strlen(line), at;
            for (at = 0; at < length; at += chunk)
                CHECK_INT(olp_host_receive(&host, line + at, length - at < chunk ? length - at : chunk, now),
                          length - at < chunk ? length - at : chunk);
            CHECK_INT(olp_host_receive(&host, "\r\n", 2, now), 2);
        } else {
            comes(line);
        }
        if (!strncmp(line, "c=welcome", 9)) {
            CHECK(tells(OLP_HOST_WELCOME));
            CHECK_INT(event.device, welcomes < OLP_DEVICES_MAX ? welcomes : -1);
            CHECK_INT(event.error, welcomes++ < OLP_DEVICES_MAX ? OLP_RC_SUCCESS : OLP_RC_OVERFLOW);
        } else if (strstr(line, "_resp")) {
            CHECK(ended(handle, OLP_HOST_ANSWERED));
            ++answers;
        } else {
            CHECK(tells(OLP_HOST_LINE));
            ++infos;
        }
        CHECK(has_line(line));
        CHECK(tells_nothing());
        CHECK_INT(olp_host_next_deadline(&host, now), -1);
    }
    CHECK_INT(welcomes, 8);
    CHECK_INT(answers, 3);
    CHECK_INT(infos, 5 + 12);
    if (OLP_DEVICES_MAX >= 8) {
        CHECK_INT(olp_host_get_device(&host, 5, &known), OLP_RC_SUCCESS);
        CHECK(!strcmp(known.id, "M1F910") && !strcmp(known.type, "OzekiTemperatureController"));
        CHECK(!strcmp(known.name, "HeaterExt1") && !strcmp(known.version, "1.0.0"));
        CHECK_INT(known.pos, 6);
        CHECK_INT(olp_host_get_device(&host, 7, &known), OLP_RC_SUCCESS);
        CHECK(!strcmp(known.id, "OZPDSC") && !strcmp(known.name, "") && known.pos == 0 && known.cut == 0);
    }
    CHECK_INT(olp_host_get_device(&host, OLP_DEVICES_MAX < 8 ? OLP_DEVICES_MAX : 8, &known), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_host_get_health(&host)->lost, 0);
    CHECK_INT(olp_host_get_health(&host)->strays, 0);
    CHECK_INT(olp_host_get_health(&host)->lines, 28);
    CHECK_INT(olp_host_get_health(&host)->rtt_count, 3);
}

static void acks_and_checksums(void)
{
    int handle;

    /* The examples of the page, as far as they go together. */
    begin();
    comes("c=x&t=1");
    CHECK(tells(OLP_HOST_LINE));
    handle = olp_host_setup(&host, "sf6z34", 1, 1, -1);
    CHECK(sends("c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34\n"));
    if (OLP_WINDOW_MAX > 1)
        CHECK(asks(SWITCH_ON, "9o5qzg") > 0); /* waits for that */
    CHECK(sends(""));
    comes("c=ack&checksum=d293&t=2&id=sf6z34");
    CHECK(acked(handle));
    CHECK(tells_nothing());
    pass(7);
    comes("c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=3");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(1, 1, 1));
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    if (OLP_WINDOW_MAX == 1)
        CHECK(asks(SWITCH_ON, "9o5qzg") > 0);
    CHECK(sends("c=setswitch&state=1&t=4&id=9o5qzg&s=64a8\n"));

    /* An answer is nothing without the ack before it, and an ack nothing without the checksum. */
    ++handle;
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=5");
    CHECK(tells(OLP_HOST_LINE));
    comes("c=ack&checksum=1234&t=4&id=9o5qzg");
    CHECK(tells_nothing());
    comes("c=ack&checksum=64a8&t=5&id=9o5qzg");
    CHECK(tells_nothing());
    CHECK_INT(olp_host_get_health(&host)->strays, 3);
    pass(500);
    CHECK(sends("c=setswitch&state=1&t=4&id=9o5qzg&s=64a8\n"));
    acks_last();
    CHECK(acked(handle));
    CHECK_INT(olp_host_next_deadline(&host, now), 500);
    acks_last();
    CHECK(tells_nothing());
    comes("c=setswitch_resp&state=1&id=9o5qzx&t=5"); /* of somebody else */
    CHECK(tells(OLP_HOST_LINE));
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=6");
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    CHECK(has_line("c=setswitch_resp&state=1&id=9o5qzg&t=6"));
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=6");
    CHECK(tells(OLP_HOST_LINE));
    CHECK_INT(olp_host_get_health(&host)->repeats, 1);
    CHECK_INT(olp_host_get_health(&host)->timeouts, 1);
}

static void repeats_and_times_out(void)
{
    char first[OLP_COMMAND_MAX + 1];
    int handle, i;

    begin_linked(LINK_ACK, 1, 0, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    for (i = 0; i < 4; ++i) {
        CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
        CHECK_INT(olp_host_next_deadline(&host, now), 500);
        pass(499);
        CHECK(sends(""));
        pass(1);
        CHECK_INT(olp_host_next_deadline(&host, now), 0);
    }
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));
    CHECK_INT(event.message.length, 0);
    CHECK_INT(olp_host_next_deadline(&host, now), -1);
    CHECK_INT(olp_host_get_health(&host)->timeouts, 4);
    CHECK_INT(olp_host_get_health(&host)->repeats, 3);

    /* Acknowledged, but not answered: repeated too. */
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=1&id=9o5qzg\n"));
    strcpy(first, out);
    acks_last();
    CHECK(acked(handle));
    pass(500);
    CHECK(sends(first));
    acks_last();
    CHECK(tells_nothing());
    comes("c=setswitch_resp&id=9o5qzg&t=2");
    CHECK(ended(handle, OLP_HOST_ANSWERED));

    /* What came before the deadline counts, even when the clock has gone on and not all bytes were taken. */
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=3&id=9o5qzg\n"));
    {
        static const char BOTH[] = "c=ack&checksum=null&t=3&id=9o5qzg\nc=setswitch_resp&id=9o5qzg&t=4\n";
        int taken = olp_host_receive(&host, BOTH, (int)sizeof BOTH - 1, now);
        CHECK_INT(taken, 34);
        CHECK_INT(olp_host_receive(&host, BOTH + taken, 5, now), 0); /* not yet */
        pass(600);
        CHECK(acked(handle));
        CHECK(tells_nothing());
        CHECK_INT(olp_host_receive(&host, BOTH + taken, (int)sizeof BOTH - 1 - taken, now), sizeof BOTH - 1 - taken);
        CHECK(ended(handle, OLP_HOST_ANSWERED));
        CHECK_INT(olp_host_get_health(&host)->overflows, 2);
    }

    /* None of it, where the caller wants none. */
    begin_with(-1, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    pass(500);
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));
}

/* Without acks: a device that does not recognise a repeat would carry it out. */
static void without_acks(void)
{
    int handle, recognises;

    for (recognises = 0; recognises < 2; ++recognises) {
        begin_with(0, recognises);
        handle = asks(SWITCH_ON, "9o5qzg");
        CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
        pass(500);
        if (recognises)
            CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
        else
            CHECK(ended(handle, OLP_HOST_TIMED_OUT));
    }
    /* An error says that it was not carried out. */
    begin();
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    comes("c=onerror&p=Buffer overflow");
    CHECK(tells(OLP_HOST_ERROR));
    CHECK_INT(event.handle, handle);
    CHECK(has_line("c=onerror&p=Buffer overflow"));
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    comes("c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=1");
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    comes("c=onerror&code=overflow&t=2&id=x"); /* of nothing that is known */
    CHECK(tells(OLP_HOST_ERROR));
    CHECK_INT(event.handle, 0);
    CHECK(sends(""));
    CHECK_INT(olp_host_get_health(&host)->errors, 2);

    /* With several, nobody knows which, unless the device recognises what it has done. */
    for (recognises = 0; recognises < 2; ++recognises) {
        begin_with(0, recognises);
        comes("c=linksetup&windowsize=8&ack=off&checksum=none&t=0&id=x");
        CHECK(tells(OLP_HOST_LINKSETUP));
        asks("c=a", "9o5qzg");
        asks("c=b", "9o5qzg");
        CHECK(sends(OLP_WINDOW_MAX > 1 ? "c=a&t=0&id=9o5qzg\nc=b&t=1&id=9o5qzg\n" : "c=a&t=0&id=9o5qzg\n"));
        comes("c=onerror&code=checksum&t=7&id=9o5qzg");
        CHECK(tells(OLP_HOST_ERROR));
        if (OLP_WINDOW_MAX > 1 && !recognises) {
            CHECK(tells(OLP_HOST_LINKSETUP));
            CHECK(sends(""));
        }
    }

    /* Acks from a device that was told so by somebody else are understood. */
    begin();
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    comes("c=ack&t=0&checksum=NULL&id=9o5qzg");
    CHECK(tells_nothing());
    acks_last();
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(1, 0, 1));
    CHECK(acked(handle));
    comes("c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=1");
    CHECK(ended(handle, OLP_HOST_ANSWERED));
}

static void errors(void)
{
    int handle, i;

    begin_linked(LINK_ALL, 1, 1, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK_INT(olp_host_next_deadline(&host, now), 0);
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg&s=38a4\n"));
    /* At once, three times; then there is nothing left but to wait. */
    for (i = 0; i < 5; ++i) {
        char first[OLP_COMMAND_MAX + 1];
        strcpy(first, out);
        comes("c=onerror&code=checksum&t=1&id=sf6z34");
        CHECK(tells(OLP_HOST_ERROR));
        CHECK_INT(event.handle, handle);
        CHECK(sends(i < 3 ? first : ""));
        strcpy(out, first);
    }
    acks_last();
    CHECK(acked(handle));
    comes("c=onerror&code=overflow&t=1&id=sf6z34"); /* not about what was received */
    CHECK(tells(OLP_HOST_ERROR));
    CHECK_INT(event.handle, 0);
    CHECK(sends(""));
    pass(500);
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));

    /* Refused: directly behind the ack of that command, and no other. */
    for (i = 0; i < 4; ++i) {
        static const char *const CODES[] = {"unknowncommand", "unknownid", "refused", "toolong"};
        char line[128];
        handle = asks(SWITCH_ON, "9o5qzg");
        CHECK(tells_nothing());
        CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
        out[strcspn(out, "\n") + 1] = '\0';
        sprintf(line, "c=onerror&code=%s&t=%d&id=9o5qzg", CODES[i], sent_t());
        comes(line); /* no ack */
        CHECK(tells(OLP_HOST_ERROR));
        CHECK_INT(event.handle, 0);
        acks_last();
        CHECK(acked(handle));
        comes("c=heaterinfo&temp=1");
        CHECK(tells(OLP_HOST_LINE));
        comes(line); /* not directly behind it */
        CHECK(tells(OLP_HOST_ERROR));
        CHECK_INT(event.handle, 0);
        acks_last();
        CHECK(tells_nothing());
        line[strlen(line) - 1] = 'x';
        comes(line); /* another id */
        CHECK(tells(OLP_HOST_ERROR));
        CHECK_INT(event.handle, 0);
        line[strlen(line) - 1] = 'g';
        acks_last();
        CHECK(tells_nothing());
        comes(line);
        CHECK(tells(OLP_HOST_ERROR));
        CHECK_INT(event.handle, handle);
        CHECK(ended(handle, i == 3 ? OLP_HOST_ANSWERED : OLP_HOST_REFUSED));
        CHECK(has_line(line));
        CHECK(tells_nothing());
    }

    /* Without checksums, what is refused may be a damaged repeat. */
    begin_linked(LINK_ACK, 1, 0, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    pass(500);
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    acks_last();
    CHECK(acked(handle));
    comes("c=onerror&code=unknowncommand&t=0&id=9o5qzg");
    CHECK(tells(OLP_HOST_ERROR));
    CHECK(tells_nothing());
}

static void the_window_slides(void)
{
    char command[32], line[128];
    int handle[OLP_WINDOW_MAX + 1], i, length, lines = 0;

    begin_linked(LINK_ALL_8, 1, 1, 8);
    for (i = 0; i < OLP_WINDOW_MAX; ++i) {
        sprintf(command, "c=set&n=%d", i);
        handle[i] = asks(command, "9o5qzg");
        CHECK(handle[i] > 0);
        CHECK(i == 0 || handle[i] != handle[i - 1]);
    }
    CHECK_INT(asks("c=x", "9o5qzg"), -OLP_RC_BUSY);
    CHECK(tells_nothing());
    length = olp_host_output(&host, out, ALL - 1, now);
    for (i = 0; i < length; ++i)
        lines += out[i] == '\n';
    CHECK_INT(lines, OLP_WINDOW_MAX < 8 ? OLP_WINDOW_MAX : 8);
    if (lines < 2)
        return;

    /* The second is answered: that makes no room as long as the first is not. */
    memmove(out, strchr(out, '\n') + 1, strlen(strchr(out, '\n')));
    *(strchr(out, '\n') + 1) = '\0';
    acks_last();
    CHECK(acked(handle[1]));
    comes("c=set_resp&id=9o5qzg&t=9");
    CHECK(ended(handle[1], OLP_HOST_ANSWERED));
    handle[1] = asks("c=set&n=99", "9o5qzg");
    CHECK(handle[1] > 0);
    CHECK(OLP_WINDOW_MAX > 8 || sends(""));

    /* Those that are acknowledged are answered in the order of sending. */
    begin_linked(LINK_ALL_8, 1, 1, 8);
    handle[0] = asks("c=set&n=0", "9o5qzg");
    handle[1] = asks("c=set&n=1", "9o5qzg");
    CHECK(tells_nothing());
    length = olp_host_output(&host, out, OLP_COMMAND_MAX - 20, now); /* room for one */
    CHECK(length > 0 && length < OLP_COMMAND_MAX - 20);
    out[length] = '\0';
    strcpy(line, out);
    length = olp_host_output(&host, out, OLP_COMMAND_MAX - 20, now);
    out[length] = '\0';
    acks_last();
    CHECK(acked(handle[1]));
    strcpy(out, line);
    acks_last();
    CHECK(acked(handle[0]));
    comes("c=set_resp&id=9o5qzg&t=2");
    CHECK(ended(handle[0], OLP_HOST_ANSWERED));
    comes("c=set_resp&id=9o5qzg&t=3");
    CHECK(ended(handle[1], OLP_HOST_ANSWERED));
}

/*
 * What the device remembers is the last commands that it carried out. Of eight, the first comes late: it may have
 * been carried out behind the second, and then a ninth would make the device forget that one.
 */
static void a_repeat_takes_a_place_in_the_window(void)
{
    char lines[9][OLP_COMMAND_MAX + 1], command[48];
    int repeated, i, handle = 0, length;

    for (repeated = 0; repeated < 2 && OLP_WINDOW_MAX >= 8; ++repeated) {
        begin_linked(LINK_ALL_8, 1, 1, 8);
        for (i = 0; i < 8; ++i) {
            sprintf(command, "c=set%d", i);
            handle = asks(command, "9o5qzg");
        }
        CHECK(tells_nothing());
        for (i = 0; i < 8; ++i) {
            length = olp_host_output(&host, lines[i], 40, now); /* room for one */
            lines[i][length] = '\0';
        }
        if (repeated) {
            pass(500);
            CHECK(tells_nothing());
            for (i = 0; i < 8; ++i) {
                length = olp_host_output(&host, out, 40, now);
                out[length] = '\0';
                CHECK(!strcmp(out, lines[i]));
            }
        }
        for (i = 0; i < 2; ++i) {
            strcpy(out, lines[i]);
            acks_last();
            CHECK(acked(handle - 7 + i));
            sprintf(command, "c=set%d_resp&id=9o5qzg&t=9", i);
            comes(command);
            CHECK(ended(handle - 7 + i, OLP_HOST_ANSWERED));
            CHECK(asks("c=more", "9o5qzg") > 0);
            CHECK(tells_nothing());
            length = olp_host_output(&host, out, ALL - 1, now);
            CHECK_INT(length > 0, !repeated);
        }
    }
}

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
        pass(500);
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
        pass(500);
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
    CHECK_INT(olp_host_get_health(&host)->restarts, 1);

    /* Once more, with its own linksetup first; the setup under way goes on. */
    setup = olp_host_setup(&host, "sf6z34", 0, 0, -1);
    CHECK(tells_nothing());
    CHECK(olp_host_output(&host, out, ALL - 1, now) > 0);
    comes(LINK_ALL);
    CHECK(tells(OLP_HOST_LINKSETUP));
    comes("c=welcome&id=9o5qzg");
    CHECK(tells(OLP_HOST_WELCOME));
    CHECK(linked(1, 1, 1));
    CHECK_INT(olp_host_get_health(&host)->restarts, 2);
    comes("c=linksetup_resp&ack=off&checksum=none&id=sf6z34&t=1");
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(ended(setup, OLP_HOST_ANSWERED));
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
    CHECK_INT(olp_host_get_health(&host)->lost, 8);

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
    CHECK_INT(olp_host_get_health(&host)->malformed, 1);
    CHECK_INT(olp_host_get_health(&host)->overlong, 1);
}

static void commands_that_can_not_be(void)
{
    static const char *const BAD[] = {"", "x=1", "c=", "c=a b", "c=A", "c=a&t=1", "c=a&id=x", "c=a&&b=1", "c=a&s=1234",
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
    CHECK(olp_host_get_health(NULL) == NULL);
    CHECK_BYTES(&host, &before, sizeof host);
}

/* Any memory at all: nothing is touched that should not be, and nothing hangs. */
static void any_memory(void)
{
    unsigned long seed = 7;
    int round, i;

    for (round = 0; round < 400; ++round) {
        struct olp_host *any = malloc(sizeof *any);
        unsigned char *bytes = (unsigned char *)any;
        for (i = 0; i < (int)sizeof *any; ++i) {
            seed = (seed * 1103515245ul + 12345ul) & 0xFFFFFFFFul;
            bytes[i] = (unsigned char)(round % 4 == 0 ? 0xFF : round % 4 == 1 ? seed >> 24 & 7 : seed >> 16);
        }
        host = *any;
        free(any);
        for (i = 0; i < 60; ++i) {
            char text[64];
            int length = 0;
            while (length < 60 && i % 3) {
                static const char LIKELY[] = "c=ack&checksum=null&t=1&id=x\nc=onerror\nc=welcome&id=";
                seed = (seed * 1103515245ul + 12345ul) & 0xFFFFFFFFul;
                text[length++] = LIKELY[(seed >> 16) % (sizeof LIKELY - 1)];
            }
            CHECK(olp_host_receive(&host, text, length, now) <= length);
            CHECK(olp_host_send(&host, "c=x", 3, "x") != 0);
            olp_host_setup(&host, "x", 1, 1, -1);
            polled();
            CHECK(olp_host_output(&host, out, ALL, now) <= ALL);
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
    int chunk;
    for (chunk = 0; chunk < 9 && OLP_LINE_MAX >= 128; ++chunk)
        sample_conversation(chunk);
    acks_and_checksums();
    repeats_and_times_out();
    without_acks();
    errors();
    the_window_slides();
    a_repeat_takes_a_place_in_the_window();
    setting_up();
    if (OLP_DEVICES_MAX >= 2)
        device_starts_anew();
    numbers();
    the_table();
    lines_that_are_lost();
    commands_that_can_not_be();
    null_pointers_and_sizes();
    any_memory();
    return check_summary("line_host");
}
