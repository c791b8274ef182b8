/*
 * Every input of one to four bytes, to both receivers, against the reference: the same items, byte by byte, and the
 * same when the line falls silent behind them.
 *
 * Four bytes are 2^32 inputs. Both decoders are functions of what they keep and the next byte, so two inputs that leave
 * the pair of them with the same contents can't differ in what follows: each such state is gone on from once, by all
 * 256 bytes.
 *
 * Usage: gx_exhaustive [DEPTH]
 */
#include "reference.h"

#include "check.h"
#include "receiver.h"

#include <stdlib.h>

/* Both decoders behind the same bytes, and these, for messages. */
struct pair {
    struct receiver ours;
    struct reference theirs;
    unsigned char input[4];
};

struct set {
    struct pair *pairs;
    long count, room;
    long *slots; /* index + 1 of a pair; 0: free */
    long slot_count;
};

static unsigned long hash(const struct pair *pair)
{
    const unsigned char *bytes = (const unsigned char *)&pair->ours;
    unsigned long sum = 14695981039346656037u;
    size_t i;
    for (i = 0; i < sizeof pair->ours; ++i)
        sum = (sum ^ bytes[i]) * 1099511628211u;
    for (i = 0; i < (size_t)pair->theirs.count; ++i)
        sum = (sum ^ pair->theirs.kept[i]) * 1099511628211u;
    return (sum ^ (unsigned long)pair->theirs.skipping) * 1099511628211u;
}

static int same(const struct pair *a, const struct pair *b)
{
    return memcmp(&a->ours, &b->ours, sizeof a->ours) == 0 && a->theirs.count == b->theirs.count &&
           a->theirs.skipping == b->theirs.skipping &&
           memcmp(a->theirs.kept, b->theirs.kept, (size_t)a->theirs.count) == 0;
}

static void *room_for(void *memory, size_t size)
{
    memory = realloc(memory, size);
    if (memory == NULL) {
        fprintf(stderr, "no memory\n");
        exit(2);
    }
    return memory;
}

static void add(struct set *set, const struct pair *pair)
{
    long slot;
    if (set->count * 2 >= set->slot_count) {
        long i;
        set->slot_count = set->slot_count ? set->slot_count * 4 : 4096;
        set->slots = room_for(set->slots, (size_t)set->slot_count * sizeof *set->slots);
        memset(set->slots, 0, (size_t)set->slot_count * sizeof *set->slots);
        for (i = 0; i < set->count; ++i) {
            slot = (long)(hash(&set->pairs[i]) % (unsigned long)set->slot_count);
            while (set->slots[slot] != 0)
                slot = (slot + 1) % set->slot_count;
            set->slots[slot] = i + 1;
        }
    }
    slot = (long)(hash(pair) % (unsigned long)set->slot_count);
    while (set->slots[slot] != 0) {
        if (same(&set->pairs[set->slots[slot] - 1], pair))
            return;
        slot = (slot + 1) % set->slot_count;
    }
    if (set->count == set->room) {
        set->room = set->room ? set->room * 2 : 1024;
        set->pairs = room_for(set->pairs, (size_t)set->room * sizeof *set->pairs);
    }
    set->pairs[set->count++] = *pair;
    set->slots[slot] = set->count;
}

static void show(const char *who, const struct gx_item *item)
{
    fprintf(stderr, "    %s: kind %d, number %u/%u, format %u, code %u, period %u, mask %02x, velocity %u, x %ld\n",
            who, item->kind, item->number.value, item->number.format, item->format, item->code, item->period,
            item->vector.mask, item->vector.velocity, (long)item->vector.axes[0]);
}

static void compare(const struct pair *pair, int length, const struct gx_item *ours, const struct gx_item *theirs,
                    int count)
{
    int i;
    for (i = 0; i < count; ++i) {
        ++check_count;
        if (!same_item(&ours[i], &theirs[i]) && check_fails()) {
            fprintf(stderr, "%s: item %d of the last byte differs\n", pair->ours.host ? "notices" : "commands", i);
            check_dump("input", pair->input, (size_t)length);
            show("ours", &ours[i]);
            show("reference", &theirs[i]);
        }
        /* Nothing is told that could not be meant. */
        if (ours[i].kind != GX_NONE &&
            (ours[i].number.value > GX_NUMBER_MAX || ours[i].vector.velocity > GX_VELOCITY_MAX || ours[i].code > 127 ||
             ours[i].vector.mask > 127 || ours[i].period > GX_PERIOD_MAX))
            CHECK(!"in range");
    }
}

/* Feeds a byte to both, and compares. */
static void feed(struct pair *pair, unsigned char byte, int length)
{
    struct gx_item ours[3], theirs[3];
    int taken = 0, count = 0, calls;

    memset(ours, 0, sizeof ours);
    memset(theirs, 0, sizeof theirs);
    for (calls = 0; taken == 0 && calls < 3; ++calls) {
        taken = receive(&pair->ours, &byte, 1, &ours[count]);
        count += ours[count].kind != GX_NONE;
        if (count == 3)
            break;
    }
    CHECK_INT(taken, 1);
    pair->input[length - 1] = byte;
    CHECK_INT(count, reference_byte(&pair->theirs, byte, theirs));
    compare(pair, length, ours, theirs, 2);
}

static void fall_silent(const struct pair *pair, int length)
{
    struct pair copy = *pair;
    struct gx_item ours, theirs;
    idle(&copy.ours, &ours);
    reference_idle(&copy.theirs, &theirs);
    compare(pair, length, &ours, &theirs, 1);
    /* Then nothing is waited for any more. */
    idle(&copy.ours, &ours);
    CHECK_INT(ours.kind, GX_NONE);
}

static void every_input(int host, int depth)
{
    struct set now, next;
    struct pair first;
    int length;

    memset(&first, 0, sizeof first);
    first.ours.host = first.theirs.host = host;
    memset(&now, 0, sizeof now);
    add(&now, &first);
    for (length = 1; length <= depth; ++length) {
        long i, before = check_count;
        memset(&next, 0, sizeof next);
        for (i = 0; i < now.count; ++i) {
            int byte;
            for (byte = 0; byte < 256; ++byte) {
                struct pair pair = now.pairs[i];
                feed(&pair, (unsigned char)byte, length);
                fall_silent(&pair, length);
                if (length < depth)
                    add(&next, &pair);
            }
        }
        printf("%s, %d bytes: %ld states, %ld checks\n", host ? "notices" : "commands", length, now.count,
               check_count - before);
        free(now.pairs);
        free(now.slots);
        now = next;
    }
    free(now.pairs);
    free(now.slots);
}

/* All that a stream in one piece makes, against the same bytes one by one. */
static void in_one_piece(int host, const unsigned char *bytes, int count)
{
    struct receiver whole, each;
    struct gx_item by_whole, by_each;
    int at = 0, taken, byte = 0;

    start(&whole, host);
    start(&each, host);
    while (at < count) {
        at += receive(&whole, bytes + at, count - at, &by_whole);
        /* Single bytes up to the next item, which comes at the same place. */
        by_each.kind = GX_NONE;
        while (byte < count && by_each.kind == GX_NONE) {
            taken = receive(&each, bytes + byte, 1, &by_each);
            byte += taken;
        }
        if (!CHECK(same_item(&by_whole, &by_each)) || !CHECK_INT(at, byte)) {
            check_dump("input", bytes, (size_t)count);
            return;
        }
    }
}

/* Every input of three bytes in one piece: the receivers look ahead where they can. */
static void every_piece(int host, int depth)
{
    unsigned char bytes[3];
    long number, end = 1L << 8 * depth;
    for (number = 0; number < end; ++number) {
        bytes[0] = (unsigned char)number;
        bytes[1] = (unsigned char)(number >> 8);
        bytes[2] = (unsigned char)(number >> 16);
        in_one_piece(host, bytes, depth);
    }
}

int main(int argc, char **argv)
{
    int depth = argc > 1 ? atoi(argv[1]) : 4;
    every_input(0, depth);
    every_input(1, depth);
    every_piece(0, depth < 3 ? depth : 3);
    every_piece(1, depth < 3 ? depth : 3);
    return check_summary("gx_exhaustive");
}
