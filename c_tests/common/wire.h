/* Frames built byte by byte from the specification, without the library, and a repeatable source of random bytes. */
#ifndef WIRE_H
#define WIRE_H

#include <string.h>

/* Bytes of a frame around its payload: starter, opcode, length, checksum, terminator. */
#define WIRE_OVERHEAD 5
#define WIRE_FRAME_MAX (255 + WIRE_OVERHEAD)

/* Writes a frame and gives its length. `size` is 0 to 255, whatever the library was built for. */
static inline int wire_frame(unsigned char *out, int opcode, const void *payload, int size)
{
    unsigned sum = '$' + ':' + (unsigned)opcode + (unsigned)size;
    int i;

    out[0] = '$';
    out[1] = (unsigned char)opcode;
    out[2] = (unsigned char)size;
    for (i = 0; i < size; ++i) {
        out[3 + i] = ((const unsigned char *)payload)[i];
        sum += out[3 + i];
    }
    out[3 + size] = (unsigned char)(sum & 0xFF);
    out[4 + size] = ':';
    return size + WIRE_OVERHEAD;
}

/* xorshift32: the state must not be 0. */
static inline unsigned wire_random(unsigned long *state)
{
    unsigned long x = *state;
    x ^= x << 13 & 0xFFFFFFFFul;
    x ^= x >> 17;
    x ^= x << 5 & 0xFFFFFFFFul;
    *state = x;
    return (unsigned)(x >> 4);
}

static inline void wire_random_bytes(unsigned long *state, void *out, size_t count)
{
    size_t i;
    for (i = 0; i < count; ++i)
        ((unsigned char *)out)[i] = (unsigned char)wire_random(state);
}

/* Memory that holds anything: all zeros, all ones, small numbers, or random bytes. */
static inline void wire_any_memory(unsigned long *state, void *out, size_t count)
{
    unsigned kind = wire_random(state) % 6;
    size_t i;

    wire_random_bytes(state, out, count);
    if (kind < 2)
        memset(out, kind ? 0xFF : 0, count);
    for (i = 0; i < count && kind == 2; ++i)
        ((unsigned char *)out)[i] &= 7;
}

#endif
