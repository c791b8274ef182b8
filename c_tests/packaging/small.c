/* The smallest program that uses the original's three functions. */
#include "libdeltarobot/protocol.h"

static int drop(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)usr;
    return bytes;
}

int main(int argc, char **argv)
{
    static struct protocol_data ring;
    static struct protocol_msg msg;

    dp_process(&ring, argv[0], argc);
    return dp_recv(&ring, &msg) == DP_RC_SUCCESS ? dp_send(&msg, drop, &ring) : 0;
}
