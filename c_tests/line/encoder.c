/* line_protocol.h: lines being built, into what room there is. */
#include "libdeltarobot/line_protocol.h"

#include "check.h"
#include "wire.h"

#include <limits.h>
#include <math.h>

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
    unsigned long seed = 5;
    int i;

    begin("setpushinfo_resp");
    CHECK_INT(olp_add_string(&line, "name", "St\xC3\xA9p 1&=%+._-~"), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_bytes(&line, "raw", "\0\xFF\n", 3), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_raw(&line, "kept", "%c3+x=y", 7), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_hex(&line, "checksum", 0xABC0D29u), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_string(&line, "none", ""), OLP_RC_SUCCESS);
    is_line(0, "c=setpushinfo_resp&name=St%C3%A9p%201%26%3D%25%2B._-%7E&raw=%00%FF%0A&kept=%c3+x=y&checksum=0d29"
               "&none=\n");

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
        unsigned bits = wire_random(&seed) << 16 ^ wire_random(&seed);
        int decimals = i % (OLP_DECIMALS_MAX + 1);
        float value;
        if (i % 2)
            value = (float)((int)(wire_random(&seed) % 65536) - 32768) / 128;
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
    static const char *const NAMES[] = {"", "s", "a-b", "a b", "a=", "\xE4", "id\n"};
    static const char *const COMMANDS[] = {"", "G.o", "a b", "a&b", "a-b", "a%41", "\xE4"};
    static const char *const VALUES[] = {"&", "a\n", "\r", "%", "%4", "%4x", "ab%"};
    size_t i;

    for (i = 0; i < sizeof NAMES / sizeof *NAMES; ++i) {
        begin("x");
        CHECK_INT(olp_add_int(&line, NAMES[i], 1), OLP_RC_NAME);
        stays(OLP_RC_NAME);
    }
    /* As boards use them. */
    begin("Set_2");
    CHECK_INT(olp_add_int(&line, "Id", 1), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_int(&line, "num_blocks", 2), OLP_RC_SUCCESS);
    is_line(0, "c=Set_2&Id=1&num_blocks=2\n");
    CHECK_INT(olp_begin_command(&line, out, (int)sizeof out, "x"), OLP_RC_SUCCESS);
    CHECK_INT(olp_add_int(&line, "s", 1), OLP_RC_NAME);
    stays(OLP_RC_NAME);
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

/* Structs and arguments that hold anything. The buffer is where it says. */
static void hostile(void)
{
    static const int SIZES[] = {INT_MIN, -1, 0, 1, 64, 299, 300, INT_MAX};
    size_t i;

    for (i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
        begin("x");
        line.length = SIZES[i];
        CHECK(olp_add_int(&line, "v", 1) == OLP_RC_SUCCESS || line.length == 0 || SIZES[i] < 0);
        CHECK(olp_finish(&line, 1) <= (int)sizeof out);
        begin("x");
        line.cap = SIZES[i] < (int)sizeof out ? SIZES[i] : (int)sizeof out;
        CHECK(olp_finish(&line, 1) <= (int)sizeof out);
    }
    memset(&line, 0, sizeof line);
    CHECK_INT(olp_add_int(&line, "x", 1), OLP_RC_ERROR_GENERIC);
    memset(&line, 0, sizeof line);
    CHECK_INT(olp_finish(&line, 1), -OLP_RC_ERROR_GENERIC);

    CHECK_INT(olp_begin(NULL, out, 8, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, NULL, 8, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, NULL, 0, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_finish(&line, 0), -OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin(&line, out, -1, "x"), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_begin_command(&line, out, INT_MIN, "x"), OLP_RC_ERROR_GENERIC);
    out[0] = 'c';
    CHECK_INT(olp_begin(&line, out, 8, NULL), OLP_RC_ERROR_GENERIC);
    CHECK_INT(out[0], 0);
    CHECK_INT(olp_add_int(NULL, "x", 1), OLP_RC_ERROR_GENERIC);
    CHECK_INT(olp_finish(NULL, 1), -OLP_RC_ERROR_GENERIC);
}

int main(void)
{
    building();
    refusals();
    limits();
    hostile();
    return check_summary("line_encoder");
}
