/*
 * ContouringProtocol.h, as a program uses it that was written for the posted header: its types by the posted names, its
 * u_int8_t, its functions without a look at what they return. Then, each by name, the faults of the posted code.
 */
#include "ContouringProtocol.h"

#include "check.h"

#include <stddef.h>

#define ALL_AXES 0x3F
#define POSITION_MAX 134217727
#define POSITION_MIN (-134217728)

/* --- the program: sends a path of two axes, and reads it at the other end --- */

static u_int8_t line[4096];
static u_int16_t line_used;

static void send_buffer(const CPPackedVectorCommandBuffer *buffer)
{
    u_int8_t i;
    for (i = 0; i < buffer->length; i++)
        line[line_used++] = buffer->bytes[i];
}

static void a_program_for_the_posted_header(void)
{
    static const int32_t path[][2] = {
        {1000, -1000}, {1001, -1001}, {1064, -1064}, {2000000, -3000000}, {1999937, -2999937}};
    CPPackedVectorCommandBuffer buffer;
    CPVectorCommand command, received;
    u_int32_t i;
    u_int16_t at;

    line_used = 0;
    command.targetVelocity = 1000;
    for (i = 0; i < sizeof path / sizeof path[0]; i++) {
        if (i == 0 || i == 3) {
            command.axisMask = CPMask_x | CPMask_y | CPMask_velocity;
            command.axisPosition[CPAxis_x] = path[i][0];
            command.axisPosition[CPAxis_y] = path[i][1];
            PackCPVectorCommand(&buffer, &command);
            CHECK_INT(buffer.length, 12);
        } else {
            command.axisMask = CPMask_x | CPMask_y;
            command.axisPosition[CPAxis_x] = path[i][0] - path[i - 1][0];
            command.axisPosition[CPAxis_y] = path[i][1] - path[i - 1][1];
            PackCPShortVectorCommand(&buffer, &command);
            CHECK_INT(buffer.length, 4);
        }
        send_buffer(&buffer);
    }

    memset(&received, 0, sizeof received);
    for (at = 0, i = 0; at < line_used; i++) {
        buffer.length = line[at] == '!' ? 12 : 4;
        memcpy(buffer.bytes, line + at, buffer.length);
        if (line[at] == '!')
            UnpackCPVectorCommand(&buffer, &received);
        else
            UnpackCPShortVectorCommand(&buffer, &received);
        at = (u_int16_t)(at + buffer.length);
        CHECK_INT(received.axisPosition[CPAxis_x], path[i][0]);
        CHECK_INT(received.axisPosition[CPAxis_y], path[i][1]);
        CHECK_INT(received.targetVelocity, 1000);
        CHECK_INT(received.axisPosition[CPAxis_z], 0);
    }
    CHECK_INT(i, 5);
}

/* --- packing and unpacking, one value at a time --- */

/* Memory as C leaves it. */
static CPPackedVectorCommandBuffer dirty_buffer(void)
{
    CPPackedVectorCommandBuffer buffer;
    memset(&buffer, 0xA5, sizeof buffer);
    return buffer;
}

static CPVectorCommand vector(u_int8_t mask, u_int16_t velocity, int32_t x, int32_t y)
{
    CPVectorCommand command;
    memset(&command, 0x5A, sizeof command);
    command.axisMask = mask;
    command.targetVelocity = velocity;
    command.axisPosition[CPAxis_x] = x;
    command.axisPosition[CPAxis_y] = y;
    return command;
}

static void the_vectors_of_the_proposal(void)
{
    CPVectorCommand command = vector(CPMask_x | CPMask_y, 0, 1000, -1000);
    CPPackedVectorCommandBuffer buffer = dirty_buffer();
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_INT(buffer.length, 10);
    CHECK_BYTES(buffer.bytes, "\x21\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF", 10);

    command = vector(CPMask_x | CPMask_y, 0, 1, -1);
    CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_INT(buffer.length, 4);
    CHECK_BYTES(buffer.bytes, "\x2A\x83\x81\xFF", 4);

    command = vector(CPMask_velocity | CPMask_x, 1000, 0, 0);
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_BYTES(buffer.bytes, "\x21\xC1\xE8\x87\x80\x80\x80\x80", 8);

    memset(&command, 0, sizeof command);
    command.axisMask = ALL_AXES | CPMask_velocity;
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_INT(buffer.length, 28);
    CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_INT(buffer.length, 10);
}

static int32_t through_the_long_form(int32_t position)
{
    CPVectorCommand command = vector(CPMask_x, 0, position, 0), unpacked = vector(0, 7, 5, 6);
    CPPackedVectorCommandBuffer buffer = dirty_buffer();
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_ok);
    CHECK_INT(UnpackCPVectorCommand(&buffer, &unpacked), CPResult_ok);
    CHECK_INT(unpacked.axisMask, CPMask_x);
    CHECK_INT(unpacked.targetVelocity, 7);
    CHECK_INT(unpacked.axisPosition[CPAxis_y], 6);
    return unpacked.axisPosition[CPAxis_x];
}

/* 1. The fourth group was unpacked with a shift of 28, so that 2097152 came back as 268435456. */
static void fault_1_shift_of_the_fourth_group(void)
{
    int bit;
    for (bit = 0; bit < 27; ++bit) {
        CHECK_INT(through_the_long_form((int32_t)1 << bit), 1L << bit);
        CHECK_INT(through_the_long_form(((int32_t)1 << bit) - 1), (1L << bit) - 1);
    }
    CHECK_INT(through_the_long_form(2097152), 2097152);
    CHECK_INT(through_the_long_form(POSITION_MAX), POSITION_MAX);
}

/* 2. The sign was not extended, so that -1 came back as 268435455. */
static void fault_2_sign_of_28_bits(void)
{
    int bit;
    CHECK_INT(through_the_long_form(-1), -1);
    for (bit = 0; bit <= 27; ++bit)
        CHECK_INT(through_the_long_form(-((int32_t)1 << bit)), -(1L << bit));
}

/* 3. What does not fit was packed all the same, less its upper bits. */
static void fault_3_values_that_do_not_fit(void)
{
    static const int32_t positions[] = {POSITION_MAX + 1, POSITION_MIN - 1, 2147483647, -2147483647 - 1, 268435456};
    static const int32_t deltas[] = {64, -64, -65, 127, 128, -128, 256, 2147483647, -2147483647 - 1};
    CPPackedVectorCommandBuffer buffer;
    CPVectorCommand command;
    size_t i;
    int axis;
    for (axis = 0; axis < 6; ++axis) {
        for (i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
            memset(&command, 0, sizeof command);
            command.axisMask = (u_int8_t)(1 << axis);
            command.axisPosition[axis] = positions[i];
            buffer = dirty_buffer();
            CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_range);
            CHECK_INT(buffer.length, 0);
            /* Nobody asks for the values of the other axes. */
            command.axisMask = (u_int8_t)(ALL_AXES & ~(1 << axis));
            CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_ok);
            CHECK_INT(buffer.length, 22);
        }
        for (i = 0; i < sizeof deltas / sizeof deltas[0]; ++i) {
            memset(&command, 0, sizeof command);
            command.axisMask = (u_int8_t)(1 << axis);
            command.axisPosition[axis] = deltas[i];
            buffer = dirty_buffer();
            CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_range);
            CHECK_INT(buffer.length, 0);
        }
    }
    for (i = 0; i < 2; ++i) {
        command = vector(CPMask_velocity | CPMask_x, i ? 65535 : 16384, 1, 1);
        buffer = dirty_buffer();
        CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_range);
        CHECK_INT(buffer.length, 0);
        CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_range);
        command.axisMask = CPMask_x;
        CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_ok);
    }
    command = vector(0x80 | CPMask_x, 0, 1, 1);
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_range);
    CHECK_INT(buffer.length, 0);
}

/* 4. The same fields are deltas when packing and positions when unpacking, and their sum overflowed. */
static void fault_4_deltas_and_positions(void)
{
    CPPackedVectorCommandBuffer buffer;
    CPVectorCommand deltas, position, before;
    int32_t delta;
    for (delta = -63; delta <= 63; ++delta) {
        buffer = dirty_buffer();
        deltas = vector(CPMask_x | CPMask_y, 0, delta, -delta);
        position = vector(0, 9, 500, POSITION_MIN + 63);
        CHECK_INT(PackCPShortVectorCommand(&buffer, &deltas), CPResult_ok);
        CHECK_INT(UnpackCPShortVectorCommand(&buffer, &position), CPResult_ok);
        CHECK_INT(position.axisPosition[CPAxis_x], 500 + delta);
        CHECK_INT(position.axisPosition[CPAxis_y], POSITION_MIN + 63 - delta);
        CHECK_INT(position.axisPosition[CPAxis_z], 0x5A5A5A5A);
        CHECK_INT(position.targetVelocity, 9);
        CHECK_INT(position.axisMask, CPMask_x | CPMask_y);
    }
    /* -64 is read, though never written. */
    memcpy(buffer.bytes, "*\x81\xC0", 3);
    buffer.length = 3;
    position = vector(0, 0, 64, 0);
    CHECK_INT(UnpackCPShortVectorCommand(&buffer, &position), CPResult_ok);
    CHECK_INT(position.axisPosition[CPAxis_x], 0);

    /* Beyond the last position: nothing changes, the axis that could have moved included. */
    memcpy(buffer.bytes, "*\xC3\x81\x80\x85\x81", 6);
    buffer.length = 6;
    for (delta = 0; delta < 3; ++delta) {
        static const int32_t ends[] = {POSITION_MAX, 2147483647, POSITION_MIN - 2};
        position = vector(0, 3, 10, ends[delta]);
        before = position;
        CHECK_INT(UnpackCPShortVectorCommand(&buffer, &position), CPResult_range);
        CHECK_BYTES(&position, &before, sizeof before);
    }
    position = vector(0, 3, 10, POSITION_MAX - 1);
    CHECK_INT(UnpackCPShortVectorCommand(&buffer, &position), CPResult_ok);
    CHECK_INT(position.axisPosition[CPAxis_y], POSITION_MAX);
    CHECK_INT(position.targetVelocity, 1);
}

/* 5. The length was never set, and the unpackers took any bytes for a command. */
static void fault_5_length_and_frame(void)
{
    CPVectorCommand command = vector(CPMask_velocity | CPMask_x | CPMask_c, 77, 5, 0), target, before;
    CPPackedVectorCommandBuffer good, buffer;
    int is_short, at, length, bit;
    for (is_short = 0; is_short < 2; ++is_short) {
        int (*const unpack)(CPPackedVectorCommandBuffer *, CPVectorCommand *) =
            is_short ? UnpackCPShortVectorCommand : UnpackCPVectorCommand;
        int (*const other)(CPPackedVectorCommandBuffer *, CPVectorCommand *) =
            is_short ? UnpackCPVectorCommand : UnpackCPShortVectorCommand;
        command.axisPosition[CPAxis_c] = -6;
        good = dirty_buffer();
        CHECK_INT((is_short ? PackCPShortVectorCommand : PackCPVectorCommand)(&good, &command), CPResult_ok);
        CHECK_INT(good.length, is_short ? 6 : 12);
        memset(&target, 0, sizeof target);
        before = target;
        CHECK_INT(other(&good, &target), CPResult_malformed);
        for (length = 0; length < 256; ++length) {
            buffer = good;
            buffer.length = (u_int8_t)length;
            CHECK_INT(unpack(&buffer, &target), length == good.length ? CPResult_ok : CPResult_malformed);
            if (length == good.length) {
                CHECK_INT(target.targetVelocity, 77);
                target = before;
            }
            CHECK_BYTES(&target, &before, sizeof before);
        }
        for (at = 0; at < good.length; ++at) {
            buffer = good;
            buffer.bytes[at] &= 0x7F;
            if (at == 0)
                buffer.bytes[at] = '#';
            CHECK_INT(unpack(&buffer, &target), CPResult_malformed);
            CHECK_BYTES(&target, &before, sizeof before);
        }
        /* Another mask asks for another length; none at all is no command. */
        for (at = 0; at < 128; ++at) {
            buffer = good;
            buffer.bytes[1] = (u_int8_t)(0x80 | at);
            length = 2 + (at & 64 ? 2 : 0);
            for (bit = 0; bit < 6; ++bit)
                if (at >> bit & 1)
                    length += is_short ? 1 : 4;
            CHECK_INT(unpack(&buffer, &target), at != 0 && length == good.length ? CPResult_ok : CPResult_malformed);
            target = before;
        }
    }
    memcpy(buffer.bytes, "x5\n#", 4);
    buffer.length = 3;
    CHECK_INT(UnpackCPVectorCommand(&buffer, &target), CPResult_malformed);
    memcpy(buffer.bytes, "\n!\x81\x80\x80\x80\x80", 7);
    buffer.length = 7;
    CHECK_INT(UnpackCPVectorCommand(&buffer, &target), CPResult_malformed);
}

static void null_pointers(void)
{
    CPVectorCommand command = vector(CPMask_x, 0, 1, 1);
    CPPackedVectorCommandBuffer buffer = dirty_buffer();
    CHECK_INT(PackCPVectorCommand(NULL, &command), CPResult_error);
    CHECK_INT(PackCPShortVectorCommand(NULL, NULL), CPResult_error);
    CHECK_INT(PackCPVectorCommand(&buffer, NULL), CPResult_error);
    CHECK_INT(buffer.length, 0);
    CHECK_INT(UnpackCPVectorCommand(NULL, &command), CPResult_error);
    CHECK_INT(UnpackCPVectorCommand(&buffer, NULL), CPResult_error);
    CHECK_INT(UnpackCPShortVectorCommand(NULL, &command), CPResult_error);
    CHECK_INT(UnpackCPShortVectorCommand(&buffer, NULL), CPResult_error);
    buffer = dirty_buffer();
    command.axisMask = 0;
    CHECK_INT(PackCPVectorCommand(&buffer, &command), CPResult_error);
    CHECK_INT(buffer.length, 0);
    CHECK_INT(PackCPShortVectorCommand(&buffer, &command), CPResult_error);
}

int main(void)
{
    a_program_for_the_posted_header();
    the_vectors_of_the_proposal();
    fault_1_shift_of_the_fourth_group();
    fault_2_sign_of_28_bits();
    fault_3_values_that_do_not_fit();
    fault_4_deltas_and_positions();
    fault_5_length_and_frame();
    null_pointers();
    return check_summary("contouring");
}
