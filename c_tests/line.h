/* A line that loses, flips, delays, doubles and splits bytes, in simulated time. */
#ifndef LINE_H
#define LINE_H

#include "wire.h"

#include <stdlib.h>

enum {
    ONE_WAY_MS = 150, /* the longest delay of the line; twice that is below the session's guard time of 500 */
    QUEUE = 8192,
    SENT = 64
};

typedef struct {
    unsigned long from, until; /* when the line is cut, in simulated time */
    unsigned lose_byte, flip_bit, repeat_byte, lose_frame, repeat_frame, delay; /* per 10000; delay in ms */
} Quality;

typedef struct {
    unsigned char bytes[QUEUE];
    unsigned long due[QUEUE];
    unsigned head, count;
    unsigned long last_due;
    struct {
        unsigned char bytes[40];
        int length;
        unsigned long at;
    } sent[SENT]; /* the last frames */
    unsigned next_sent;
} Line;

static unsigned long seed, now;
static Quality quality;

static unsigned below(unsigned limit)
{
    return wire_random(&seed) % limit;
}

static int chance(unsigned per_10000)
{
    return per_10000 != 0 && below(10000) < per_10000;
}

static void put_byte(Line *line, unsigned char byte, unsigned long due)
{
    if (line->count == QUEUE)
        abort();
    line->bytes[(line->head + line->count) % QUEUE] = byte;
    line->due[(line->head + line->count) % QUEUE] = due;
    ++line->count;
    line->last_due = due;
}

static void transmit(Line *line, const unsigned char *bytes, int length)
{
    unsigned long latest = now + ONE_WAY_MS;
    unsigned long due = now + (quality.delay ? below(quality.delay) : 0);
    int i, times;

    memcpy(line->sent[line->next_sent % SENT].bytes, bytes, (size_t)length);
    line->sent[line->next_sent % SENT].length = length;
    line->sent[line->next_sent++ % SENT].at = now;
    if (now >= quality.from && now < quality.until)
        return;
    if (chance(quality.lose_frame))
        return;
    if (due < line->last_due)
        due = line->last_due;
    for (times = chance(quality.repeat_frame) ? 2 : 1; times > 0; --times) {
        for (i = 0; i < length; ++i) {
            unsigned char byte = bytes[i];
            if (quality.delay && below(8) == 0 && due < latest)
                due += below(3);
            if (chance(quality.lose_byte))
                continue;
            if (chance(quality.flip_bit))
                byte = (unsigned char)(byte ^ 1u << below(8));
            put_byte(line, byte, due);
            if (chance(quality.repeat_byte))
                put_byte(line, byte, due);
        }
    }
}

static int arrived(Line *line, unsigned char *out, int cap)
{
    int length = 0;
    while (length < cap && line->count > 0 && line->due[line->head] <= now) {
        out[length++] = line->bytes[line->head];
        line->head = (line->head + 1) % QUEUE;
        --line->count;
    }
    return length;
}

/*
 * Whether the frame of that was sent, and lately enough to be understood only now: behind the beginning of a false
 * frame, it is found when the line was quiet for a while.
 */
static int was_sent(const Line *line, int opcode, const void *payload, int size)
{
    unsigned char frame[WIRE_FRAME_MAX];
    int length = wire_frame(frame, opcode, payload, size), i;

    for (i = 0; i < SENT; ++i)
        if (line->sent[i].length == length && now <= line->sent[i].at + ONE_WAY_MS + 100 &&
            memcmp(line->sent[i].bytes, frame, (size_t)length) == 0)
            return 1;
    return 0;
}

#endif
