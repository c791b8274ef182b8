/* One program of two units that both include the headers, twice. */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/protocol_ext.h"
#include "two_units.h"

#include "check.h"

static int loop_back(void *buf, int bytes, void *usr)
{
    return dp_process((struct protocol_data *)usr, buf, bytes);
}

int main(void)
{
    static struct protocol_data ring;
    static struct protocol_msg sent, received;

    sent.opcode = DP_OPCODE_GENERAL_ERR;
    sent.data_s = 1;
    sent.data[0] = '$';
    CHECK_INT(other_unit_msg_size(), sizeof(struct protocol_msg));
    CHECK_INT(other_unit_data_size(), sizeof(struct protocol_data));
    CHECK_INT(other_unit_send(&sent, loop_back, &ring), DP_RC_SUCCESS);
    CHECK_INT(dp_recv(&ring, &received), DP_RC_SUCCESS);
    CHECK_INT(received.opcode, DP_OPCODE_GENERAL_ERR);
    CHECK_INT(received.data_s, 1);
    CHECK_INT(received.data[0], '$');
    return check_summary("two_units");
}
