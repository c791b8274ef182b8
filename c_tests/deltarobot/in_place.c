/* The way existing programs take the original in: its source file is part of theirs. */
#ifdef WITH_HEADER_FIRST
#include "libdeltarobot/protocol.h"
#define PROTOCOL_C_NO_INCLUDE
#endif
#include "src/protocol.c"
#include "src/protocol.c"

#include "check.h"

static int loop_back(void *buf, int bytes, void *usr)
{
    return dp_process((struct protocol_data *)usr, buf, bytes);
}

int main(void)
{
    static struct protocol_data ring;
    static struct protocol_msg message;

    message.opcode = DP_OPCODE_STATUS;
    CHECK_INT(dp_send(&message, loop_back, &ring), DP_RC_SUCCESS);
    message.opcode = 0;
    CHECK_INT(dp_recv(&ring, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, DP_OPCODE_STATUS);
    return check_summary("in_place");
}
