/* The PC's end of the line protocol, fed lines by hand: what the tests of line_host.h share. */
#ifndef LINE_HOST_STEPS_H
#define LINE_HOST_STEPS_H

#include "libdeltarobot/line_host.h"

#include "check.h"

#include <stdlib.h>

#define ALL ((int)sizeof out)

static struct olp_host host;
static struct olp_host_event event;
static unsigned long now;
static char out[OLP_COMMAND_MAX * (OLP_WINDOW_MAX + 1) + 1];

static const char SWITCH_ON[] = "c=setswitch&state=1";

/* Begins a session late in the clock's turn. */
static void begin_with(int repeats, int recognises)
{
    struct olp_host_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.repeats = repeats;
    settings.recognises = recognises;
    settings.receive_room = -1;
    now = 0xFFFFFF00ul;
    memset(&host, 0x5A, sizeof host);
    CHECK_INT(olp_host_init(&host, &settings), OLP_RC_SUCCESS);
}

static void begin(void)
{
    begin_with(0, 0);
}

static struct olp_host_health health(void)
{
    struct olp_host_health counters;
    memset(&counters, 0xA5, sizeof counters);
    CHECK_INT(olp_host_get_health(&host, &counters), OLP_RC_SUCCESS);
    return counters;
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

/* Waits until something is overdue. */
static void time_out(void)
{
    long left = olp_host_next_deadline(&host, now);
    CHECK(left > 0);
    pass((unsigned long)left);
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

/* The link is set up by the device's own event; it recognises repeats. */
static void begin_linked(const char *linksetup, int ack, int checksum, unsigned int windowsize)
{
    begin_with(0, 1);
    comes(linksetup);
    CHECK(tells(OLP_HOST_LINKSETUP));
    CHECK(linked(ack, checksum, windowsize));
}

/* Short enough for the shortest OLP_LINE_MAX. */
#define LINK_ALL "c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=0&id=sf6z"
#define LINK_ALL_8 "c=linksetup&windowsize=8&ack=on&checksum=fletcher16&t=0&id=sf6z"
#define LINK_ACK "c=linksetup&windowsize=1&ack=on&checksum=none&t=0&id=sf6z34"

#endif
