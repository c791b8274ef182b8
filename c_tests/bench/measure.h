/*
 * Measuring one side of a case, in nanoseconds or, under callgrind, in instructions: dumps the counts of each side
 * into their own file. Lines and labels are "CASE GOAL SIDE BYTES ...", see run.sh.
 */
#ifndef MEASURE_H
#define MEASURE_H

#include <stdio.h>
#include <time.h>

#if defined(__has_include)
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#endif
#endif
#ifndef CALLGRIND_ZERO_STATS
#define CALLGRIND_ZERO_STATS (void)0
#define CALLGRIND_DUMP_STATS_AT(label) (void)(label)
#endif

/* A case is timed as often as fits in this time, and the fastest one counts. */
#define TIMED_SECONDS 0.01

static int use_callgrind;

/* What is measured leaves something here, so that no compiler can do without it. */
static volatile unsigned taken;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Once beforehand: what a stream has left behind belongs to its cost. */
#define MEASURE(name, goal, side, bytes, call)                                                                         \
    do {                                                                                                               \
        char label[100];                                                                                               \
        call;                                                                                                          \
        if (use_callgrind) {                                                                                           \
            sprintf(label, "%s %d %s %d", name, goal, side, bytes);                                                    \
            CALLGRIND_ZERO_STATS;                                                                                      \
            call;                                                                                                      \
            CALLGRIND_DUMP_STATS_AT(label);                                                                            \
        } else {                                                                                                       \
            double best = 1e9, began = now(), before, after = began;                                                   \
            while (after < began + TIMED_SECONDS) {                                                                    \
                before = now();                                                                                        \
                call;                                                                                                  \
                after = now();                                                                                         \
                if (after - before < best)                                                                             \
                    best = after - before;                                                                             \
            }                                                                                                          \
            printf("%s %d %s %d %.2f\n", name, goal, side, bytes, best * 1e9 / (bytes));                               \
        }                                                                                                              \
    } while (0)

#endif
