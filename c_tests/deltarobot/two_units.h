/* What the two units of this program tell each other. */
#ifndef TWO_UNITS_H
#define TWO_UNITS_H

#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

/* Each in the other unit: the structs have to look the same from both. */
int other_unit_send(struct protocol_msg *msg, send_func_t sendfunc, void *usr);
unsigned long other_unit_msg_size(void);
unsigned long other_unit_data_size(void);

#endif
