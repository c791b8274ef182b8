/* line_host.h: commands. What is sent when, again too, what each line that comes means, and how commands end. */
#include "host_steps.h"
#include "sample.h"

static void sample_conversation(int chunk)
{
    struct olp_host_device known;
    char command[OLP_COMMAND_MAX], id[16], sent[OLP_COMMAND_MAX + 1], text[64];
    size_t i;
    int handle = 0, welcomes = 0, infos = 0, answers = 0;

    begin();
    for (i = 0; i < SAMPLE_LINES; ++i) {
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
    CHECK_INT(health().lost, 0);
    CHECK_INT(health().strays, 0);
    CHECK_INT(health().lines, 28);
    CHECK_INT(health().rtt_count, 3);
}

static void acks_and_checksums(void)
{
    int handle;

    /* The examples of the page, as far as they go together. */
    begin_with(0, 1);
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
    /* Nor where something was damaged, which shows by a second = or a second t. */
    comes("c=ack&checksum=64a8&x=wid=sf6z34&t=4&id=9o5qzg");
    CHECK(tells_nothing());
    comes("c=ack&checksum=64a8&t=4&t=4&id=9o5qzg");
    CHECK(tells_nothing());
    CHECK_INT(health().strays, 5);
    time_out();
    CHECK(sends("c=setswitch&state=1&t=4&id=9o5qzg&s=64a8\n"));
    acks_last();
    CHECK(acked(handle));
    CHECK_INT(olp_host_next_deadline(&host, now), 500); /* that it was late says nothing about the answer */
    acks_last();
    CHECK(tells_nothing());
    comes("c=setswitch_resp&state=1&id=9o5qzx&t=5"); /* of somebody else */
    CHECK(tells(OLP_HOST_LINE));
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=6");
    CHECK(ended(handle, OLP_HOST_ANSWERED));
    CHECK(has_line("c=setswitch_resp&state=1&id=9o5qzg&t=6"));
    comes("c=setswitch_resp&state=1&id=9o5qzg&t=6");
    CHECK(tells(OLP_HOST_LINE));
    CHECK_INT(health().repeats, 1);
    CHECK_INT(health().timeouts, 1);
}

static void repeats_and_times_out(void)
{
    char first[OLP_COMMAND_MAX + 1];
    int handle, i;

    begin_linked(LINK_ACK, 1, 0, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    for (i = 0; i < 4; ++i) {
        /* Doubled each time, up to half of the time for which the device remembers a command. */
        long left = i < 3 ? 500 << i : 2000;
        CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
        CHECK_INT(olp_host_next_deadline(&host, now), left);
        pass((unsigned long)left - 1);
        CHECK(sends(""));
        pass(1);
        CHECK_INT(olp_host_next_deadline(&host, now), 0);
    }
    CHECK(ended(handle, OLP_HOST_TIMED_OUT));
    CHECK_INT(event.message.length, 0);
    CHECK_INT(olp_host_next_deadline(&host, now), -1);
    CHECK_INT(health().timeouts, 4);
    CHECK_INT(health().repeats, 3);

    /* Acknowledged, but not answered: repeated too. */
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=1&id=9o5qzg\n"));
    strcpy(first, out);
    pass(300);
    acks_last();
    CHECK(acked(handle));
    /* The answer is waited for since the command was sent. */
    CHECK_INT(olp_host_next_deadline(&host, now), 200);
    time_out();
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
        pass(6000);
        CHECK(acked(handle));
        CHECK(tells_nothing());
        CHECK_INT(olp_host_receive(&host, BOTH + taken, (int)sizeof BOTH - 1 - taken, now), sizeof BOTH - 1 - taken);
        CHECK(ended(handle, OLP_HOST_ANSWERED));
        CHECK_INT(health().overflows, 2);
    }

    /* None of it, where the caller wants none. */
    begin_with(-1, 1);
    handle = asks(SWITCH_ON, "9o5qzg");
    CHECK(sends("c=setswitch&state=1&t=0&id=9o5qzg\n"));
    time_out();
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
        time_out();
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
    CHECK_INT(health().errors, 2);

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
    time_out();
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
    time_out();
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
            time_out();
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
    return check_summary("line_host");
}
