/*
 * A second decoder of the GX protocol, as plain as can be: it keeps the bytes of what is not complete yet, and with
 * each further byte reads all of them again from the first, by the grammar. Nothing of it is taken from the library, so
 * that where the two agree, the grammar was followed.
 */
#ifndef GX_REFERENCE_H
#define GX_REFERENCE_H

#include "libdeltarobot/gx.h"

#include <string.h>

struct reference {
    int host;     /* reads notices, not commands */
    int skipping; /* what is behind something malformed */
    int count;
    unsigned char kept[128];
};

enum { SKIPS_NOTHING, SKIPS_LINE, SKIPS_PACKED };

/* What the bytes that are kept are. */
enum verdict { INCOMPLETE, COMPLETE, COMPLETE_BEFORE, BAD };

static int is_packed(unsigned char byte)
{
    return byte >= 0x80;
}

static int is_digit(unsigned char byte)
{
    return byte >= '0' && byte <= '9';
}

static int is_line_end(unsigned char byte)
{
    return byte == '\r' || byte == '\n';
}

static int is_one_of(const char *these, unsigned char byte)
{
    return byte != 0 && strchr(these, byte) != NULL;
}

static const char *starts_of(const struct reference *reader)
{
    return reader->host ? "#=?&%" : "!*#~%";
}

static const char *letters_of(const struct reference *reader)
{
    return reader->host ? "" : "xyzabcVR";
}

static long packed_value(const unsigned char *bytes, int count, int is_signed)
{
    long value = 0;
    int i;
    for (i = count - 1; i >= 0; --i)
        value = value * 128 + (bytes[i] - 128);
    if (is_signed && bytes[count - 1] >= 0xC0)
        value -= 1L << 7 * count;
    return value;
}

/* Digits from there on; more than a billion is all the same. */
static double decimal_value(const unsigned char *bytes, int count)
{
    double value = 0;
    while (count-- > 0)
        value = value * 10 + (*bytes++ - '0');
    return value;
}

static enum verdict bad(struct gx_item *item, int fault, int format)
{
    item->kind = GX_MALFORMED;
    item->period = 0;
    memset(&item->vector, 0, sizeof item->vector);
    item->code = (unsigned char)fault;
    item->format = (unsigned char)format;
    return BAD;
}

static enum verdict complete(struct gx_item *item, int kind, int format)
{
    item->kind = kind;
    item->format = (unsigned char)format;
    return COMPLETE;
}

/* Mask and values; kind tells which. */
static enum verdict read_packed(const unsigned char *bytes, int count, struct gx_item *item, int kind)
{
    int size = kind == GX_STEP ? 1 : 4, axis, at = 1;
    if (count == 0)
        return INCOMPLETE;
    if (!is_packed(bytes[0]))
        return bad(item, GX_FAULT_SYNTAX, GX_BINARY);
    if (bytes[0] == 0x80)
        return bad(item, GX_FAULT_EMPTY, GX_BINARY);
    for (; at < count; ++at)
        if (!is_packed(bytes[at]))
            return bad(item, GX_FAULT_SYNTAX, GX_BINARY);
    at = 1;
    if (bytes[0] & 0x40) {
        if (at + 2 > count)
            return INCOMPLETE;
        item->vector.velocity = (uint16_t)packed_value(bytes + at, 2, 0);
        at += 2;
    }
    for (axis = 0; axis < 6; ++axis) {
        if (!(bytes[0] >> axis & 1))
            continue;
        if (at + size > count)
            return INCOMPLETE;
        item->vector.axes[axis] = (int32_t)packed_value(bytes + at, size, 1);
        at += size;
    }
    item->vector.mask = bytes[0] & 0x7F;
    return complete(item, kind, GX_BINARY);
}

/* Words up to the end of the line. */
static enum verdict read_words(const struct reference *reader, const unsigned char *bytes, int count,
                               struct gx_item *item)
{
    static const char order[] = "xyzabcVR";
    int at = 0, seen = 0, reporting = 0;
    for (;;) {
        int word, sign = 1, digits;
        double value;
        while (at > 0 && at < count && bytes[at] == ' ')
            ++at;
        if (at == count)
            return INCOMPLETE;
        if (is_line_end(bytes[at]))
            break;
        if (!is_one_of(reader->host ? "xyzabcV" : order, bytes[at]))
            return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
        word = (int)(strchr(order, bytes[at]) - order);
        if (seen >> word & 1)
            return bad(item, GX_FAULT_REPEATED, GX_ASCII);
        if (seen != 0 && (word == 7 || reporting))
            return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
        seen |= 1 << word;
        reporting = word == 7;
        ++at;
        if (word < 6 && at < count && (bytes[at] == '-' || bytes[at] == '+'))
            sign = bytes[at++] == '-' ? -1 : 1;
        for (digits = at; at < count && is_digit(bytes[at]); ++at)
            ;
        if (at == count)
            return INCOMPLETE;
        if (at == digits)
            return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
        value = sign * decimal_value(bytes + digits, at - digits);
        if (word < 6 ? value < -134217728.0 || value > 134217727.0 : value > 16383)
            return bad(item, GX_FAULT_RANGE, GX_ASCII);
        if (word < 6)
            item->vector.axes[word] = (int32_t)value;
        else if (word == 6)
            item->vector.velocity = (uint16_t)value;
        else
            item->period = (uint16_t)value;
    }
    item->vector.mask = (unsigned char)(seen & 0x7F);
    return complete(item, reporting ? GX_REPORTING : reader->host ? GX_POSITION : GX_MOVE, GX_ASCII);
}

/* 14 bits, packed or in digits: kind says what they are. */
static enum verdict read_14_bits(const unsigned char *bytes, int count, struct gx_item *item, int kind)
{
    int digits = 0, value;
    if (count == 0 || (count == 1 && is_packed(bytes[0])))
        return INCOMPLETE;
    if (is_packed(bytes[0])) {
        if (!is_packed(bytes[1]))
            return bad(item, GX_FAULT_SYNTAX, GX_BINARY);
        value = (int)packed_value(bytes, 2, 0);
        complete(item, kind, GX_BINARY);
    } else {
        while (digits < count && is_digit(bytes[digits]))
            ++digits;
        if (digits == count)
            return INCOMPLETE;
        if (digits == 0 || !is_line_end(bytes[digits]))
            return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
        if (decimal_value(bytes, digits) > 16383)
            return bad(item, GX_FAULT_RANGE, GX_ASCII);
        value = (int)decimal_value(bytes, digits);
        complete(item, kind, GX_ASCII);
    }
    if (kind == GX_CONFIRMED) {
        item->number.value = (uint16_t)(value & 127);
        item->number.format = item->format;
        item->code = (unsigned char)(value >> 7);
    } else if (kind == GX_STATUS) {
        item->period = (uint16_t)(value & 255);
        item->code = value >> 8 & 1;
    } else {
        /* A code and its complement. */
        int code = value >> 7;
        item->code = (unsigned char)(code <= GX_CONTROL_STOP && (value & 127) == 127 - code ? code : GX_CONTROL_UNKNOWN);
    }
    return COMPLETE;
}

static enum verdict read_command(const struct reference *reader, const unsigned char *bytes, int count,
                                 struct gx_item *item)
{
    if (count == 0)
        return INCOMPLETE;
    if (bytes[0] == '#') /* the second one */
        return bad(item, GX_FAULT_INTERRUPTED, item->number.format == GX_BINARY ? GX_BINARY : GX_ASCII);
    if (is_line_end(bytes[0]))
        return bad(item, GX_FAULT_EMPTY, GX_ASCII);
    if (bytes[0] == '!')
        return read_packed(bytes + 1, count - 1, item, GX_MOVE);
    if (bytes[0] == '*')
        return read_packed(bytes + 1, count - 1, item, GX_STEP);
    if (bytes[0] == '~') {
        int i;
        for (i = 1; i < count; ++i)
            if (!is_packed(bytes[i]))
                return bad(item, GX_FAULT_SYNTAX, GX_BINARY);
        if (count < 3)
            return INCOMPLETE;
        item->period = (uint16_t)packed_value(bytes + 1, 2, 0);
        return complete(item, GX_REPORTING, GX_BINARY);
    }
    if (bytes[0] == '%')
        return read_14_bits(bytes + 1, count - 1, item, GX_CONTROL);
    if (is_one_of("xyzabcVR", bytes[0]))
        return read_words(reader, bytes, count, item);
    return bad(item, GX_FAULT_UNKNOWN, is_packed(bytes[0]) ? GX_BINARY : GX_ASCII);
}

static enum verdict read_refusal(const unsigned char *bytes, int count, struct gx_item *item)
{
    int digits = 0;
    if (count == 0)
        return INCOMPLETE;
    if (is_packed(bytes[0])) {
        item->code = bytes[0] & 0x7F;
        return complete(item, GX_REFUSED, GX_BINARY);
    }
    while (digits < count && is_digit(bytes[digits]))
        ++digits;
    if (digits == count)
        return INCOMPLETE;
    if (digits == 0 || !is_line_end(bytes[digits]))
        return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
    if (decimal_value(bytes, digits) > 127)
        return bad(item, GX_FAULT_RANGE, GX_ASCII);
    item->code = (unsigned char)decimal_value(bytes, digits);
    return complete(item, GX_REFUSED, GX_ASCII);
}

/* numbered: a number came before. */
static enum verdict read_notice(const struct reference *reader, const unsigned char *bytes, int count,
                                struct gx_item *item, int numbered)
{
    if (count == 0)
        return INCOMPLETE;
    if (bytes[0] == '?')
        return read_refusal(bytes + 1, count - 1, item);
    if (numbered) {
        if (is_line_end(bytes[0]))
            return complete(item, GX_COMPLETED, item->number.format);
        if (item->number.format == GX_ASCII)
            return bad(item, GX_FAULT_SYNTAX, GX_ASCII);
        complete(item, GX_COMPLETED, GX_BINARY);
        return COMPLETE_BEFORE;
    }
    if (bytes[0] == '&' || bytes[0] == '%')
        return read_14_bits(bytes + 1, count - 1, item, bytes[0] == '&' ? GX_CONFIRMED : GX_STATUS);
    if (bytes[0] != '=')
        return bad(item, GX_FAULT_UNKNOWN, is_packed(bytes[0]) ? GX_BINARY : GX_ASCII);
    if (count == 1)
        return INCOMPLETE;
    if (bytes[1] == '!')
        return read_packed(bytes + 2, count - 2, item, GX_POSITION);
    if (is_line_end(bytes[1]))
        return bad(item, GX_FAULT_EMPTY, GX_ASCII);
    if (is_packed(bytes[1]))
        return bad(item, GX_FAULT_SYNTAX, GX_BINARY);
    return read_words(reader, bytes + 1, count - 1, item);
}

/* The number that the bytes begin with, if any: where it ends, or -1 when that is not clear yet. */
static int read_number(const unsigned char *bytes, int count, struct gx_number *number, int *broken)
{
    int at;
    memset(number, 0, sizeof *number);
    *broken = 0;
    if (bytes[0] != '#')
        return 0;
    if (count == 1 || (is_packed(bytes[1]) && count == 2))
        return -1;
    if (is_packed(bytes[1])) {
        *broken = !is_packed(bytes[2]);
        if (*broken)
            return 2;
        number->value = (uint16_t)packed_value(bytes + 1, 2, 0);
        number->format = GX_BINARY;
        return 3;
    }
    for (at = 1; at < count && is_digit(bytes[at]); ++at)
        ;
    if (at == count)
        return -1;
    *broken = at == 1 || decimal_value(bytes + 1, at - 1) > 16383;
    if (!*broken) {
        number->value = (uint16_t)decimal_value(bytes + 1, at - 1);
        number->format = GX_ASCII;
    }
    return at;
}

/* All that is kept. */
static enum verdict read_kept(const struct reference *reader, struct gx_item *item)
{
    const unsigned char *bytes = reader->kept;
    int count = reader->count, broken, at;

    memset(item, 0, sizeof *item);
    at = read_number(bytes, count, &item->number, &broken);
    if (at < 0)
        return INCOMPLETE;
    if (broken)
        return bad(item, GX_FAULT_NUMBER, at == 2 && is_packed(bytes[1]) ? GX_BINARY : GX_ASCII);
    if (reader->host)
        return read_notice(reader, bytes + at, count - at, item, at > 0);
    while (at > 0 && at < count && bytes[at] == ' ')
        ++at;
    return read_command(reader, bytes + at, count - at, item);
}

/* A byte that is no part of something malformed. Returns whether it is to be read as the first of what comes next. */
static int resume(struct reference *reader, unsigned char byte, int packed)
{
    reader->count = 0;
    reader->skipping = SKIPS_NOTHING;
    if (is_one_of(starts_of(reader), byte))
        return 1;
    if (is_line_end(byte))
        return 0;
    if (packed && is_one_of(letters_of(reader), byte))
        return 1;
    reader->skipping = packed && (is_packed(byte) || byte == ' ') ? SKIPS_PACKED : SKIPS_LINE;
    return 0;
}

/* Takes a byte: fills in up to two items, and returns how many. */
static int reference_byte(struct reference *reader, unsigned char byte, struct gx_item *items)
{
    int count = 0;
    if (byte == 0x1B) {
        reader->count = 0;
        reader->skipping = SKIPS_NOTHING;
        return 0;
    }
    for (;;) {
        struct gx_item *item = &items[count];
        enum verdict verdict;
        if (reader->skipping != SKIPS_NOTHING) {
            if (!resume(reader, byte, reader->skipping == SKIPS_PACKED))
                return count;
        }
        if (reader->count == 0 && (byte == ' ' || is_line_end(byte)))
            return count;
        reader->kept[reader->count++] = byte;
        verdict = read_kept(reader, item);
        if (verdict == INCOMPLETE) {
            memset(item, 0, sizeof *item);
            return count;
        }
        ++count;
        if (verdict != BAD)
            reader->count = 0;
        if (verdict == COMPLETE)
            return count;
        if (verdict == COMPLETE_BEFORE)
            continue;
        if (item->code == GX_FAULT_SYNTAX && is_one_of(starts_of(reader), byte))
            item->code = GX_FAULT_INTERRUPTED;
        if (!resume(reader, byte, item->format == GX_BINARY && item->code != GX_FAULT_NUMBER))
            return count;
    }
}

/* The line is quiet: fills in an item, of kind GX_NONE when nothing was waited for. */
static void reference_idle(struct reference *reader, struct gx_item *item)
{
    memset(item, 0, sizeof *item);
    if (reader->count > 0 && reader->skipping == SKIPS_NOTHING) {
        const unsigned char *bytes = reader->kept;
        int count = reader->count, broken, at = read_number(bytes, count, &item->number, &broken);
        while (at > 0 && at < count && bytes[at] == ' ')
            ++at;
        if (at < 0)
            bad(item, GX_FAULT_INTERRUPTED, count == 2 && is_packed(bytes[1]) ? GX_BINARY : GX_ASCII);
        else if (at == count && reader->host)
            complete(item, GX_COMPLETED, GX_BINARY);
        else if (at == count)
            bad(item, GX_FAULT_INTERRUPTED, item->number.format == GX_BINARY ? GX_BINARY : GX_ASCII);
        else
            bad(item, GX_FAULT_INTERRUPTED,
                is_one_of("!*~", bytes[at]) || (bytes[at] == '=' && at + 1 < count && bytes[at + 1] == '!') ||
                        (is_one_of("&%", bytes[at]) && at + 1 < count && is_packed(bytes[at + 1]))
                    ? GX_BINARY
                    : GX_ASCII);
    }
    reader->count = 0;
    reader->skipping = SKIPS_NOTHING;
}

static int same_item(const struct gx_item *a, const struct gx_item *b)
{
    int i;
    if (a->kind != b->kind || a->kind == GX_NONE)
        return a->kind == b->kind;
    for (i = 0; i < 6; ++i)
        if (a->vector.axes[i] != b->vector.axes[i])
            return 0;
    return a->number.value == b->number.value && a->number.format == b->number.format && a->format == b->format &&
           a->code == b->code && a->period == b->period && a->vector.mask == b->vector.mask &&
           a->vector.velocity == b->vector.velocity;
}

#endif
