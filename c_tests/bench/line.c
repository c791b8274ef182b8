/*
 * What the line protocol costs, beside plain C that does the same in the way its facts suggest: look for each '&' and
 * '=', sum byte by byte. Used as deltarobot.c.
 */
#define _POSIX_C_SOURCE 199309L
#include "libdeltarobot/line_protocol.h"

#include "measure.h"

#include <stdlib.h>
#include <string.h>

#define CHUNK 64

static const char *const commands[] = {
    "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6",
    "c=go&x=34&y=18&a=2&spd=3343.73&eas=1&t=4&id=c3v3rD&s=360d",
    "c=setpushinfo&interval=2000&state=1&t=0&id=M1F910&s=",
};
static const char *const events[] = {
    "c=heaterinfo&temp=131.71&desiredtemp=-1000.00&state=0&id=M1F910&t=13",
    "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=6&name=HeaterExt1&version=1.0.0",
    "c=motordetails&axis=x&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0",
    "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12",
};

#define LINES_MAX 8

struct lines {
    char text[LINES_MAX][128];
    int length[LINES_MAX], count, bytes;
};

static void add(struct lines *lines, const char *text)
{
    char *line = lines->text[lines->count];
    size_t length = strlen(text);

    strcpy(line, text);
    if (strcmp(line + length - 3, "&s=") == 0)
        sprintf(line + length, "%04x", olp_fletcher16(line, (int)length - 3));
    lines->length[lines->count] = (int)strlen(line);
    lines->bytes += lines->length[lines->count++];
}

static void parse_lines(const struct lines *lines)
{
    struct olp_message message;
    int i;
    for (i = 0; i < lines->count; ++i) {
        if (olp_parse(lines->text[i], lines->length[i], &message) != OLP_RC_SUCCESS)
            abort();
        taken += message.sum;
    }
}

static unsigned plain_fletcher16(const char *bytes, int length)
{
    unsigned sum1 = 0xff, sum2 = 0xff;
    int i;
    for (i = 0; i < length; ++i) {
        sum1 += (unsigned char)bytes[i];
        sum1 = (sum1 & 0xff) + (sum1 >> 8);
        sum2 += sum1;
        sum2 = (sum2 & 0xff) + (sum2 >> 8);
    }
    return sum2 << 8 | sum1;
}

struct plain_message {
    const char *name[16], *value[16];
    int count, is_right;
    unsigned sum;
};

__attribute__((noinline)) static int plain_parse(const char *line, int length, struct plain_message *message)
{
    const char *at = line, *end = line + length, *next, *equals, *c;

    message->count = 0;
    while (at <= end && message->count < 16) {
        next = memchr(at, '&', (size_t)(end - at));
        next = next == NULL ? end : next;
        equals = memchr(at, '=', (size_t)(next - at));
        message->name[message->count] = at;
        message->value[message->count++] = equals == NULL ? next : equals + 1;
        for (c = at; c < next; ++c)
            if (*c == '%' && (next - c < 3 || memchr("0123456789abcdefABCDEF", c[1], 22) == NULL ||
                              memchr("0123456789abcdefABCDEF", c[2], 22) == NULL))
                return 0;
        at = next + 1;
    }
    at = message->name[message->count - 1];
    message->is_right = end - at == 6 && memcmp(at, "s=", 2) == 0;
    message->sum = plain_fletcher16(line, message->is_right ? length - 7 : length);
    if (message->is_right)
        message->is_right = strtoul(at + 2, NULL, 16) == message->sum;
    return line[0] == 'c' && line[1] == '=';
}

static void split_lines(const struct lines *lines)
{
    struct plain_message message;
    int i;
    for (i = 0; i < lines->count; ++i) {
        if (!plain_parse(lines->text[i], lines->length[i], &message))
            abort();
        taken += message.sum;
    }
}

static void parse_case(const char *name, const struct lines *lines)
{
    MEASURE(name, 15, "library", lines->bytes, parse_lines(lines));
    MEASURE(name, 15, "model", lines->bytes, split_lines(lines));
}

/* Chunks of a stream into lines, not parsed. */
static void receive(struct olp_receiver *receiver, const char *stream, int size)
{
    struct olp_line line;
    int at, end;
    for (at = 0; at < size;) {
        end = size - at < CHUNK ? size : at + CHUNK;
        while (at < end) {
            at += olp_receive(receiver, stream + at, end - at, &line);
            taken += (unsigned)line.length;
        }
    }
}

static int build_command(char *buf, int cap)
{
    struct olp_encoder encoder;
    olp_begin_command(&encoder, buf, cap, "setswitch");
    olp_add_int(&encoder, "state", 1);
    olp_add_int(&encoder, "t", 11);
    olp_add_string(&encoder, "id", "9o5qzg");
    return olp_finish(&encoder, 1);
}

static int build_event(char *buf, int cap)
{
    struct olp_encoder encoder;
    olp_begin(&encoder, buf, cap, "heaterinfo");
    olp_add_float(&encoder, "temp", 131.71f, 2);
    olp_add_float(&encoder, "desiredtemp", -1000.0f, 2);
    olp_add_int(&encoder, "state", 0);
    olp_add_string(&encoder, "id", "M1F910");
    olp_add_int(&encoder, "t", 13);
    return olp_finish(&encoder, 0);
}

__attribute__((noinline)) static int plain_command(char *buf, int cap)
{
    int length = snprintf(buf, (size_t)cap, "c=setswitch&state=%d&t=%d&id=%s", 1, 11, "9o5qzg");
    return length + snprintf(buf + length, (size_t)(cap - length), "&s=%04x\n", plain_fletcher16(buf, length));
}

__attribute__((noinline)) static int plain_event(char *buf, int cap)
{
    return snprintf(buf, (size_t)cap, "c=heaterinfo&temp=%.2f&desiredtemp=%.2f&state=%d&id=%s&t=%d\n", 131.71f,
                    -1000.0f, 0, "M1F910", 13);
}

static void build(int (*one)(char *, int))
{
    char buf[128];
    taken += (unsigned)one(buf, sizeof buf);
}

static void build_case(const char *name, int (*library)(char *, int), int (*plain)(char *, int))
{
    char built[128], expected[128];
    int size = library(built, sizeof built);
    if (plain(expected, sizeof expected) != size || memcmp(built, expected, (size_t)size) != 0)
        abort();
    MEASURE(name, 0, "library", size, build(library));
    MEASURE(name, 0, "model", size, build(plain));
}

int main(int argc, char **argv)
{
    static struct lines ours, theirs;
    static struct olp_receiver receiver;
    static char stream[8192];
    int size = 0;
    size_t i;

    use_callgrind = argc > 1 && strcmp(argv[1], "callgrind") == 0;
    for (i = 0; i < sizeof commands / sizeof *commands; ++i)
        add(&ours, commands[i]);
    for (i = 0; i < sizeof events / sizeof *events; ++i)
        add(&theirs, events[i]);
    parse_case("line-parse:commands", &ours);
    parse_case("line-parse:events", &theirs);
    while (size + 128 < (int)sizeof stream)
        size += sprintf(stream + size, "%s\n", events[(size_t)size % (sizeof events / sizeof *events)]);
    MEASURE("line-receive:chunks", 15, "library", size, receive(&receiver, stream, size));
    build_case("line-build:command", build_command, plain_command);
    build_case("line-build:event", build_event, plain_event);
    return 0;
}
