/* line_protocol.h: lines being received and read, with what the wire and a C program may do to them. */
#include "libdeltarobot/line_protocol.h"

#include "check.h"
#include "wire.h"

#include <float.h>
#include <limits.h>
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
    CHECK_INT(message.checksum, OLP_CHECKSUM_WRONG); /* boards look for the first &s= */
    CHECK_INT(message.sum, olp_fletcher16("c=go", 4));
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

static void floats(void)
{
    char text[400];
    unsigned long seed = 5;
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
        unsigned bits = (wire_random(&seed) << 16 ^ wire_random(&seed)) & 0x7FFFFFFFu;
        float value, next;
        sprintf(text, "%u.%02u", wire_random(&seed) % 10000, wire_random(&seed) % 100);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        if (bits >= 0x7F000000u)
            continue;
        memcpy(&value, &bits, 4);
        ++bits;
        memcpy(&next, &bits, 4);
        sprintf(text, "%.*e", (int)(wire_random(&seed) % 20), value);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        sprintf(text, "%.160f", ((double)value + (double)next) / 2);
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
        text[strlen(text) - 1] = '1';
        float_is(text, OLP_RC_SUCCESS, strtof(text, NULL));
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

/* Structs and arguments that hold anything. */
static void hostile(void)
{
    struct olp_receiver receiver;
    struct olp_line got;
    size_t i;
    long value;
    float real;
    char out[8];

    /* A receiver's contents may be anything. */
    for (i = 0; i < 4096; ++i) {
        unsigned char *bytes = (unsigned char *)&receiver;
        memset(&receiver, (int)(i >> 4), sizeof receiver);
        bytes[i & 3] = (unsigned char)(i >> 2);
        CHECK(olp_receive(&receiver, "", 0, &got) == 0);
        CHECK(olp_receive(&receiver, "c=x\n", 4, &got) == 4);
        CHECK(got.kind == OLP_LINE_OVERLONG || (got.kind == OLP_LINE_COMPLETE && got.length <= OLP_LINE_MAX));
        CHECK(olp_receive(&receiver, "c=y\n", 4, &got) == 4);
        CHECK(got.kind == OLP_LINE_COMPLETE && strcmp(got.text, "c=y") == 0);
    }
    /* What is all zero says nothing. */
    memset(&message, 0, sizeof message);
    memset(&param, 0, sizeof param);
    CHECK_INT(olp_param_at(&message, 0, &param), OLP_RC_NOT_FOUND);
    CHECK_INT(olp_value_int(&param, &value), OLP_RC_MALFORMED);
    CHECK_INT(olp_value_is(&param, ""), 1);
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
    receiving();
    hostile();
    free(held);
    return check_summary("line_protocol");
}
