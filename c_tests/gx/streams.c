/*
 * gx.h over random streams: the receivers and the encoders against each other and against the reference, however
 * streams are cut and damaged, and from memory that holds anything.
 */
#include "reference.h"

#include "check.h"
#include "receiver.h"
#include "wire.h"

#include <stdlib.h>

static unsigned long seed = 6;

static int any(int count)
{
    return (int)(wire_random(&seed) % (unsigned)count);
}

static int32_t any_position(void)
{
    int bits = any(28);
    int32_t value = (int32_t)(wire_random(&seed) & ((1ul << bits) - 1));
    if (any(20) == 0)
        return any(2) ? GX_POSITION_MAX : GX_POSITION_MIN;
    return any(2) ? value : -value;
}

/* Writes a random command or notice, and what it has to be read as. */
static int any_item(int host, char *out, struct gx_item *item)
{
    int i, is_short;
    memset(item, 0, sizeof *item);
    item->format = (unsigned char)(GX_BINARY + any(2));
    if (any(2))
        item->number = number(any(16384), GX_BINARY + any(2));
    item->vector.mask = (unsigned char)(1 + any(127));
    is_short = !host && any(2);
    for (i = 0; i < 6; ++i)
        if (item->vector.mask >> i & 1)
            item->vector.axes[i] = is_short ? any(127) - 63 : any_position();
    if (item->vector.mask & 0x40)
        item->vector.velocity = (uint16_t)any(16384);
    if (!host && any(8) == 0) {
        memset(&item->vector, 0, sizeof item->vector);
        item->kind = GX_REPORTING;
        item->period = (uint16_t)any(16384);
        return gx_write_reporting(item->format, &item->number, item->period, out, GX_ENCODED_MAX);
    }
    if (!host && any(8) == 0) {
        memset(&item->vector, 0, sizeof item->vector);
        item->kind = GX_CONTROL;
        item->code = (unsigned char)any(4);
        return gx_write_control(item->format, &item->number, item->code, out, GX_ENCODED_MAX);
    }
    if (is_short) {
        item->kind = GX_STEP;
        item->format = GX_BINARY;
        return gx_write_step(&item->number, &item->vector, out, GX_ENCODED_MAX);
    }
    if (!host) {
        item->kind = GX_MOVE;
        return gx_write_move(item->format, &item->number, &item->vector, out, GX_ENCODED_MAX);
    }
    if (any(2)) {
        item->kind = GX_POSITION;
        memset(&item->number, 0, sizeof item->number);
        return gx_write_position(item->format, &item->vector, out, GX_ENCODED_MAX);
    }
    memset(&item->vector, 0, sizeof item->vector);
    if (item->number.format != 0 && any(2)) {
        item->kind = GX_COMPLETED;
        item->format = item->number.format;
        return gx_write_completed(&item->number, out, GX_ENCODED_MAX);
    }
    if (any(3) == 0) {
        item->kind = GX_CONFIRMED;
        item->number = number(any(128), item->format);
        item->code = (unsigned char)any(127);
        return gx_write_confirmed(&item->number, item->code, out, GX_ENCODED_MAX);
    }
    if (any(3) == 0) {
        item->kind = GX_STATUS;
        memset(&item->number, 0, sizeof item->number);
        item->period = (uint16_t)any(256);
        item->code = (unsigned char)any(2);
        return gx_write_status(item->format, item->period, item->code, out, GX_ENCODED_MAX);
    }
    item->kind = GX_REFUSED;
    item->code = (unsigned char)any(128);
    return gx_write_refused(item->format, &item->number, item->code, out, GX_ENCODED_MAX);
}

enum { STREAM_ITEMS = 60, STREAM_MAX = STREAM_ITEMS * GX_ENCODED_MAX };

/* What is written is read, in pieces of any length, each of them memory of its own. */
static void what_is_written_is_read(int host)
{
    static struct gx_item sent[STREAM_ITEMS];
    static char stream[STREAM_MAX];
    struct receiver receiver;
    struct gx_item item;
    int size = 0, at = 0, heard = 0, i;

    for (i = 0; i < STREAM_ITEMS; ++i) {
        int length = any_item(host, stream + size, &sent[i]);
        CHECK(length > 0 && length <= GX_ENCODED_MAX);
        size += length;
    }
    start(&receiver, host);
    while (at < size) {
        int piece = 1 + any(any(2) ? 8 : 80), from = 0;
        char *exact;
        if (piece > size - at)
            piece = size - at;
        exact = malloc((size_t)piece);
        memcpy(exact, stream + at, (size_t)piece);
        while (from < piece) {
            from += receive(&receiver, exact + from, piece - from, &item);
            if (item.kind != GX_NONE && CHECK(heard < STREAM_ITEMS))
                CHECK(same_item(&item, &sent[heard++]));
        }
        free(exact);
        at += piece;
    }
    if (host) {
        idle(&receiver, &item);
        if (item.kind != GX_NONE && CHECK(heard < STREAM_ITEMS))
            CHECK(same_item(&item, &sent[heard++]));
    }
    CHECK_INT(heard, STREAM_ITEMS);
}

/* Damaged streams, and noise of the bytes that mean something: as the reference reads them. */
static void damage_is_read_as_by_the_reference(int host)
{
    static const char telling[] = "!*#~%&=?R\n\r\x1B xyzabcV0123456789-+\x81\x83\xC1\xFF\x80";
    static unsigned char stream[STREAM_MAX];
    struct receiver receiver;
    struct reference reader;
    struct gx_item expected[3], item;
    int size = 0, at, from = 0, i, count;

    if (any(2)) {
        while (size < 300)
            size += any_item(host, (char *)stream + size, &item);
        for (i = 1 + any(8); i > 0; --i) {
            at = any(size);
            if (any(3)) {
                stream[at] = any(2) ? (unsigned char)(stream[at] ^ 1 << any(8)) : (unsigned char)wire_random(&seed);
            } else {
                memmove(stream + at, stream + at + 1, (size_t)(size - at - 1));
                --size;
            }
        }
    } else {
        /* Short of what the reference can keep, were it all one command. */
        size = 120;
        for (i = 0; i < size; ++i)
            stream[i] = (unsigned char)(any(8) ? telling[any((int)sizeof telling - 1)] : any(256));
    }
    memset(&reader, 0, sizeof reader);
    reader.host = host;
    start(&receiver, host);
    item.kind = GX_NONE;
    for (at = 0; at < size; ++at) {
        if (reader.count == (int)sizeof reader.kept - 1)
            return; /* a number of a hundred digits came about: more than the reference is made for */
        count = reference_byte(&reader, stream[at], expected);
        for (i = 0; i < count; ++i) {
            int end = from;
            do {
                end = from;
                from += receive(&receiver, stream + from, size - from, &item);
            } while (item.kind == GX_NONE && from < size && from > end);
            if (!CHECK(same_item(&item, &expected[i])))
                return;
            CHECK(from == at || from == at + 1);
        }
    }
    if (from < size) {
        receive(&receiver, stream + from, size - from, &item);
        CHECK_INT(item.kind, GX_NONE);
    }
    reference_idle(&reader, &expected[0]);
    idle(&receiver, &item);
    CHECK(same_item(&item, &expected[0]));
}

/* A receiver in memory that holds anything: no value out of its range, and never more items than bytes and one. */
static void any_memory(int host)
{
    unsigned char stream[64];
    struct receiver receiver;
    struct gx_item item;
    int at = 0, calls = 0;
    size_t i;
    for (i = 0; i < sizeof receiver.of; ++i)
        ((unsigned char *)&receiver.of)[i] = (unsigned char)(any(2) ? any(16) : any(256));
    receiver.host = host;
    wire_random_bytes(&seed, stream, sizeof stream);
    for (i = 0; i < sizeof stream; ++i)
        stream[i] |= any(3) ? 0x80 : 0;
    while (at < (int)sizeof stream && calls <= 2 * (int)sizeof stream + 2) {
        at += receive(&receiver, stream + at, (int)sizeof stream - at, &item);
        ++calls;
        if (item.kind == GX_NONE)
            continue;
        CHECK(item.kind > 0 && item.kind <= GX_STATUS && (item.format == GX_BINARY || item.format == GX_ASCII));
        CHECK(item.number.value <= GX_NUMBER_MAX && item.number.format <= GX_ASCII && item.code < 128);
        CHECK(item.period <= GX_PERIOD_MAX && item.vector.velocity <= GX_VELOCITY_MAX && item.vector.mask < 128);
        for (i = 0; i < 6; ++i)
            CHECK(item.vector.axes[i] >= GX_POSITION_MIN && item.vector.axes[i] <= GX_POSITION_MAX);
    }
    CHECK_INT(at, sizeof stream);
}

int main(void)
{
    int i;
    for (i = 0; i < 2000; ++i) {
        what_is_written_is_read(i & 1);
        damage_is_read_as_by_the_reference(i & 1);
        damage_is_read_as_by_the_reference(i & 1);
        any_memory(i & 1);
    }
    return check_summary("gx_streams");
}
