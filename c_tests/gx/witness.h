/* Reads what both ends of the GX protocol's link read, beside them, and compares it with what was sent. */
#ifndef GX_WITNESS_H
#define GX_WITNESS_H

#include "libdeltarobot/gx.h"

#include "channel.h"

enum { SENT = 512, MOTION_GAP_MS = 300, HOST_GAP_MS = 20 };

/* A direction: the last things sent, how far they were read, and the reader. */
typedef struct {
    const Line *line;
    struct gx_item sent[SENT];
    unsigned next_sent, next_read;
    struct gx_commands commands;
    struct gx_notices notices;
    unsigned long read_at;
} Witness;

static Witness to_motion = {.line = &down}, to_host = {.line = &up};

/* Whether the motion side takes moves in order only: then no move without a number counts, whatever it says. */
static int numbers_count;

static void start_witness(Witness *witness)
{
    const Line *line = witness->line;
    memset(witness, 0, sizeof *witness);
    witness->line = line;
}

static void remember(Witness *witness, const struct gx_item *item)
{
    witness->sent[witness->next_sent++ % SENT] = *item;
}

static int is_same(const struct gx_item *a, const struct gx_item *b)
{
    int i;
    if (a->kind != b->kind || a->format != b->format || a->code != b->code || a->number.format != b->number.format ||
        a->period != b->period || (a->number.format && a->number.value != b->number.value) ||
        a->vector.mask != b->vector.mask)
        return 0;
    if (a->vector.mask & GX_MASK_VELOCITY && a->vector.velocity != b->vector.velocity)
        return 0;
    for (i = 0; i < GX_AXES; ++i)
        if (a->vector.mask >> i & 1 && a->vector.axes[i] != b->vector.axes[i])
            return 0;
    return 1;
}

/* What an end has read: forged, unless the other has sent it, behind what was read before. */
static void compare(Witness *witness, const struct gx_item *item)
{
    unsigned i = witness->next_sent - witness->next_read > SENT ? witness->next_sent - SENT : witness->next_read;
    if (item->kind == GX_NONE || item->kind == GX_MALFORMED)
        return;
    if (witness == &to_motion && numbers_count && !item->number.format)
        return;
    for (; i != witness->next_sent; ++i)
        if (is_same(&witness->sent[i % SENT], item)) {
            witness->next_read = i + 1;
            return;
        }
    forged = 1;
}

/* The bytes that an end has taken. */
static void read_beside(Witness *witness, const unsigned char *bytes, int length)
{
    struct gx_item item;
    int i, taken;
    for (i = 0; i < length; i += taken) {
        if (witness == &to_motion)
            taken = gx_commands_receive(&witness->commands, bytes + i, length - i, &item);
        else
            taken = gx_notices_receive(&witness->notices, bytes + i, length - i, &item);
        compare(witness, &item);
    }
    if (length > 0)
        witness->read_at = now;
}

static void idle_beside(void)
{
    struct gx_item item;
    if (now - to_motion.read_at >= MOTION_GAP_MS) {
        gx_commands_idle(&to_motion.commands, &item);
        compare(&to_motion, &item);
    }
    if (now - to_host.read_at >= HOST_GAP_MS) {
        gx_notices_idle(&to_host.notices, &item);
        compare(&to_host, &item);
    }
}

#endif
