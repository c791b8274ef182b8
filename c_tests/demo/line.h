/* A serial line between two programs, as both ends of the demo use it. */
#ifndef LINE_H
#define LINE_H

#include "libdeltarobot/protocol.h"

/*
 * A line silent for so many ms is quiet: no frame is on its way. The longest takes 3.2 ms at 115200 baud; the rest is
 * for programs that share a computer with others and have to wait for it.
 */
#define LINE_QUIET_MS 20

struct line {
    int in, out; /* file descriptors */
};

/* Time since some moment in the past, in ms. */
unsigned long line_now(void);

/* Sets a terminal device to 115200 baud 8N1 without flow control, every byte as it is. Returns 0, or -1 and errno. */
int line_configure(int fd);

/*
 * Waits up to timeout_ms for bytes and puts as many into the ring as it has room for. Returns their number, 0 when none
 * came, or -1 when the other end is gone.
 */
int line_receive(const struct line *line, struct protocol_data *ring, int timeout_ms);

/* Writes all of the bytes. A send_func_t, for which usr is the line. Returns 0, or -1 and errno. */
int line_write(void *buf, int bytes, void *usr);

#endif
