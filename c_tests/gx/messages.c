/* gx.h: what the receivers make of the bytes of the proposal and of broken ones, and what the encoders write. */
#include "libdeltarobot/gx.h"

#include "check.h"
#include "receiver.h"

#include <stdlib.h>

static const struct gx_number none = {0, 0};

/* --- receiving --- */

static struct receiver receiver;

/* Feeds bytes to a new receiver, which ends in the middle of nothing: what they say, at most `room` things. */
static int hear(int host, const void *bytes, int count, struct gx_item *items, int room)
{
    struct gx_item item;
    int at = 0, heard = 0;
    memset(items, 0, (size_t)room * sizeof *items);
    start(&receiver, host);
    while (at < count) {
        memset(&item, 0x5A, sizeof item);
        at += receive(&receiver, (const char *)bytes + at, count - at, &item);
        if (item.kind != GX_NONE && heard < room)
            items[heard] = item;
        heard += item.kind != GX_NONE;
    }
    CHECK_INT(at, count);
    return heard;
}

/* One thing and nothing else. */
static struct gx_item only(int host, const void *bytes, int count, int kind, int format, int line)
{
    struct gx_item items[2];
    int heard = hear(host, bytes, count, items, 2);
    if (!check_int(heard, 1, "one item", __FILE__, line) || !check_int(items[0].kind, kind, "kind", __FILE__, line) ||
        !check_int(items[0].format, format, "format", __FILE__, line))
        check_dump("bytes", (const unsigned char *)bytes, (size_t)count);
    return items[0];
}
#define COMMAND(bytes, kind, format) only(0, bytes, (int)sizeof(bytes) - 1, kind, format, __LINE__)
#define NOTICE(bytes, kind, format) only(1, bytes, (int)sizeof(bytes) - 1, kind, format, __LINE__)

static void is_vector(struct gx_item item, int mask, int velocity, long x, long y, int line)
{
    check_int(item.vector.mask, mask, "mask", __FILE__, line);
    check_int(item.vector.velocity, velocity, "velocity", __FILE__, line);
    check_int(item.vector.axes[0], x, "x", __FILE__, line);
    check_int(item.vector.axes[1], y, "y", __FILE__, line);
    check_int(item.vector.axes[2], 0, "z", __FILE__, line);
}
#define VECTOR(item, mask, velocity, x, y) is_vector(item, mask, velocity, x, y, __LINE__)

static void is_numbered(struct gx_item item, int value, int format, int line)
{
    check_int(item.number.value, value, "number", __FILE__, line);
    check_int(item.number.format, format, "format of the number", __FILE__, line);
}
#define NUMBERED(item, value, format) is_numbered(item, value, format, __LINE__)

static void is_fault(struct gx_item item, int code, int line)
{
    check_int(item.code, code, "code", __FILE__, line);
}
#define BAD_COMMAND(bytes, format, fault) is_fault(COMMAND(bytes, GX_MALFORMED, format), fault, __LINE__)
#define BAD_NOTICE(bytes, format, fault) is_fault(NOTICE(bytes, GX_MALFORMED, format), fault, __LINE__)

static void vectors(void)
{
    VECTOR(COMMAND("!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF", GX_MOVE, GX_BINARY), 3, 0, 1000, -1000);
    VECTOR(COMMAND("*\x83\x81\xFF", GX_STEP, GX_BINARY), 3, 0, 1, -1);
    VECTOR(COMMAND("!\xC3\xE8\x87\xFF\xFF\xFF\xBF\x80\x80\x80\xC0", GX_MOVE, GX_BINARY), 0x43, 1000, GX_POSITION_MAX,
           GX_POSITION_MIN);
    VECTOR(COMMAND("*\xC3\xFF\xFF\xBF\xC0", GX_STEP, GX_BINARY), 0x43, 16383, 63, -64);
    /* Velocity alone. */
    VECTOR(COMMAND("!\xC0\xE8\x87", GX_MOVE, GX_BINARY), 0x40, 1000, 0, 0);
    VECTOR(COMMAND("*\xC0\x80\x80", GX_STEP, GX_BINARY), 0x40, 0, 0, 0);
    /* Axes come in their order, whichever there are. */
    CHECK_INT(COMMAND("!\xA0\x81\x80\x80\x80", GX_MOVE, GX_BINARY).vector.axes[5], 1);
    CHECK_INT(COMMAND("*\xA4\x82\x81", GX_STEP, GX_BINARY).vector.axes[2], 2);
    CHECK_INT(COMMAND("*\xA4\x82\x81", GX_STEP, GX_BINARY).vector.axes[5], 1);

    VECTOR(COMMAND("V1000x400y300\n", GX_MOVE, GX_ASCII), 0x43, 1000, 400, 300);
    VECTOR(COMMAND("V1000y300x400\r", GX_MOVE, GX_ASCII), 0x43, 1000, 400, 300);
    VECTOR(COMMAND(" \r\ny300  x400 V1000 \r\n\n", GX_MOVE, GX_ASCII), 0x43, 1000, 400, 300);
    VECTOR(COMMAND("x-134217728y+134217727\n", GX_MOVE, GX_ASCII), 3, 0, GX_POSITION_MIN, GX_POSITION_MAX);
    VECTOR(COMMAND("x-0y000000000000000000000000000000000000012\n", GX_MOVE, GX_ASCII), 3, 0, 0, 12);
    VECTOR(COMMAND("V16383\n", GX_MOVE, GX_ASCII), 0x40, 16383, 0, 0);

    CHECK_INT(COMMAND("R0\n", GX_REPORTING, GX_ASCII).period, 0);
    CHECK_INT(COMMAND("R16383\n", GX_REPORTING, GX_ASCII).period, 16383);
    CHECK_INT(COMMAND("~\x80\x80", GX_REPORTING, GX_BINARY).period, 0);
    CHECK_INT(COMMAND("~\xE8\x87", GX_REPORTING, GX_BINARY).period, 1000);
    CHECK_INT(COMMAND("~\xFF\xFF", GX_REPORTING, GX_BINARY).period, 16383);
    CHECK_INT(COMMAND("%\xFF\x80", GX_CONTROL, GX_BINARY).code, GX_CONTROL_QUERY);
    CHECK_INT(COMMAND("%254\n", GX_CONTROL, GX_ASCII).code, GX_CONTROL_HOLD);
    CHECK_INT(COMMAND("%\xFD\x82", GX_CONTROL, GX_BINARY).code, GX_CONTROL_RESUME);
    NUMBERED(COMMAND("#7%508\n", GX_CONTROL, GX_ASCII), 7, GX_ASCII);
    CHECK_INT(COMMAND("#7%508\n", GX_CONTROL, GX_ASCII).code, GX_CONTROL_STOP);
    CHECK_INT(COMMAND("%509\n", GX_CONTROL, GX_ASCII).code, GX_CONTROL_UNKNOWN);
    CHECK_INT(COMMAND("%\x83\x83", GX_CONTROL, GX_BINARY).code, GX_CONTROL_UNKNOWN);
    /* A period is no velocity. */
    VECTOR(COMMAND("~\xFF\xFF", GX_REPORTING, GX_BINARY), 0, 0, 0, 0);
}

/* A broken number, of the format told, and the command that a start byte behind it begins. */
static struct gx_item is_behind_broken(const char *bytes, int length, int format, int kind, int line)
{
    struct gx_item items[4];
    check_int(hear(0, bytes, length, items, 4), 2, "items", __FILE__, line);
    check_int(items[0].kind, GX_MALFORMED, "kind of the first", __FILE__, line);
    check_int(items[0].code, GX_FAULT_NUMBER, "code", __FILE__, line);
    check_int(items[0].format, format, "format", __FILE__, line);
    is_numbered(items[0], 0, 0, line);
    check_int(items[1].kind, kind, "kind of the second", __FILE__, line);
    is_numbered(items[1], 0, 0, line);
    return items[1];
}
#define behind_broken(bytes, format, kind) is_behind_broken(bytes, (int)sizeof(bytes) - 1, format, kind, __LINE__)

static void numbers(void)
{
    struct gx_item items[4];

    NUMBERED(COMMAND("!\x81\x80\x80\x80\x80", GX_MOVE, GX_BINARY), 0, 0);
    NUMBERED(COMMAND("#12 V1000x400\n", GX_MOVE, GX_ASCII), 12, GX_ASCII);
    NUMBERED(COMMAND("#0x400\n", GX_MOVE, GX_ASCII), 0, GX_ASCII);
    NUMBERED(COMMAND("#16383R5\n", GX_REPORTING, GX_ASCII), 16383, GX_ASCII);
    NUMBERED(COMMAND("#\x8C\x80*\x81\x81", GX_STEP, GX_BINARY), 12, GX_BINARY);
    NUMBERED(COMMAND("#\xFF\xFF~\x81\x81", GX_REPORTING, GX_BINARY), 16383, GX_BINARY);
    /* The formats of number and command are two things. */
    NUMBERED(COMMAND("#12!\x81\x80\x80\x80\x80", GX_MOVE, GX_BINARY), 12, GX_ASCII);
    NUMBERED(COMMAND("#\x8C\x80 x5\n", GX_MOVE, GX_ASCII), 12, GX_BINARY);
    NUMBERED(COMMAND("#12 *\x80", GX_MALFORMED, GX_BINARY), 12, GX_ASCII);

    /* A broken number tells none, and an ASCII command behind it goes with it. */
    BAD_COMMAND("#16384x5\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_COMMAND("#x5\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_COMMAND("# 5x5\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_COMMAND("#\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_COMMAND("#\x8Cx5\n", GX_BINARY, GX_FAULT_NUMBER);
    NUMBERED(COMMAND("#\x8C x5\n", GX_MALFORMED, GX_BINARY), 0, 0);

    /* A start byte clears it: what begins there is delivered, without a number. */
    VECTOR(behind_broken("#99999999999999999999*\x81\x81", GX_ASCII, GX_STEP), 1, 0, 1, 0);
    VECTOR(behind_broken("#16384 \x85!\x81\x82\x80\x80\x80", GX_ASCII, GX_MOVE), 1, 0, 2, 0);
    VECTOR(behind_broken("#!\x81\x81\x80\x80\x80", GX_ASCII, GX_MOVE), 1, 0, 1, 0);
    VECTOR(behind_broken("#\x8C*\x81\xFF", GX_BINARY, GX_STEP), 1, 0, -1, 0);
    CHECK_INT(behind_broken("#\x8C~\x81\x81", GX_BINARY, GX_REPORTING).period, 129);
    CHECK_INT(hear(0, "#\x8C#5x1\n", 7, items, 4), 2);
    CHECK_INT(items[0].code, GX_FAULT_NUMBER);
    NUMBERED(items[0], 0, 0);
    NUMBERED(items[1], 5, GX_ASCII);
}

static void malformed_commands(void)
{
    struct gx_item items[4];

    BAD_COMMAND("\x85\x86\x87", GX_BINARY, GX_FAULT_UNKNOWN);
    BAD_COMMAND("hello, world!\x1B", GX_ASCII, GX_FAULT_UNKNOWN);
    BAD_COMMAND("5x12\n", GX_ASCII, GX_FAULT_UNKNOWN);
    BAD_COMMAND("!\x80", GX_BINARY, GX_FAULT_EMPTY);
    BAD_COMMAND("#5\n", GX_ASCII, GX_FAULT_EMPTY);
    BAD_COMMAND("V1000 x\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x--5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x 5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x5,y6\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("V-5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("Vx1000x400y300\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("R5x5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x5R5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x5\x85y6\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_COMMAND("x5x5\n", GX_ASCII, GX_FAULT_REPEATED);
    BAD_COMMAND("V5y1V5\n", GX_ASCII, GX_FAULT_REPEATED);
    BAD_COMMAND("x134217728\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_COMMAND("x-134217729\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_COMMAND("x99999999999999999999\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_COMMAND("x4294967297\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_COMMAND("V16384\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_COMMAND("R65536\n", GX_ASCII, GX_FAULT_RANGE);

    /* What interrupts a command is one itself. */
    CHECK_INT(hear(0, "#12!\x83\xE8*\x81\x81", 9, items, 4), 2);
    CHECK_INT(items[0].kind, GX_MALFORMED);
    CHECK_INT(items[0].code, GX_FAULT_INTERRUPTED);
    NUMBERED(items[0], 12, GX_ASCII);
    CHECK_INT(items[1].kind, GX_STEP);
    NUMBERED(items[1], 0, 0);
    CHECK_INT(hear(0, "x5y#\x81\x80!\x81\x81\x81\x81\x81", 12, items, 4), 2);
    CHECK_INT(items[0].code, GX_FAULT_INTERRUPTED);
    CHECK_INT(items[0].format, GX_ASCII);
    CHECK_INT(items[1].kind, GX_MOVE);
    NUMBERED(items[1], 1, GX_BINARY);
    CHECK_INT(hear(0, "#5#6x1\n", 7, items, 4), 2);
    NUMBERED(items[0], 5, GX_ASCII);
    NUMBERED(items[1], 6, GX_ASCII);
    /* An ASCII command behind a binary one that lost its end. */
    CHECK_INT(hear(0, "!\x83\xE8x7\n", 6, items, 4), 2);
    CHECK_INT(items[0].code, GX_FAULT_SYNTAX);
    CHECK_INT(items[1].vector.axes[0], 7);
    /* ESC clears, and says nothing. */
    CHECK_INT(hear(0, "#12!\x83\xE8\x1Bx5y\x1B#\x1B*\x81\x1B*\x81\x82", 19, items, 4), 1);
    CHECK_INT(items[0].vector.axes[0], 2);
    NUMBERED(items[0], 0, 0);
}

static void hear_notices(void)
{
    struct gx_item items[4], item;

    NUMBERED(NOTICE("#12\n", GX_COMPLETED, GX_ASCII), 12, GX_ASCII);
    NUMBERED(NOTICE("#\x8C\x80\n", GX_COMPLETED, GX_BINARY), 12, GX_BINARY);
    CHECK_INT(NOTICE("?\x85", GX_REFUSED, GX_BINARY).code, 5);
    CHECK_INT(NOTICE("?5\r\n", GX_REFUSED, GX_ASCII).code, 5);
    CHECK_INT(NOTICE("?127\n", GX_REFUSED, GX_ASCII).code, 127);
    NUMBERED(NOTICE("?127\n", GX_REFUSED, GX_ASCII), 0, 0);
    NUMBERED(NOTICE("#\x8C\x80?\xFF", GX_REFUSED, GX_BINARY), 12, GX_BINARY);
    CHECK_INT(NOTICE("#\x8C\x80?\xFF", GX_REFUSED, GX_BINARY).code, 127);
    NUMBERED(NOTICE("#\x8C\x80?9\n", GX_REFUSED, GX_ASCII), 12, GX_BINARY);
    NUMBERED(NOTICE("#12?\x89", GX_REFUSED, GX_BINARY), 12, GX_ASCII);
    NUMBERED(NOTICE("#12?9\n", GX_REFUSED, GX_ASCII), 12, GX_ASCII);
    VECTOR(NOTICE("=x400y-300\n", GX_POSITION, GX_ASCII), 3, 0, 400, -300);
    VECTOR(NOTICE("=!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF", GX_POSITION, GX_BINARY), 3, 0, 1000, -1000);

    VECTOR(NOTICE("=!\xC1\xE8\x87\x85\x80\x80\x80", GX_POSITION, GX_BINARY), 0x41, 1000, 5, 0);
    VECTOR(NOTICE("=x5V1000\n", GX_POSITION, GX_ASCII), 0x41, 1000, 5, 0);
    /* Confirmations and the status: 14 bits each. */
    NUMBERED(NOTICE("&\xD6\xAA", GX_CONFIRMED, GX_BINARY), 86, GX_BINARY);
    CHECK_INT(NOTICE("&\xD6\xAA", GX_CONFIRMED, GX_BINARY).code, 42);
    NUMBERED(NOTICE("&5462\n", GX_CONFIRMED, GX_ASCII), 86, GX_ASCII);
    CHECK_INT(NOTICE("&5462\n", GX_CONFIRMED, GX_ASCII).code, 42);
    CHECK_INT(NOTICE("%\x8F\x82", GX_STATUS, GX_BINARY).period, 15);
    CHECK_INT(NOTICE("%\x8F\x82", GX_STATUS, GX_BINARY).code, 1);
    CHECK_INT(NOTICE("%15\n", GX_STATUS, GX_ASCII).period, 15);
    CHECK_INT(NOTICE("%15\n", GX_STATUS, GX_ASCII).code, 0);
    BAD_NOTICE("&16384\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_NOTICE("&\x80\n", GX_BINARY, GX_FAULT_SYNTAX);
    BAD_NOTICE("%\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_NOTICE("?128\n", GX_ASCII, GX_FAULT_RANGE);
    BAD_NOTICE("?\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_NOTICE("#16384\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_NOTICE("#\n", GX_ASCII, GX_FAULT_NUMBER);
    BAD_NOTICE("#12 \n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_NOTICE("=!\x80", GX_BINARY, GX_FAULT_EMPTY);
    BAD_NOTICE("=R5\n", GX_ASCII, GX_FAULT_SYNTAX);
    BAD_NOTICE("=\n", GX_ASCII, GX_FAULT_EMPTY);
    BAD_NOTICE("x5\n", GX_ASCII, GX_FAULT_UNKNOWN);

    /* A packed number may be the beginning of an error notice: it is told when something else comes... */
    CHECK_INT(hear(1, "#\x8C\x80#\x8D\x80?\x81#\x8E\x80=!\x81\x81\x80\x80\x80", 18, items, 4), 4);
    CHECK_INT(items[0].kind, GX_COMPLETED);
    CHECK_INT(items[1].kind, GX_REFUSED);
    NUMBERED(items[1], 13, GX_BINARY);
    CHECK_INT(items[2].kind, GX_COMPLETED);
    CHECK_INT(items[3].kind, GX_POSITION);
    /* ... or when nothing does. */
    CHECK_INT(hear(1, "#\x8C\x80", 3, items, 4), 0);
    idle(&receiver, &item);
    CHECK_INT(item.kind, GX_COMPLETED);
    NUMBERED(item, 12, GX_BINARY);
    idle(&receiver, &item);
    CHECK_INT(item.kind, GX_NONE);
    CHECK_INT(hear(1, "#12", 3, items, 4), 0);
    idle(&receiver, &item);
    CHECK_INT(item.kind, GX_MALFORMED);
    NUMBERED(item, 0, 0);
    CHECK_INT(hear(0, "#12 !\x81\x80", 7, items, 4), 0);
    idle(&receiver, &item);
    CHECK_INT(item.kind, GX_MALFORMED);
    CHECK_INT(item.code, GX_FAULT_INTERRUPTED);
    NUMBERED(item, 12, GX_ASCII);
}

/* --- encoding --- */

static struct gx_vector vector(int mask, int velocity, long x, long y)
{
    struct gx_vector made;
    memset(&made, 0x5A, sizeof made);
    made.mask = (unsigned char)mask;
    made.velocity = (uint16_t)velocity;
    made.axes[0] = (int32_t)x;
    made.axes[1] = (int32_t)y;
    return made;
}

static char room[GX_ENCODED_MAX];
static int written;

#define WRITES(call, bytes)                                                                                            \
    do {                                                                                                               \
        memset(room, 0, sizeof room);                                                                                  \
        written = (call);                                                                                              \
        CHECK_INT(written, sizeof(bytes) - 1);                                                                         \
        CHECK_BYTES(room, bytes, sizeof(bytes) - 1);                                                                   \
    } while (0)

/* The residue modulo 127 of all values, 32 bits each, the highest byte first; positions counted from the least one. */
static void check_by_the_definition(const struct gx_vector *target, int number)
{
    uint32_t values[2 + GX_AXES];
    unsigned sum = 0;
    int axis, i;
    memset(values, 0, sizeof values);
    values[0] = (uint32_t)number;
    if (target->mask & GX_MASK_VELOCITY)
        values[1] = target->velocity;
    for (axis = 0; axis < GX_AXES; ++axis)
        if (target->mask >> axis & 1)
            values[2 + axis] = (uint32_t)(target->axes[axis] + 134217728);
    for (i = 0; i < 4 * (2 + GX_AXES); ++i)
        sum = (sum * 256 + (values[i / 4] >> (24 - 8 * (i % 4)) & 255)) % 127;
    CHECK_INT(gx_check(target, number), sum);
}

static void write_vectors(void)
{
    const struct gx_number twelve = number(12, GX_BINARY), twelve_ascii = number(12, GX_ASCII);
    const struct gx_number last = number(16383, GX_ASCII);
    const struct gx_vector fast = vector(0x43, 1000, 400, 300), step = vector(3, 0, 1, -1);
    struct gx_vector all = {16383, 0x7F, {0, 0, 0, 0, 0, 0}}, target = vector(3, 9999, 1000, -1000), from;
    int i;

    WRITES(gx_write_move(GX_BINARY, NULL, &target, room, sizeof room), "!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF");
    WRITES(gx_write_move(GX_BINARY, &twelve, &target, room, sizeof room),
           "#\x8C\x80!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF");
    WRITES(gx_write_move(GX_ASCII, &none, &fast, room, sizeof room), "V1000x400y300\n");
    WRITES(gx_write_move(GX_ASCII, &twelve_ascii, &target, room, sizeof room), "#12x1000y-1000\n");
    WRITES(gx_write_step(NULL, &step, room, sizeof room), "*\x83\x81\xFF");
    WRITES(gx_write_reporting(GX_ASCII, NULL, 0, room, sizeof room), "R0\n");
    WRITES(gx_write_reporting(GX_BINARY, &twelve_ascii, 1000, room, sizeof room), "#12~\xE8\x87");
    WRITES(gx_write_completed(&twelve, room, sizeof room), "#\x8C\x80");
    WRITES(gx_write_completed(&twelve_ascii, room, sizeof room), "#12\n");
    WRITES(gx_write_refused(GX_BINARY, &twelve, 5, room, sizeof room), "#\x8C\x80?\x85");
    WRITES(gx_write_refused(GX_ASCII, &twelve_ascii, 127, room, sizeof room), "#12?127\n");
    WRITES(gx_write_refused(GX_BINARY, NULL, 5, room, sizeof room), "\n?\x85");
    WRITES(gx_write_refused(GX_ASCII, NULL, 5, room, sizeof room), "\n?5\n");
    WRITES(gx_write_position(GX_BINARY, &target, room, sizeof room), "=!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF");
    WRITES(gx_write_position(GX_ASCII, &target, room, sizeof room), "=x1000y-1000\n");
    WRITES(gx_write_position(GX_ASCII, &fast, room, sizeof room), "=V1000x400y300\n");
    WRITES(gx_write_control(GX_BINARY, NULL, GX_CONTROL_STOP, room, sizeof room), "%\xFC\x83");
    WRITES(gx_write_control(GX_ASCII, &twelve_ascii, GX_CONTROL_QUERY, room, sizeof room), "#12%127\n");
    WRITES(gx_write_confirmed(&twelve, 42, room, sizeof room), "&\x8C\xAA");
    WRITES(gx_write_confirmed(&last, 1, room, sizeof room), "&255\n");
    WRITES(gx_write_status(GX_BINARY, 16, 1, room, sizeof room), "%\x90\x82");
    WRITES(gx_write_status(GX_ASCII, 0, 0, room, sizeof room), "%0\n");
    CHECK_INT(gx_write_control(GX_ASCII, NULL, 4, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_control(GX_ASCII, NULL, -1, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_control(3, NULL, 0, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_confirmed(NULL, 1, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_confirmed(&twelve, 128, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_status(GX_BINARY, 256, 0, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_status(GX_BINARY, -1, 0, room, sizeof room), -GX_RC_RANGE);
    check_by_the_definition(&fast, 12);
    check_by_the_definition(&step, 16383);
    check_by_the_definition(&all, 0);
    CHECK_INT(gx_check(NULL, 0), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_check(&step, -1), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_check(&step, 16384), -GX_RC_ERROR_GENERIC);

    /* The longest of all, into exactly its room and into all that are smaller. */
    for (i = 0; i < 6; ++i)
        all.axes[i] = GX_POSITION_MIN;
    written = gx_write_move(GX_ASCII, &last, &all, room, sizeof room);
    CHECK_INT(written, 6 + 6 + 6 * 11 + 1);
    for (i = 0; i <= written; ++i) {
        char *exact = malloc((size_t)i);
        CHECK_INT(gx_write_move(GX_ASCII, &last, &all, exact, i), i == written ? written : -GX_RC_OVERFLOW);
        free(exact);
    }
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &all, room, sizeof room), 28);

    /* The shortest form: short where it can be, long where it can't, and no axis that stays. */
    from = vector(3, 0, 1000, -1000);
    target = vector(3, 0, 1001, -1001);
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "*\x83\x81\xFF");
    target = vector(0x43, 1000, 1063, -1000);
    WRITES(gx_write_shortest(&twelve, &target, &from, room, sizeof room), "#\x8C\x80*\xC1\xE8\x87\xBF");
    target = vector(3, 0, 1000, -1064);
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "!\x82\xD8\xF7\xFF\xFF");
    target = vector(3, 0, 1000, -1000);
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "*\x81\x80");
    from.mask = 1;
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "!\x82\x98\xF8\xFF\xFF");
    WRITES(gx_write_shortest(NULL, &target, NULL, room, sizeof room), "!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF");
    /* A base that is no position, whose distance is no int32_t either. */
    from = vector(3, 0, 2147483647, -2147483647 - 1);
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF");
    target = vector(0x40, 1000, 0, 0);
    WRITES(gx_write_shortest(NULL, &target, &from, room, sizeof room), "*\xC0\xE8\x87");
}

static void what_can_not_be_written(void)
{
    static const long positions[] = {GX_POSITION_MAX + 1L, GX_POSITION_MIN - 1L, 2147483647L, -2147483647L - 1};
    static const int deltas[] = {64, -64, 127, -128, 1000};
    struct gx_number bad_format = number(1, 3), too_large = number(16384, GX_BINARY);
    struct gx_vector target;
    size_t i;
    for (i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        target = vector(3, 0, 0, positions[i]);
        CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, room, sizeof room), -GX_RC_RANGE);
        CHECK_INT(gx_write_move(GX_ASCII, NULL, &target, room, sizeof room), -GX_RC_RANGE);
        CHECK_INT(gx_write_shortest(NULL, &target, NULL, room, sizeof room), -GX_RC_RANGE);
        CHECK_INT(gx_write_position(GX_ASCII, &target, room, sizeof room), -GX_RC_RANGE);
    }
    for (i = 0; i < sizeof deltas / sizeof deltas[0]; ++i) {
        target = vector(3, 0, 0, deltas[i]);
        CHECK_INT(gx_write_step(NULL, &target, room, sizeof room), -GX_RC_RANGE);
    }
    target = vector(0x43, 16384, 0, 0);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_step(NULL, &target, room, sizeof room), -GX_RC_RANGE);
    target = vector(0x83, 0, 0, 0);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, room, sizeof room), -GX_RC_RANGE);
    target = vector(0x43, 5, 0, 0);
    target.mask = 0x80;
    CHECK_INT(gx_write_position(GX_BINARY, &target, room, sizeof room), -GX_RC_RANGE);
    target.mask = 0x43;
    CHECK_INT(gx_write_move(GX_BINARY, &too_large, &target, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_completed(&too_large, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_confirmed(&too_large, 1, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_refused(GX_BINARY, NULL, 128, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_refused(GX_BINARY, NULL, -1, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_refused(GX_BINARY, NULL, 256, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_reporting(GX_BINARY, NULL, 16384, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_reporting(GX_BINARY, NULL, -1, room, sizeof room), -GX_RC_RANGE);
    CHECK_INT(gx_write_reporting(GX_BINARY, NULL, 65536, room, sizeof room), -GX_RC_RANGE);

    CHECK_INT(gx_write_move(0, NULL, &target, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(3, NULL, &target, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(GX_BINARY, &bad_format, &target, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, NULL, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, NULL, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, room, -1), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, NULL, 0), -GX_RC_OVERFLOW);
    CHECK_INT(gx_write_step(NULL, NULL, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_shortest(NULL, NULL, NULL, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_position(GX_BINARY, NULL, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_position(0, &target, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_reporting(0, NULL, 1, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_refused(0, NULL, 1, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_completed(NULL, room, sizeof room), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_write_completed(&none, room, sizeof room), -GX_RC_ERROR_GENERIC);
    target.mask = 0;
    CHECK_INT(gx_write_move(GX_BINARY, NULL, &target, room, sizeof room), -GX_RC_ERROR_GENERIC);
}

static void null_pointers(void)
{
    struct gx_commands commands;
    struct gx_notices notices;
    struct gx_item item;
    CHECK_INT(gx_commands_init(NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_init(NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_init(&commands), GX_RC_SUCCESS);
    CHECK_INT(gx_notices_init(&notices), GX_RC_SUCCESS);
    CHECK_INT(gx_commands_receive(NULL, room, 1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, NULL, 1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, NULL, 100, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, room, 1, NULL), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, room, 50, NULL), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(NULL, room, 50, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, room, -1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_receive(&commands, NULL, 0, &item), 0);
    CHECK_INT(item.kind, GX_NONE);
    CHECK_INT(gx_notices_receive(NULL, room, 1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_receive(&notices, NULL, 1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_receive(&notices, room, 1, NULL), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_receive(&notices, room, -1, &item), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_idle(NULL, &item), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_commands_idle(&commands, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_idle(NULL, &item), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_notices_idle(&notices, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_follow(NULL, &item), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_follow(&item.vector, NULL), GX_RC_ERROR_GENERIC);
}

static void follow(void)
{
    struct gx_vector position = vector(0, 0, 7, 7), before;
    struct gx_item item;
    memset(&item, 0, sizeof item);
    item.kind = GX_STEP;
    item.vector = vector(3, 0, 1, 1);
    CHECK_INT(gx_follow(&position, &item), GX_RC_NOT_FOUND);
    CHECK_INT(position.mask, 0);
    item.kind = GX_MOVE;
    item.vector = vector(0x43, 50, GX_POSITION_MAX - 1, GX_POSITION_MIN);
    CHECK_INT(gx_follow(&position, &item), GX_RC_SUCCESS);
    CHECK_INT(position.mask, 0x43);
    CHECK_INT(position.velocity, 50);
    item.kind = GX_STEP;
    item.vector = vector(3, 99, 1, 1);
    CHECK_INT(gx_follow(&position, &item), GX_RC_SUCCESS);
    CHECK_INT(position.axes[0], GX_POSITION_MAX);
    CHECK_INT(position.axes[1], GX_POSITION_MIN + 1);
    CHECK_INT(position.velocity, 50);
    before = position;
    CHECK_INT(gx_follow(&position, &item), GX_RC_RANGE);
    CHECK_BYTES(&position, &before, sizeof before);
    item.vector.mask = 0x07;
    item.vector.axes[0] = 0;
    CHECK_INT(gx_follow(&position, &item), GX_RC_NOT_FOUND);
    CHECK_BYTES(&position, &before, sizeof before);
    item.kind = GX_COMPLETED;
    CHECK_INT(gx_follow(&position, &item), GX_RC_SUCCESS);
    CHECK_BYTES(&position, &before, sizeof before);
}

int main(void)
{
    vectors();
    numbers();
    malformed_commands();
    hear_notices();
    write_vectors();
    what_can_not_be_written();
    null_pointers();
    follow();
    return check_summary("gx");
}
