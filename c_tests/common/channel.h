/*
 * Two lines that lose, flip, delay, double and split bytes, in simulated time; and what the tests of both ends over
 * them have in common: seeded runs, a clock that wraps, and what has to hold in a run.
 *
 * A checksum of 8 or 16 bits lets a damaged message pass now and then, and nothing holds for what it says. Each test
 * compares what an end understood with what the other has sent, and marks the run as forged when these differ. Such a
 * run is counted, and what went wrong in it too, but it proves nothing either way.
 */
#ifndef CHANNEL_H
#define CHANNEL_H

#include "check.h"
#include "wire.h"

#include <stdlib.h>

enum { QUEUE = 16384 };

typedef struct {
    unsigned lose_byte, flip_bit, repeat_byte, lose_piece, repeat_piece; /* chances, per 10000 */
    unsigned delay;                                                      /* the longest, in milliseconds */
    unsigned long from, until;                                           /* when the lines are cut */
} Quality;

typedef struct {
    unsigned char bytes[QUEUE];
    unsigned long due[QUEUE];
    unsigned head, count;
    unsigned long last_due;
} Line;

static unsigned long seed, now;
static unsigned long clock_start; /* what the sessions are told is that much more than now */
static Quality quality;
static Line down, up; /* from the host, and to it */

static int wrong, forged;
static const char *wrong_text;
static unsigned long wrong_at;
static long forged_runs, forged_wrong;

/* A breach of what has to hold. Told at the end of the run, when it is known whether anything was forged. */
#define HOLDS(condition, what)                                                                                         \
    do {                                                                                                               \
        if (!(condition) && !wrong) {                                                                                  \
            wrong = 1;                                                                                                 \
            wrong_text = what;                                                                                         \
            wrong_at = now;                                                                                            \
        }                                                                                                              \
    } while (0)

static unsigned below(unsigned limit)
{
    return wire_random(&seed) % limit;
}

static int chance(unsigned per_10000)
{
    return per_10000 != 0 && below(10000) < per_10000;
}

/* Where unsigned long has more than 32 bits, the upper ones mean nothing. */
static unsigned long clock_ms(void)
{
    static unsigned long calls;
    unsigned long upper = ++calls;
    return ((clock_start + now) & 0xFFFFFFFFul) | upper << 16 << 16;
}

/* --- the lines --- */

static int is_damaged(void)
{
    return quality.lose_byte || quality.flip_bit || quality.repeat_byte;
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

/* Bytes that share a fate: they are lost or doubled together, and come in the order they were sent in. */
static void transmit(Line *line, const void *bytes, int length)
{
    const unsigned char *sent = bytes;
    unsigned long due = now + (quality.delay ? below(quality.delay) : 0);
    int i, times;

    if ((now >= quality.from && now < quality.until) || chance(quality.lose_piece))
        return;
    if (due < line->last_due)
        due = line->last_due;
    for (times = chance(quality.repeat_piece) ? 2 : 1; times > 0; --times)
        for (i = 0; i < length; ++i) {
            unsigned char byte = sent[i];
            if (quality.delay && below(16) == 0 && due < now + quality.delay)
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

/* What has come by now, up to that many bytes, goes to a session: in as many portions as it takes, each fetched. */
static void arrive(Line *line, int cap, int (*receive)(const unsigned char *bytes, int count), void (*fetch)(void))
{
    unsigned char bytes[512];
    const unsigned char *rest = bytes;
    int length = arrived(line, bytes, cap), taken, tries = 0;

    do {
        taken = receive(rest, length);
        HOLDS(taken >= 0 && taken <= length, "took more than it was given");
        HOLDS(++tries < 1000, "nothing is taken");
        rest += taken;
        length -= taken;
        fetch();
    } while (length > 0 && !wrong);
}

/* Objects have no pointers to themselves: now and then, one goes on in another place. */
#define MOVE_AT_TIMES(object, places)                                                                                  \
    do {                                                                                                               \
        if (below(16) == 0) {                                                                                          \
            int moved_to = (object) == (places);                                                                       \
            (places)[moved_to] = *(object);                                                                            \
            memset((object), 0xDB, sizeof *(object));                                                                  \
            (object) = (places) + moved_to;                                                                            \
        }                                                                                                              \
    } while (0)

/* --- time --- */

static void earlier(unsigned long *next, unsigned long at)
{
    if (at < *next)
        *next = at;
}

/* A session's next deadline: it is not looked at before that, unless something has come. */
static void earlier_deadline(unsigned long *next, long deadline)
{
    HOLDS(deadline >= -1, "a deadline");
    if (deadline >= 0)
        earlier(next, now + (unsigned long)deadline);
}

/* To the next thing that happens. */
static void go_on(unsigned long next)
{
    if (up.count)
        earlier(&next, up.due[up.head]);
    if (down.count)
        earlier(&next, down.due[down.head]);
    now = next <= now ? now + 1 : next;
}

/* --- runs --- */

/* All that is random in a run comes of its number. One in four has its lines cut at some time. */
static void begin_run(unsigned long run, const Quality *qualities, size_t count, unsigned cut_before)
{
    seed = run * 2654435761ul % 0xFFFFFFFFul + 1;
    now = 1;
    clock_start = below(4) == 0 ? 0xFFFFFFFFul - below(20000) : below(1000000);
    quality = qualities[below((unsigned)count)];
    if (below(4) == 0) {
        quality.from = below(cut_before);
        quality.until = quality.from + below(12000);
    }
    memset(&down, 0, sizeof down);
    memset(&up, 0, sizeof up);
    wrong = forged = 0;
}

/* Where nothing was damaged, nothing may be forged: or else the test would not know what it knows. */
static void end_run(unsigned long run, int may_be_forged)
{
    CHECK(!forged || may_be_forged);
    forged_runs += forged;
    if (forged)
        forged_wrong += wrong;
    else if (!CHECK(!wrong))
        fprintf(stderr, "    run %lu, %lu ms: %s\n", run, wrong_at, wrong_text);
}

/* As the arguments say: [RUNS [FIRST_SEED]]. Of 100 runs, at most so many may be forged. */
static void run_all(int argc, char **argv, unsigned long runs, void (*run_once)(unsigned long run), int most)
{
    unsigned long first = argc > 2 ? strtoul(argv[2], NULL, 10) : 1, run;

    if (argc > 1)
        runs = strtoul(argv[1], NULL, 10);
    for (run = first; run < first + runs; ++run)
        run_once(run);
    CHECK((unsigned long)forged_runs <= (runs + 50) * (unsigned)most / 100);
    printf("%lu runs, %ld of them forged, of which %ld went wrong\n", runs, forged_runs, forged_wrong);
}

#endif
