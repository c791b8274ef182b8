/*
 * What GX costs, beside plain C on the posted code's pattern: a whole command in a buffer, no checks. Used as
 * deltarobot.c.
 */
#define _POSIX_C_SOURCE 199309L
#include "libdeltarobot/gx.h"

#include "measure.h"

#include <stdlib.h>
#include <string.h>

#define CHUNK 64
#define MOVES 200

struct stream {
    unsigned char bytes[MOVES * GX_ENCODED_MAX];
    int size, axes;
};

static unsigned long seed = 1;

static long random_value(long least, long most)
{
    seed = (seed * 1103515245UL + 12345UL) & 0x7fffffffUL;
    return least + (long)(seed >> 8) % (most - least + 1);
}

/* Moves of so many axes, in the format asked for; number NULL: none of them has one. */
static void fill(struct stream *stream, int axes, int is_short, int format, struct gx_number *number)
{
    struct gx_vector vector;
    int i, axis, size;

    stream->size = 0;
    stream->axes = axes;
    for (i = 0; i < MOVES; ++i) {
        memset(&vector, 0, sizeof vector);
        vector.mask = (unsigned char)((1 << axes) - 1);
        for (axis = 0; axis < axes; ++axis)
            vector.axes[axis] = (int32_t)(is_short ? random_value(-63, 63) : random_value(-10000000, 10000000));
        if (number != NULL)
            number->value = (uint16_t)i;
        size = is_short ? gx_write_step(number, &vector, stream->bytes + stream->size, GX_ENCODED_MAX)
                        : gx_write_move(format, number, &vector, stream->bytes + stream->size, GX_ENCODED_MAX);
        if (size <= 0)
            abort();
        stream->size += size;
    }
}

static void decode(struct gx_commands *commands, const struct stream *stream, int chunk)
{
    struct gx_item item;
    int at, end;
    for (at = 0; at < stream->size;) {
        end = stream->size - at < chunk ? stream->size : at + chunk;
        while (at < end) {
            at += gx_commands_receive(commands, stream->bytes + at, end - at, &item);
            taken += (unsigned)item.kind;
        }
    }
}

/* Knows where each command ends, so it need not look for it. */
__attribute__((noinline)) static int plain_unpack(const unsigned char *at, struct gx_vector *vector)
{
    const unsigned char *begin = at;
    int is_short = *at++ == '*', axis;

    vector->mask = *at++;
    if (vector->mask & 0x40) {
        vector->velocity = (uint16_t)((at[0] & 0x7f) | (at[1] & 0x7f) << 7);
        at += 2;
    }
    for (axis = 0; axis < 6; ++axis) {
        if (!(vector->mask & 1 << axis))
            continue;
        if (is_short) {
            vector->axes[axis] += (signed char)(*at << 1) / 2;
            at++;
        } else {
            vector->axes[axis] = (int32_t)((at[0] & 0x7fu) | (at[1] & 0x7fu) << 7 | (at[2] & 0x7fu) << 14 |
                                           (at[3] & 0x7fu) << 21);
            at += 4;
        }
    }
    return (int)(at - begin);
}

static void plain(const struct stream *stream)
{
    static struct gx_vector vector;
    int at = 0;
    while (at < stream->size) {
        at += plain_unpack(stream->bytes + at, &vector);
        taken += vector.mask;
    }
}

static void decode_case(const char *name, int goal, const struct stream *stream, int chunk, int has_plain)
{
    static struct gx_commands commands;
    gx_commands_init(&commands);
    MEASURE(name, goal, "library", stream->size, decode(&commands, stream, chunk));
    if (has_plain)
        MEASURE(name, goal, "model", stream->size, plain(stream));
}

/* A path of short segments. */
static int contour(void)
{
    struct gx_contour contour;
    unsigned char out[GX_ENCODED_MAX];
    int32_t position[GX_AXES] = {0};
    struct gx_vector start;
    int i, size = 0;

    memset(&start, 0, sizeof start);
    start.mask = 3;
    gx_contour_init(&contour, 3);
    gx_contour_start(&contour, &start);
    for (i = 0; i < MOVES; ++i) {
        position[0] += i % 50;
        position[1] -= i % 40;
        size += gx_contour_segment(&contour, NULL, position, i == 0 ? 1000 : -1, out, sizeof out);
    }
    taken += (unsigned)size;
    return size;
}

int main(int argc, char **argv)
{
    static struct stream stream;
    struct gx_number number;

    use_callgrind = argc > 1 && strcmp(argv[1], "callgrind") == 0;
    memset(&number, 0, sizeof number);
    number.format = GX_BINARY;
    fill(&stream, 2, 0, GX_BINARY, NULL);
    decode_case("gx-long:2-axes", 34, &stream, CHUNK, 1);
    fill(&stream, 6, 0, GX_BINARY, NULL);
    decode_case("gx-long:6-axes", 21, &stream, CHUNK, 1);
    fill(&stream, 2, 1, GX_BINARY, NULL);
    decode_case("gx-short:2-axes", 72, &stream, CHUNK, 1);
    fill(&stream, 6, 1, GX_BINARY, NULL);
    decode_case("gx-short:6-axes", 46, &stream, CHUNK, 1);
    fill(&stream, 2, 0, GX_BINARY, &number);
    decode_case("gx-long:numbered", 40, &stream, CHUNK, 0);
    fill(&stream, 2, 0, GX_ASCII, NULL);
    decode_case("gx-ascii:2-axes", 70, &stream, CHUNK, 0);
    MEASURE("gx-contour:2-axes", 0, "library", contour(), contour());
    return 0;
}
