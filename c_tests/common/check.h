/* What every test program here shares: checks that count, and say where and what when they fail. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <string.h>

static int check_count;
static int check_failures;

/* A check inside a loop may fail thousands of times; the first few tell the story. */
#define CHECK_SHOWN_MAX 25

static inline int check_fails(void)
{
    return ++check_failures <= CHECK_SHOWN_MAX;
}

static inline int check_true(int ok, const char *what, const char *file, int line)
{
    ++check_count;
    if (!ok && check_fails())
        fprintf(stderr, "%s:%d: failed: %s\n", file, line, what);
    return ok;
}

static inline int check_int(long got, long want, const char *what, const char *file, int line)
{
    ++check_count;
    if (got != want && check_fails())
        fprintf(stderr, "%s:%d: %s: expected %ld, got %ld\n", file, line, what, want, got);
    return got == want;
}

static inline void check_dump(const char *label, const unsigned char *bytes, size_t count)
{
    size_t i;
    fprintf(stderr, "    %s", label);
    for (i = 0; i < count; ++i)
        fprintf(stderr, " %02x", bytes[i]);
    fputc('\n', stderr);
}

static inline int check_bytes(const void *got, const void *want, size_t count, const char *what, const char *file,
                              int line)
{
    int same = memcmp(got, want, count) == 0;
    ++check_count;
    if (!same && check_fails()) {
        fprintf(stderr, "%s:%d: %s: bytes differ\n", file, line, what);
        check_dump("expected", (const unsigned char *)want, count);
        check_dump("got     ", (const unsigned char *)got, count);
    }
    return same;
}

#define CHECK(condition) check_true(!!(condition), #condition, __FILE__, __LINE__)
#define CHECK_INT(got, want) check_int((long)(got), (long)(want), #got, __FILE__, __LINE__)
#define CHECK_BYTES(got, want, count) check_bytes((got), (want), (size_t)(count), #got, __FILE__, __LINE__)

/* The last line of every main(): prints the one-line summary and is the exit status. */
static inline int check_summary(const char *program)
{
    printf("%s: %d checks, %d failed\n", program, check_count, check_failures);
    return check_failures ? 1 : 0;
}

#endif
