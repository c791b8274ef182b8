/**
 * @file
 * libdeltarobot/abi.h: what all headers share. Each includes it; no program has to.
 *
 * What holds for each function, unless it says otherwise (docs/api.md has all of it):
 *
 * - Pointers: NULL is answered with an error, never followed. Others point to whole objects of their type, aligned,
 *   writable where they are not const, with any contents. The objects of one call don't overlap.
 * - Threads and interrupts: a call has its objects to itself; no other thread and no interrupt touches them while it
 *   runs. Calls on different objects may come at the same time, in interrupts too. No call waits or locks.
 * - Callbacks may call the library, on the same objects too. Each can be called with the usr that is handed over with
 *   it.
 * - Times (now_ms) are milliseconds of any clock that doesn't go back. Their lowest 32 bits count, and may wrap.
 */
#ifndef LIBDELTAROBOT_ABI_H
#define LIBDELTAROBOT_ABI_H

#include "sizes.h"

/*
 * The sizes are part of the symbols' names: a program compiled with these headers does not link with a library of other
 * sizes. The plain names are there for programs compiled with the original's header.
 */
#define LIBDELTAROBOT_STR_(text) #text
#define LIBDELTAROBOT_STR(text) LIBDELTAROBOT_STR_(text)
#if defined(__GNUC__) || defined(__clang__) || defined(__TINYC__)
#ifdef __USER_LABEL_PREFIX__
#define LIBDELTAROBOT_SYMBOL(name) __asm__(LIBDELTAROBOT_STR(__USER_LABEL_PREFIX__) name)
#else
#define LIBDELTAROBOT_SYMBOL(name) __asm__(name)
#endif
#else
/* These compilers can't give a function another symbol: a macro gives it another name. */
#define LIBDELTAROBOT_SYMBOL(name)
#define LIBDELTAROBOT_SIZED_BY_MACRO
#endif

#define LIBDELTAROBOT_JOIN2_(name, a, b) name##_##a##_##b
#define LIBDELTAROBOT_JOIN2(name, a, b) LIBDELTAROBOT_JOIN2_(name, a, b)
#define LIBDELTAROBOT_JOIN4_(name, a, b, c, d) name##_##a##_##b##_##c##_##d
#define LIBDELTAROBOT_JOIN4(name, a, b, c, d) LIBDELTAROBOT_JOIN4_(name, a, b, c, d)

#define DP_SIZED_NAME(name) LIBDELTAROBOT_JOIN2(name, DP_BUFSIZE, DP_DATA_MAX_SIZE)
#define OLP_SIZED_NAME(name) \
    LIBDELTAROBOT_JOIN4(name, OLP_LINE_MAX, OLP_WINDOW_MAX, OLP_REPLY_MAX, OLP_DEVICES_MAX)
#define GX_SIZED_NAME(name) LIBDELTAROBOT_JOIN2(name, GX_QUEUE_MAX, GX_WINDOW_MAX)

#define DP_SIZED(name) LIBDELTAROBOT_SYMBOL(LIBDELTAROBOT_STR(DP_SIZED_NAME(name)))
#define OLP_SIZED(name) LIBDELTAROBOT_SYMBOL(LIBDELTAROBOT_STR(OLP_SIZED_NAME(name)))
#define GX_SIZED(name) LIBDELTAROBOT_SYMBOL(LIBDELTAROBOT_STR(GX_SIZED_NAME(name)))

/*
 * Structs that #pragma pack or -fpack-struct packs are not those of the library, which would write behind their ends:
 * so a header that is included like that does not compile. Nothing is aligned more than a pointer is.
 */
#if defined(__GNUC__) || defined(__clang__) || defined(_MSC_VER)
#define LIBDELTAROBOT_NOT_PACKED(header) \
    struct libdeltarobot_packing_of_##header { char first; void *second; }; \
    typedef char libdeltarobot_structs_must_not_be_packed_in_##header \
        [sizeof(struct libdeltarobot_packing_of_##header) == sizeof(void *) + __alignof(void *) ? 1 : -1]
#else
#define LIBDELTAROBOT_NOT_PACKED(header) struct libdeltarobot_packing_of_##header
#endif

/* What structs consist of that hold pointers: in 64-bit Windows these are larger than unsigned long. */
#ifdef _WIN64
#include <stddef.h>
#define LIBDELTAROBOT_WORD size_t
#else
#define LIBDELTAROBOT_WORD unsigned long
#endif

#endif
