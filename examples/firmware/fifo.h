/*
 * The way of a byte from the UART's interrupt handler to the main loop.
 *
 * The ring of libdeltarobot is not made for two contexts: a dp_process() in the interrupt handler could run in the
 * midst of a dp_recv() of the main loop, and one of the two would see the other's half-done work. So the handler calls
 * nothing of the library. It puts bytes into this FIFO, which the main loop empties into the ring:
 *
 *     handler    fifo_put()                                     and nothing else
 *     main loop  fifo_get(), dp_process(), dp_recv(), dp_send()
 *
 * This needs no lock because each side writes only its own index, an index is written at once (one byte is, on every
 * processor), and the byte is in its place before the index says so: `volatile` keeps the compiler to that order, and
 * an interrupt handler on the same core sees what the core did in the order in which it did it. (With two cores, or
 * with a DMA controller in the handler's place, memory barriers would have to be added.)
 *
 * The alternative, to forbid the UART's interrupt around every call of the library, is as correct, but the handler then
 * waits as long as the longest dp_recv() takes: `make firmware-bench` says how long that is.
 */
#ifndef FIFO_H
#define FIFO_H

/* A power of two, at most half of what an index counts to. */
#ifndef FIFO_SIZE
#define FIFO_SIZE 64u
#endif

#if FIFO_SIZE <= 128
typedef unsigned char fifo_index;
#elif defined(__AVR__)
#error "an index of more than a byte is not written at once on AVR"
#else
typedef unsigned int fifo_index;
#endif

struct fifo {
    volatile unsigned char bytes[FIFO_SIZE];
    volatile fifo_index put; /* written by the handler only */
    volatile fifo_index got; /* written by the main loop only */
    volatile unsigned int lost; /* bytes that found no room: written by the handler only */
};

/* From the interrupt handler. When the main loop is late by more than the FIFO holds, the newest bytes are lost. */
static inline void fifo_put(struct fifo *fifo, unsigned char byte)
{
    fifo_index put = fifo->put;

    if ((fifo_index)(put - fifo->got) == FIFO_SIZE) {
        fifo->lost = fifo->lost + 1u;
        return;
    }
    fifo->bytes[put % FIFO_SIZE] = byte;
    fifo->put = (fifo_index)(put + 1u);
}

/* From the main loop: the oldest byte, or -1. */
static inline int fifo_get(struct fifo *fifo)
{
    fifo_index got = fifo->got;
    int byte;

    if (got == fifo->put)
        return -1;
    byte = fifo->bytes[got % FIFO_SIZE];
    fifo->got = (fifo_index)(got + 1u);
    return byte;
}

#endif
