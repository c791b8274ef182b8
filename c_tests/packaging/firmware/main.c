/* The least that firmware does with a message; it never runs. */
#include <libdeltarobot/payload.h>
#include <libdeltarobot/receiver.h>

static int drop(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)usr;
    return bytes;
}

int main(void)
{
    static struct dp_receiver receiver;
    static struct protocol_msg msg;
    static const struct protocol_msg_position target = {1, 2, 3};

    while (!dp_receiver_byte(&receiver, '$') || dp_receiver_next(&receiver, &msg) != DP_RC_SUCCESS)
        ;
    dp_build_move(&msg, &target);
    return dp_send(&msg, drop, 0);
}
