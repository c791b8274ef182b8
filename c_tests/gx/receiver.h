/* The library's receiver, of the motion side or of the host. */
#ifndef GX_RECEIVER_H
#define GX_RECEIVER_H

#include "libdeltarobot/gx.h"

#include "check.h"

struct receiver {
    union {
        struct gx_commands commands;
        struct gx_notices notices;
    } of;
    int host;
};

static inline void start(struct receiver *receiver, int host)
{
    memset(receiver, 0, sizeof *receiver);
    receiver->host = host;
}

static inline int receive(struct receiver *receiver, const void *bytes, int count, struct gx_item *item)
{
    return receiver->host ? gx_notices_receive(&receiver->of.notices, bytes, count, item)
                          : gx_commands_receive(&receiver->of.commands, bytes, count, item);
}

/* The line is quiet. */
static inline void idle(struct receiver *receiver, struct gx_item *item)
{
    CHECK_INT(receiver->host ? gx_notices_idle(&receiver->of.notices, item)
                             : gx_commands_idle(&receiver->of.commands, item),
              GX_RC_SUCCESS);
}

static inline struct gx_number number(int value, int format)
{
    struct gx_number made;
    made.value = (uint16_t)value;
    made.format = (unsigned char)format;
    return made;
}

#endif
