/* Firmware that sends back each frame it receives: what host.c checks the library with, byte for byte. */
#include "../../examples/firmware/board.h"

#include <libdeltarobot/protocol.h>

static int receive(struct protocol_data *ring)
{
    int byte = board_uart_read();
    unsigned char received = (unsigned char)byte;

    if (byte < 0)
        return 0;
    dp_process(ring, &received, 1);
    return 1;
}

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

    board_init();
    for (;;) {
        struct protocol_msg msg;

        receive(&ring);
        while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
            dp_send(&msg, send_frame, &ring);
    }
}
