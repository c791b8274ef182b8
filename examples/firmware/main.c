/*
 * A controller's main loop on libdeltarobot.
 *
 * Built as it is, it polls the UART. Built with -DUART_INTERRUPT, an interrupt handler collects the bytes (see fifo.h),
 * and none is lost when a round of the loop takes longer than the UART can hold what comes in.
 */
#include "board.h"
#include "controller.h"

#include <libdeltarobot/protocol_ext.h>

/*
 * After so long a silence what is incomplete is given up: noise that looks like the beginning of a frame. At 115200
 * baud a frame of 37 bytes takes 3.2 ms, but the host's operating system may pause in the midst of one.
 */
#ifndef QUIET_MS
#define QUIET_MS 250u
#endif

/* Takes what has been received into the ring; returns whether there was something. */
static int receive(struct protocol_data *ring)
{
    int byte, any = 0;

    while ((byte = board_uart_read()) >= 0) {
        unsigned char received = (unsigned char)byte;

        dp_process(ring, &received, 1);
        any = 1;
#ifndef UART_INTERRUPT
        break; /* a byte a round */
#endif
    }
    return any;
}

/*
 * Called by dp_send with a whole frame; usr is the ring. To wait for the UART without emptying it would lose bytes that
 * come in meanwhile. Touching the ring from here is allowed: dp_send knows nothing of it, and dp_recv, which does, has
 * returned before the answer is made.
 */
static int send_frame(void *buf, int bytes, void *usr)
{
    const unsigned char *frame = buf;
    int i;

    for (i = 0; i < bytes; ++i)
        while (!board_uart_write(frame[i]))
            receive(usr);
    return bytes;
}

int main(void)
{
    static struct protocol_data ring;
    static struct controller controller;
    unsigned int heard_ms;

    board_init();
    heard_ms = board_ms();
    controller_init(&controller, board_ms(), send_frame, &ring);
    for (;;) {
        struct protocol_msg msg;
        int rc;

        if (receive(&ring))
            heard_ms = board_ms();
        if (board_ms() - heard_ms < QUIET_MS)
            rc = dp_recv(&ring, &msg);
        else
            rc = dp_recv_idle(&ring, &msg);
        /* One message a round, so that a burst of requests does not keep the arms waiting. */
        if (rc == DP_RC_SUCCESS)
            controller_message(&controller, &msg);
        controller_run(&controller, board_ms());
    }
}
