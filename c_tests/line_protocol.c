/* Messages, values, lines being built and lines being received, with what the wire and a C program may do to them. */
#include "libdeltarobot/line_protocol.h"

#include "check.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

static struct olp_message message;
static struct olp_param param;

/* Reads a line out of an allocation that ends with it, so that the tools see the first byte too far. */
static char *held;
static int parse_bytes(const char *line, int length)
{
    free(held);
    held = (char *)malloc(length > 0 ? (size_t)length : 1);
    if (held == NULL)
        abort();
    memcpy(held, line, (size_t)length);
    memset(&message, 0x55, sizeof message);
    return olp_parse(held, length, &message);
}

static int parse(const char *line)
{
    return parse_bytes(line, (int)strlen(line));
}

static void is_param(int index, const char *name, const char *value)
{
    memset(&param, 0x55, sizeof param);
    if (!CHECK_INT(olp_param_at(&message, index, &param), OLP_RC_SUCCESS))
        return;
    CHECK_INT(param.name_length, strlen(name));
    CHECK_BYTES(param.name, name, strlen(name));
    CHECK_INT(param.value_length, strlen(value));
    CHECK_BYTES(param.value, value, strlen(value));
}

static void checksums(void)
{
    static const struct {
        const char *line;
        unsigned sum;
    } VECTORS[] = {
        {"c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34", 0xd293},
        {"c=setswitch&state=1&t=11&id=9o5qzg", 0xa3d6},
        {"c=go&x=34&y=18&a=2&spd=3343.73&eas=1&t=4&id=c3v3rD", 0x360d},
        {"", 0xFFFF},
    };
    char line[128];
    size_t i;
    int length, at, digit;

    for (i = 0; i < sizeof VECTORS / sizeof *VECTORS; ++i) {
        length = (int)strlen(VECTORS[i].line);
        CHECK_INT(olp_fletcher16(VECTORS[i].line, length), VECTORS[i].sum);
        for (at = 0; at <= length; ++at)
            CHECK_INT(olp_fletcher16_more(olp_fletcher16(VECTORS[i].line, at), VECTORS[i].line + at, length - at),
                      VECTORS[i].sum);
        if (length == 0)
            continue;
        sprintf(line, "%s&s=%04x", VECTORS[i].line, VECTORS[i].sum);
        CHECK_INT(parse(line), OLP_RC_SUCCESS);
        CHECK_INT(message.checksum, OLP_CHECKSUM_RIGHT);
        CHECK_INT(message.sum, VECTORS[i].sum);
        sprintf(line, "%s&s=%04X\r\n", VECTORS[i].line, VECTORS[i].sum);
        CHECK_INT(parse(line), OLP_RC_SUCCESS);
        CHECK_INT(message.checksum, OLP_CHECKSUM_RIGHT);
        CHECK_INT(message.length, length + 7);
        /* No wrong byte passes, but for a digit's other case. */
        sprintf(line, "%s&s=%04x", VECTORS[i].line, VECTORS[i].sum);
        for (at = 0; at < length + 7; ++at)
            for (digit = 0; digit < 256; ++digit) {
                char before = line[at];
                if ((char)digit == before || (at > length + 2 && before > '9' && digit == before - 32))
                    continue;
                line[at] = (char)digit;
                if (parse_bytes(line, length + 7) == OLP_RC_SUCCESS)
                    CHECK(message.checksum != OLP_CHECKSUM_RIGHT);
                line[at] = before;
            }
    }
    CHECK_INT(olp_fletcher16(NULL, 5), 0xFFFF);
    CHECK_INT(olp_fletcher16("x", -1), 0xFFFF);
    CHECK_INT(olp_fletcher16_more(0x360d, NULL, 1), 0x360d);
    CHECK_INT(olp_fletcher16_more(0x360d, "", 0), 0x360d);

    CHECK_INT(parse("c=go&s=12&t=1"), OLP_RC_SUCCESS);
    CHECK_INT(message.checksum, OLP_CHECKSUM_NONE);
    CHECK_INT(message.sum, olp_fletcher16("c=go&s=12&t=1", 13));
    CHECK_INT(parse("c=go&s"), OLP_RC_SUCCESS);
    CHECK_INT(message.checksum, OLP_CHECKSUM_WRONG);
    CHECK_INT(message.sum, olp_fletcher16("c=go", 4));
}

static void lines_that_are_read(void)
{
    CHECK_INT(parse("c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IqlZci\n"), OLP_RC_SUCCESS);
    CHECK_INT(message.count, 11);
    CHECK_INT(message.length, 62);
    is_param(0, "c", "go");
    is_param(6, "c", "50");
    is_param(10, "id", "IqlZci");
    CHECK_INT(olp_find(&message, "c", 0, &param), OLP_RC_SUCCESS);
    CHECK(param.value == held + 2);
    CHECK_INT(olp_find(&message, "c", 1, &param), OLP_RC_SUCCESS);
    CHECK(param.value == strchr(held, 'b') + 7);
    CHECK_INT(olp_find(&message, "c", 2, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "C", 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "i", 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "idd", 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "", 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "x", -1, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_find(&message, "x", INT_MAX, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_param_at(&message, 11, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_param_at(&message, -1, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_param_at(&message, INT_MAX, &param), OLP_RC_NOT_FOUND);

    CHECK_INT(parse("c"), OLP_RC_SUCCESS);
    CHECK_INT(message.count, 1);
    is_param(0, "c", "");
    CHECK_INT(parse("c=x&&flag&=&a=b=c&Big_Name=Buffer overflow!&\r\n"), OLP_RC_SUCCESS);
    CHECK_INT(message.count, 5);
    is_param(1, "flag", "");
    is_param(2, "", "");
    is_param(3, "a", "b=c");
    is_param(4, "Big_Name", "Buffer overflow!");

    CHECK_INT(parse_bytes("c=x&v=\0\x80\xFF\r&w=\0", 14), OLP_RC_SUCCESS);
    CHECK_INT(message.count, 3);
    CHECK_INT(olp_find(&message, "v", 0, &param), OLP_RC_SUCCESS);
    CHECK_INT(param.value_length, 4);
    CHECK_BYTES(param.value, "\0\x80\xFF\r", 4);
    CHECK_INT(olp_find(&message, "w", 0, &param), OLP_RC_SUCCESS);
    CHECK_INT(param.value_length, 1);
}

static void lines_that_are_not(void)
{
    static const char *const WITHOUT[] = {"", "\n", "\r\n", "x=1", "C=go", "&c=go", "id=1&c=go", "cx", "=", "\xE4"};
    static const char *const MALFORMED[] = {"c=%", "c=%4", "c=go&x=%4&y=1", "c=%0g", "c=%\n", "c=go&%x=1", "c=a\nb=c"};
    size_t i;

    for (i = 0; i < sizeof WITHOUT / sizeof *WITHOUT; ++i)
        CHECK_INT(parse(WITHOUT[i]), OLP_RC_NO_COMMAND);
    for (i = 0; i < sizeof MALFORMED / sizeof *MALFORMED; ++i)
        CHECK_INT(parse(MALFORMED[i]), OLP_RC_MALFORMED);
    /* Then the message says nothing. */
    CHECK(message.line == NULL);
    CHECK_INT(message.length | message.count | message.checksum | (int)message.sum, 0);
    CHECK_INT(olp_find(&message, "c", 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_param_at(&message, 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_is(&message, "c", 0, ""), 0);
}

/* The value of a parameter v. */
static void set_value(const char *raw)
{
    char line[512];
    sprintf(line, "c=x&v=%s&w=1", raw);
    CHECK_INT(parse(line), OLP_RC_SUCCESS);
    CHECK_INT(olp_find(&message, "v", 0, &param), OLP_RC_SUCCESS);
}

static void decodes(const char *raw, const char *text, int length)
{
    char out[64];
    int cap;

    set_value(raw);
    for (cap = 0; cap <= length + 2; ++cap) {
        memset(out, '#', sizeof out);
        if (cap > length) {
            CHECK_INT(olp_value_string(&param, out, cap), length);
            CHECK_BYTES(out, text, length + 1);
            CHECK_INT(out[length + 1], '#');
        } else {
            CHECK_INT(olp_get_string(&message, "v", 0, out, cap), -OLP_RC_TOO_LONG);
            CHECK_INT(out[0], cap > 0 ? 0 : '#');
            CHECK_INT(out[1], '#');
        }
    }
    CHECK_INT(olp_value_is(&param, text), (int)strlen(text) == length);
    CHECK_INT(olp_is(&message, "v", 0, text), (int)strlen(text) == length);
    CHECK_INT(olp_is(&message, "v", 0, "no such text"), 0);
    CHECK_INT(olp_is(&message, "v", 1, text), 0);
    CHECK_INT(olp_value_string(&param, NULL, 0), -OLP_RC_TOO_LONG);
}

static void texts(void)
{
    decodes("", "", 0);
    decodes("plain", "plain", 5);
    decodes("a+b%20c%2B", "a b c+", 6);
    decodes("%c3%A9%C3%a9", "\xC3\xA9\xC3\xA9", 4);
    decodes("%00x%00", "\0x\0", 3);
    decodes("a b!", "a b!", 4);
}

static void integer_is(const char *raw, int code, long expected)
{
    long value = 77;
    set_value(raw);
    CHECK_INT(olp_value_int(&param, &value), code);
    CHECK_INT(value, code == OLP_RC_SUCCESS ? expected : 77);
    value = 77;
    CHECK_INT(olp_get_int(&message, "v", 0, &value), code);
    CHECK_INT(value, code == OLP_RC_SUCCESS ? expected : 77);
}

static void integers(void)
{
    char text[64];
    unsigned long beyond;

    integer_is("0", OLP_RC_SUCCESS, 0);
    integer_is("-0", OLP_RC_SUCCESS, 0);
    integer_is("0042", OLP_RC_SUCCESS, 42);
    integer_is("-42", OLP_RC_SUCCESS, -42);
    integer_is("%2B42", OLP_RC_SUCCESS, 42);
    integer_is("+42+", OLP_RC_SUCCESS, 42);
    integer_is("  42 ", OLP_RC_SUCCESS, 42);
    sprintf(text, "%ld", LONG_MAX);
    integer_is(text, OLP_RC_SUCCESS, LONG_MAX);
    sprintf(text, "%ld", LONG_MIN);
    integer_is(text, OLP_RC_SUCCESS, LONG_MIN);
    for (beyond = 1; beyond < 20; ++beyond) {
        sprintf(text, "%lu", (unsigned long)LONG_MAX + beyond);
        integer_is(text, OLP_RC_RANGE, 0);
        sprintf(text, "-%lu", (unsigned long)LONG_MAX + 1 + beyond);
        integer_is(text, OLP_RC_RANGE, 0);
    }
    sprintf(text, "%ld0", LONG_MAX);
    integer_is(text, OLP_RC_RANGE, 0);
    sprintf(text, "%ld0", LONG_MIN);
    integer_is(text, OLP_RC_RANGE, 0);
    integer_is("99999999999999999999999999999999999999999", OLP_RC_RANGE, 0);
    integer_is("99999999999999999999999999999999999999999x", OLP_RC_MALFORMED, 0);
    integer_is("", OLP_RC_MALFORMED, 0);
    integer_is(" ", OLP_RC_MALFORMED, 0);
    integer_is("-", OLP_RC_MALFORMED, 0);
    integer_is("--1", OLP_RC_MALFORMED, 0);
    integer_is("1.0", OLP_RC_MALFORMED, 0);
    integer_is("0x10", OLP_RC_MALFORMED, 0);
    integer_is("1%00", OLP_RC_MALFORMED, 0);
    integer_is("12 34", OLP_RC_MALFORMED, 0);
    CHECK_INT(olp_get_int(&message, "v", 1, &(long){0}), OLP_RC_NOT_FOUND);
}

static void float_is(const char *raw, int code, float expected)
{
    float value = 77;
    set_value(raw);
    CHECK_INT(olp_value_float(&param, &value), code);
    CHECK(code == OLP_RC_SUCCESS ? memcmp(&value, &expected, sizeof value) == 0 : value == 77);
    value = 77;
    CHECK_INT(olp_get_float(&message, "v", 0, &value), code);
    CHECK(code == OLP_RC_SUCCESS ? memcmp(&value, &expected, sizeof value) == 0 : value == 77);
}

static unsigned long seed = 5;
static unsigned noise(void)
{
    seed = seed * 1103515245ul + 12345ul;
    return (unsigned)(seed >> 16) & 0xFFFF;
}

static void floats(void)
{
    char text[400];
    int i;

    float_is("110.44", OLP_RC_SUCCESS, 110.44f);
    float_is("-1000.00", OLP_RC_SUCCESS, -1000.0f);
    float_is("3343.73", OLP_RC_SUCCESS, 3343.73f);
    float_is("  3.50", OLP_RC_SUCCESS, 3.5f);
    float_is("%2D.5", OLP_RC_SUCCESS, -0.5f);
    float_is("-0", OLP_RC_SUCCESS, -0.0f);
    float_is("1e%2B3", OLP_RC_SUCCESS, 1000.0f);
    float_is("1e+06", OLP_RC_SUCCESS, 1000000.0f);
    float_is("16777217", OLP_RC_SUCCESS, 16777216.0f);
    float_is("16777217.00000000000000000000000000000001", OLP_RC_SUCCESS, 16777218.0f);
    float_is("1e-99", OLP_RC_SUCCESS, 0.0f);
    float_is("3.4028235e38", OLP_RC_SUCCESS, FLT_MAX);
    float_is("3.4028236e38", OLP_RC_RANGE, 0);
    float_is("-1e9999999999", OLP_RC_RANGE, 0);
    float_is("-1e9999999999x", OLP_RC_MALFORMED, 0);
    float_is("99999999999999999999999999999999999999999999999999x", OLP_RC_MALFORMED, 0);
    float_is("", OLP_RC_MALFORMED, 0);
    float_is(".", OLP_RC_MALFORMED, 0);
    float_is("nan", OLP_RC_MALFORMED, 0);
    float_is("inf", OLP_RC_MALFORMED, 0);
    float_is("1e", OLP_RC_MALFORMED, 0);
    float_is("1.2.3", OLP_RC_MALFORMED, 0);
    float_is("1,5", OLP_RC_MALFORMED, 0);
    float_is("0x1p3", OLP_RC_MALFORMED, 0);

    /* Against the C library: short texts as devices send, long ones, and exactly halfway between two floats. */
    for (i = 0; i < 3000; ++i) {
        unsigned bits = (noise() << 16 | noise()) & 0x7FFFFFFFu;
        float value, next;
        sprintf(text, "%u.%02u", noise() % 10000, noise() % 100);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        if (bits >= 0x7F000000u)
            continue;
        memcpy(&value, &bits, 4);
        ++bits;
        memcpy(&next, &bits, 4);
        sprintf(text, "%.*e", (int)(noise() % 20), value);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        sprintf(text, "%.160f", ((double)value + (double)next) / 2);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        text[strlen(text) - 1] = '1';
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
    }
}

static char out[300];
static struct olp_encoder line;

static void is_line(int checksum, const char *expected)
{
    int length = (int)strlen(expected);
    if (CHECK_INT(olp_finish(&line, checksum), length))
        CHECK_BYTES(out, expected, length + 1);
    CHECK_INT(olp_finish(&line, checksum), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_add_int(&line, "x", 1), OLP_RC_ERROR_GENERIC);
}

static void begin(const char *command)
{
    memset(out, '#', sizeof out);
    memset(&line, 0x55, sizeof line);
    CHECK_INT(olp_begin(&line, out, (int)sizeof out, command), OLP_RC_SUCCESS);
}

static void building(void)
{
    char expected[128];
    int i;

    begin("setpushinfo_resp");
    CHECK_INT(olp_add_string(&line, "name", "St\xC3\xA9p 1&=%+._-~"), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_bytes(&line, "raw", "\0\xFF\n", 3), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_raw(&line, "kept", "%c3+x=y", 7), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_hex(&line, "checksum", 0xABC0D29u), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_string(&line, "none", ""), OLP_RC_SUCCESS);
    is_line(0, "c=setpushinfo_resp&name=St%C3%A9p%201%26%3D%25%2B._-%7E&raw=%00%FF%0A&kept=%c3+x=y&checksum=0d29&none=\n");

    begin("setswitch");
    olp_add_int(&line, "state", 1);
    olp_add_int(&line, "t", 11);
    olp_add_string(&line, "id", "9o5qzg");
    is_line(1, "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\n");

    for (i = -3; i <= 3; ++i) {
        long edges[] = {LONG_MIN, LONG_MAX, 0, 1000000000L, -999999999L};
        size_t edge;
        for (edge = 0; edge < sizeof edges / sizeof *edges; ++edge) {
            long value = (long)((unsigned long)edges[edge] + (unsigned long)i);
            begin("x");
            CHECK_INT(olp_add_int(&line, "v", value), OLP_RC_SUCCESS);
            sprintf(expected, "c=x&v=%ld\n", value);
            is_line(0, expected);
        }
    }
    for (i = 0; i < 3000; ++i) {
        unsigned bits = noise() << 16 | noise();
        int decimals = i % (OLP_DECIMALS_MAX + 1);
        float value;
        if (i % 2)
            value = (float)((int)noise() - 32768) / 128;
        else
            memcpy(&value, &bits, 4);
        begin("x");
        if (isnan(value) || isinf(value)) {
            CHECK_INT(olp_add_float(&line, "v", value, decimals), OLP_RC_RANGE);
            continue;
        }
        CHECK_INT(olp_add_float(&line, "v", value, decimals), OLP_RC_SUCCESS);
        sprintf(expected, "c=x&v=%.*f\n", decimals, value);
        is_line(0, expected);
    }
}

/* After a call that fails with that, all the others fail with that. */
static void stays(int code)
{
    CHECK_INT(olp_add_int(&line, "x", 1), code);
    CHECK_INT(olp_add_float(&line, "x", 1, 1), code);
    CHECK_INT(olp_add_string(&line, "x", "1"), code);
    CHECK_INT(olp_add_bytes(&line, "x", "1", 1), code);
    CHECK_INT(olp_add_raw(&line, "x", "1", 1), code);
    CHECK_INT(olp_add_hex(&line, "x", 1), code);
    CHECK_INT(olp_finish(&line, 1), -code);
    CHECK_INT(out[0], 0);
    CHECK_INT(olp_finish(&line, 1), -OLP_RC_ERROR_GENERIC);
}

static void refusals(void)
{
    static const char *const NAMES[] = {"", "X", "a_b", "a b", "a=", "\xE4", "id\n"};
    static const char *const COMMANDS[] = {"", "Go", "a b", "a&b", "a-b", "a%41", "\xE4"};
    static const char *const VALUES[] = {"&", "a\n", "\r", "%", "%4", "%4x", "ab%"};
    size_t i;

    for (i = 0; i < sizeof NAMES / sizeof *NAMES; ++i) {
        begin("x");
        CHECK_INT(olp_add_int(&line, NAMES[i], 1), OLP_RC_NAME);
        stays(OLP_RC_NAME);
    }
    for (i = 0; i < sizeof COMMANDS / sizeof *COMMANDS; ++i) {
        CHECK_INT(olp_begin(&line, out, (int)sizeof out, COMMANDS[i]), OLP_RC_NAME);
        stays(OLP_RC_NAME);
    }
    for (i = 0; i < sizeof VALUES / sizeof *VALUES; ++i) {
        begin("x");
        CHECK_INT(olp_add_raw(&line, "v", VALUES[i], (int)strlen(VALUES[i])), OLP_RC_MALFORMED);
        stays(OLP_RC_MALFORMED);
    }
    begin("x");
    CHECK_INT(olp_add_float(&line, "v", 1, OLP_DECIMALS_MAX + 1), OLP_RC_RANGE);
    stays(OLP_RC_RANGE);
    begin("x");
    CHECK_INT(olp_add_float(&line, "v", 1, -1), OLP_RC_RANGE);
    begin("x");
    CHECK_INT(olp_add_float(&line, "v", 1, INT_MAX), OLP_RC_RANGE);
    begin("x");
    CHECK_INT(olp_add_string(&line, NULL, "1"), OLP_RC_ERROR_GENERIC);
    stays(OLP_RC_ERROR_GENERIC);
    begin("x");
    CHECK_INT(olp_add_string(&line, "x", NULL), OLP_RC_ERROR_GENERIC);
    stays(OLP_RC_ERROR_GENERIC);
    begin("x");
    CHECK_INT(olp_add_bytes(&line, "x", "1", -1), OLP_RC_ERROR_GENERIC);
    begin("x");
    CHECK_INT(olp_add_raw(&line, "x", NULL, 1), OLP_RC_ERROR_GENERIC);
}

static void go(int checksum, int expected)
{
    static const char *const AXES[] = {"x", "y", "z", "a", "b", "c"};
    int i;

    memset(out, '#', sizeof out);
    CHECK_INT(olp_begin_command(&line, out, (int)sizeof out, "go"), OLP_RC_SUCCESS);
    for (i = 0; i < 6; ++i)
        CHECK_INT(olp_add_int(&line, AXES[i], i < 3 ? 10 : 50), OLP_RC_SUCCESS);
    olp_add_int(&line, "spd", 100);
    olp_add_int(&line, "eas", 1);
    olp_add_int(&line, "t", 0);
    CHECK_INT(olp_add_string(&line, "id", "IqlZci"), OLP_RC_SUCCESS);
    CHECK_INT(olp_finish(&line, checksum), expected);
}

static void limits(void)
{
    char text[100];
    int length, cap;

    go(0, 63);
    CHECK_BYTES(out, "c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IqlZci\n", 64);
    go(1, -OLP_RC_TOO_LONG); /* 70 bytes */
    CHECK_INT(out[0], 0);
    CHECK_INT(out[OLP_COMMAND_MAX + 1], '#');
    /* 66 bytes, and without the window size 53. */
    for (length = 0; length < 2; ++length) {
        olp_begin_command(&line, out, (int)sizeof out, "linksetup");
        if (length == 0)
            olp_add_int(&line, "windowsize", 1);
        olp_add_string(&line, "ack", "on");
        olp_add_string(&line, "checksum", "fletcher16");
        olp_add_int(&line, "t", 2);
        CHECK_INT(olp_add_string(&line, "id", "sf6z34"), length == 0 ? OLP_RC_TOO_LONG : OLP_RC_SUCCESS);
        CHECK_INT(olp_finish(&line, 0), length == 0 ? -OLP_RC_TOO_LONG : 53);
    }
    CHECK(strcmp(out, "c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34\n") == 0);

    memset(text, 'y', sizeof text);
    for (length = 8; length < 80; ++length)
        for (cap = 0; cap < 80; ++cap) {
            int fits = length <= cap, is_command = length <= OLP_COMMAND_MAX;
            memset(out, '#', sizeof out);
            olp_begin(&line, out, cap, "x");
            olp_add_bytes(&line, "v", text, length - 7);
            CHECK_INT(olp_finish(&line, 0), fits ? length : -OLP_RC_TOO_LONG);
            CHECK_INT(out[cap], '#');
            if (fits && length < cap)
                CHECK_INT(out[length], 0);
            olp_begin_command(&line, out, cap, "x");
            olp_add_bytes(&line, "v", text, length - 7);
            CHECK_INT(olp_finish(&line, 0), fits && is_command ? length : -OLP_RC_TOO_LONG);
            CHECK_INT(out[cap], '#');
        }
}

static void receiving(void)
{
    static char stream[2 * OLP_LINE_MAX + 300];
    struct olp_receiver receiver;
    struct olp_line got;
    int length, cut, end;

    CHECK_INT(olp_receiver_init(&receiver), OLP_RC_SUCCESS);
    CHECK_INT(olp_receive(&receiver, "\n\r\n\r\n", 5, &got), 5);
    CHECK_INT(got.kind, OLP_LINE_NONE);
    CHECK_INT(olp_receive(&receiver, "a\0b\r\r\nc", 7, &got), 6);
    CHECK_INT(got.kind, OLP_LINE_COMPLETE);
    CHECK_INT(got.length, 4);
    CHECK_BYTES(got.text, "a\0b\r", 5);
    CHECK_INT(olp_receive(&receiver, NULL, 0, &got), 0);
    CHECK_INT(got.kind, OLP_LINE_NONE);
    CHECK(got.text == NULL);
    CHECK_INT(got.length, 0);

    /* Too long by nothing, one and many; then a line that is intact. Cut anywhere. */
    for (length = OLP_LINE_MAX - 1; length < OLP_LINE_MAX + 4; ++length)
        for (end = 1; end <= 2; ++end)
            for (cut = 0; cut < length + end + 8; cut += cut < length - 2 ? 31 : 1) {
                int total = length + end + 8, first, taken;
                memset(stream, 'x', (size_t)length);
                memcpy(stream + length, end == 1 ? "\nc=after\n" : "\r\nc=after\n", (size_t)end + 8);
                memset(&receiver, 0, sizeof receiver);
                taken = olp_receive(&receiver, stream, cut, &got);
                first = got.kind;
                while (first == OLP_LINE_NONE) {
                    taken += olp_receive(&receiver, stream + taken, total - taken, &got);
                    first = got.kind;
                }
                CHECK_INT(taken, length + end);
                CHECK_INT(first, length <= OLP_LINE_MAX ? OLP_LINE_COMPLETE : OLP_LINE_OVERLONG);
                CHECK_INT(got.length, length <= OLP_LINE_MAX ? length : 0);
                CHECK_INT(olp_receive(&receiver, stream + taken, total - taken, &got), 8);
                CHECK_INT(got.kind, OLP_LINE_COMPLETE);
                CHECK(strcmp(got.text, "c=after") == 0);
            }
}

static void hostile(void)
{
    static const int SIZES[] = {INT_MIN, -1, 0, 1, OLP_LINE_MAX, OLP_LINE_MAX + 1, OLP_LINE_MAX + 2, INT_MAX};
    struct olp_receiver receiver;
    struct olp_line got;
    size_t i;
    long value;
    float real;

    /* A receiver's contents may be anything. */
    for (i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
        memset(&receiver, 0xA5, sizeof receiver);
        receiver.assembly.used = SIZES[i];
        CHECK_INT(olp_receive(&receiver, "\nc=x\n", 5, &got), 1);
        CHECK_INT(got.kind, OLP_LINE_OVERLONG);
        memset(&receiver, 0xA5, sizeof receiver);
        receiver.assembly.overlong = 0;
        receiver.assembly.used = SIZES[i];
        CHECK(olp_receive(&receiver, "c=x\n", 4, &got) == 4);
        CHECK(got.kind == OLP_LINE_OVERLONG || (got.kind == OLP_LINE_COMPLETE && got.length <= OLP_LINE_MAX));
    }
    /* An encoder's fields, but for the buffer, too. */
    for (i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
        begin("x");
        line.length = SIZES[i];
        CHECK(olp_add_int(&line, "v", 1) == OLP_RC_SUCCESS || line.length == 0 || SIZES[i] < 0);
        CHECK(olp_finish(&line, 1) <= (int)sizeof out);
        begin("x");
        line.cap = SIZES[i] < (int)sizeof out ? SIZES[i] : (int)sizeof out;
        CHECK(olp_finish(&line, 1) <= (int)sizeof out);
    }

    /* What is all zero says nothing. */
    memset(&message, 0, sizeof message);
    memset(&param, 0, sizeof param);
    memset(&line, 0, sizeof line);
    CHECK_INT(olp_param_at(&message, 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_value_int(&param, &value), OLP_RC_MALFORMED);
    CHECK_INT(olp_value_is(&param, ""), 1);
    CHECK_INT(olp_add_int(&line, "x", 1), OLP_RC_ERROR_GENERIC);
    memset(&line, 0, sizeof line);
    CHECK_INT(olp_finish(&line, 1), -OLP_RC_ERROR_GENERIC);
    message.length = -1;
    CHECK_INT(olp_param_at(&message, 0, &param), OLP_RC_ERROR_GENERIC);
    param.value_length = INT_MAX;
    CHECK_INT(olp_value_int(&param, &value), OLP_RC_ERROR_GENERIC);

    /* NULL, and sizes that can't be. */
    CHECK_INT(olp_parse(NULL, 4, &message), OLP_RC_ERROR_GENERIC);
    CHECK(message.line == NULL && message.length == 0);
    CHECK_INT(olp_parse(NULL, 0, &message), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_parse("c=x", -1, &message), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_parse("c=x", 3, NULL), OLP_RC_ERROR_GENERIC);
    set_value("1");
    CHECK_INT(olp_param_at(NULL, 0, &param), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_param_at(&message, 0, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_find(NULL, "v", 0, &param), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_find(&message, NULL, 0, &param), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_find(&message, "v", 0, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_int(NULL, &value), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_int(&param, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_float(NULL, &real), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_float(&param, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_string(NULL, out, 8), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_string(&param, NULL, 8), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_string(&param, out, -1), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_value_is(NULL, "1"), 0);
    CHECK_INT(olp_value_is(&param, NULL), 0);
    CHECK_INT(olp_get_int(NULL, "v", 0, &value), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_get_int(&message, "v", 0, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_get_float(&message, NULL, 0, &real), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_get_float(&message, "u", 0, &real), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_get_string(&message, "u", 0, out, 8), -OLP_RC_NOT_FOUND);
    CHECK_INT(olp_get_string(&message, NULL, 0, out, 8), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_get_string(&message, "v", 0, NULL, 8), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_is(NULL, "v", 0, "1"), 0);
    CHECK_INT(olp_is(&message, "v", 0, NULL), 0);

    CHECK_INT(olp_begin(NULL, out, 8, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, NULL, 8, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, NULL, 0, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_finish(&line, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, out, -1, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin_command(&line, out, INT_MIN, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, out, 8, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_add_int(NULL, "x", 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_finish(NULL, 1), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_receiver_init(NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_receive(NULL, "x", 1, &got), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_receive(&receiver, NULL, 1, &got), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_receive(&receiver, "x", -1, &got), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_receive(&receiver, "x", 1, NULL), -OLP_RC_ERROR_GENERIC);
}

int main(void)
{
    checksums();
    lines_that_are_read();
    lines_that_are_not();
    texts();
    integers();
    floats();
    building();
    refusals();
    limits();
    receiving();
    hostile();
    free(held);
    return check_summary("line_protocol");
}
