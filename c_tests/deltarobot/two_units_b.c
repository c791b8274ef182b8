#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"
#include "two_units.h"

int other_unit_send(struct protocol_msg *msg, send_func_t sendfunc, void *usr)
{
    return dp_send(msg, sendfunc, usr);
}

unsigned long other_unit_msg_size(void)
{
    return (unsigned long)sizeof(struct protocol_msg);
}

unsigned long other_unit_data_size(void)
{
    return (unsigned long)sizeof(struct protocol_data);
}
