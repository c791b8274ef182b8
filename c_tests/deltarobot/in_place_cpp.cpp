// The way existing firmware takes the original in: header and source inside its own extern "C".
extern "C" {
#include "libdeltarobot/protocol.h"
#define PROTOCOL_C_NO_INCLUDE
#include "src/protocol.c"
}

#include "check.h"

static int loop_back(void *buf, int bytes, void *usr)
{
    return dp_process(static_cast<protocol_data *>(usr), buf, bytes);
}

int main()
{
    protocol_data ring = {{0}, 0, 0};
    protocol_msg message = protocol_msg();

    message.opcode = DP_OPCODE_STATUS;
    CHECK_INT(dp_send(&message, loop_back, &ring), DP_RC_SUCCESS);
    message.opcode = 0;
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_STATUS);
    return check_summary("in_place_cpp");
}
