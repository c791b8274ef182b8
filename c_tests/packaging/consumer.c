/*
 * Uses the library and prints which version and sizes it got: ring, payload, window of the line protocol. C, and by
 * consumer.cpp C++.
 */
#include "libdeltarobot/line_host.h"
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

#include <stdio.h>

static int into_ring(void *buf, int bytes, void *usr)
{
    return dp_process((struct protocol_data *)usr, buf, bytes);
}

int main(void)
{
    static struct protocol_data ring;
    static struct protocol_msg msg;

    msg.opcode = DP_OPCODE_STATUS;
    if (dp_send(&msg, into_ring, &ring) != DP_RC_SUCCESS)
        return 1;
    msg.opcode = 0;
    if (dp_recv(&ring, &msg) != DP_RC_SUCCESS || msg.opcode != DP_OPCODE_STATUS || msg.data_s != 0)
        return 2;
    printf("%s %d %d %d\n", dp_version(), (int)sizeof ring.m_buf, (int)sizeof msg.data, OLP_WINDOW_MAX);
    return 0;
}
