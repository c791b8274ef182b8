// Includes headers by a path, with no option of the compiler's: they find each other, and fit the last build there.
#include "../libdeltarobot/include/libdeltarobot/protocol_pc_utils.h"

#include <cstdio>

std::string recorded(unsigned char opcode, int status, const protocol_msg *msg);

static int into_ring(void *buf, int bytes, void *usr)
{
    return dp_process(static_cast<protocol_data *>(usr), buf, bytes);
}

int main()
{
    static protocol_data ring;
    protocol_msg msg = protocol_msg();

    msg.opcode = DP_OPCODE_ACK;
    msg.data_s = 1;
    msg.data[0] = static_cast<char>(DP_OPCODE_MOVE);
    if (dp_send(&msg, into_ring, &ring) != DP_RC_SUCCESS || dp_recv(&ring, &msg) != DP_RC_SUCCESS)
        return 1;
    std::printf("%d %s, %s\n", static_cast<int>(sizeof ring.m_buf), deltarobot::protocol_msg_to_str(&msg).c_str(),
        recorded(msg.opcode, DP_STATUS_MOVING, &msg).c_str());
    return 0;
}
