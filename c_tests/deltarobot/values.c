/*
 * What existing programs rely on at compile time besides layouts: values and types of protocol.h's macros, free names.
 * And the values that the protocols share. In C11, for _Generic.
 */
#include "ContouringProtocol.h"
#include "libdeltarobot/gx.h"
#include "libdeltarobot/host.h"
#include "libdeltarobot/line_host.h"
#include "libdeltarobot/protocol.h"

#include "check.h"

#define SAME(a, b) _Static_assert((a) == (b), #a " is not " #b)

#define IS_INT(macro, value)                                                                                           \
    SAME(macro, value);                                                                                                \
    _Static_assert(_Generic((macro), int: 1, default: 0), #macro " is not an int")
#define IS_OPCODE(macro, value)                                                                                        \
    SAME(macro, value);                                                                                                \
    _Static_assert(_Generic((macro), unsigned char: 1, default: 0), #macro " is not an unsigned char")
#define HAS_TYPE(object, type) _Static_assert(_Generic(&(object), type *: 1, default: 0), #object " is not " #type)

/* The sizes may be compared by the preprocessor. */
#if DP_BUFSIZE < 6 || DP_DATA_MAX_SIZE < 1 || DP_DATA_MAX_SIZE > 255
#error "sizes out of range"
#endif
#if DP_RC_SUCCESS != 0 || DP_STATUS_MOVING != 2 || DP_BIT_STAT_STATUS_BITS != 3
#error "the integer macros are for the preprocessor too"
#endif

_Static_assert(_Generic((DP_BUFSIZE), int: 1, default: 0), "DP_BUFSIZE is not an int");
_Static_assert(_Generic((DP_DATA_MAX_SIZE), int: 1, default: 0), "DP_DATA_MAX_SIZE is not an int");
IS_INT(DP_RC_SUCCESS, 0);
IS_INT(DP_RC_ERROR_GENERIC, 1);
IS_INT(DP_RC_NO_FRAME, 2);
IS_INT(DP_RC_OVERFLOW, 3);
IS_INT(DP_RC_GARBAGE, 4);
IS_INT(DP_PROTO_FRAME_START, '$');
IS_INT(DP_PROTO_FRAME_END, ':');
IS_INT(DP_STATUS_IDLE, 0);
IS_INT(DP_STATUS_HOMING, 1);
IS_INT(DP_STATUS_MOVING, 2);
IS_INT(DP_STATUS_ERROR, 3);
IS_INT(DP_BIT_STAT_STATUS_BITS, 0x03);
IS_INT(DP_BIT_STAT_STATUS_IDLE, 0);
IS_INT(DP_BIT_STAT_STATUS_HOMING, 1);
IS_INT(DP_BIT_STAT_STATUS_MOVING, 2);
IS_INT(DP_BIT_STAT_STATUS_ERROR, 3);
IS_INT(DP_BIT_STAT_STOP_A_BIT, 1 << 2);
IS_INT(DP_BIT_STAT_STOP_B_BIT, 1 << 3);
IS_INT(DP_BIT_STAT_STOP_C_BIT, 1 << 4);
IS_INT(DP_BIT_STAT_STOP_PRESSED, 1);
IS_INT(DP_BIT_STAT_STOP_CLEAR, 0);
IS_OPCODE(DP_OPCODE_ACK, 'A');
IS_OPCODE(DP_OPCODE_NACK, 'N');
IS_OPCODE(DP_OPCODE_HOMING, 'H');
IS_OPCODE(DP_OPCODE_STATUS, 'S');
IS_OPCODE(DP_OPCODE_MOVE, 'M');
IS_OPCODE(DP_OPCODE_CANCEL, 'C');
IS_OPCODE(DP_OPCODE_HOMING_REPL, 'h');
IS_OPCODE(DP_OPCODE_STATUS_REPL, 's');
IS_OPCODE(DP_OPCODE_MOVE_REPL, 'm');
IS_OPCODE(DP_OPCODE_GENERAL_ERR, 'e');

/* A literal: it has its own size, and joins its neighbours. */
static const char joined[] = "<" DP_PROTO_ALL_OPCODES ">";

/* Operators bind outside the macros' replacement. */
SAME(DP_BIT_STAT_STOP_A_BIT + 1, 5);

static struct protocol_msg message;
static struct protocol_data ring;
HAS_TYPE(message.opcode, unsigned char);
HAS_TYPE(message.data_s, int);
HAS_TYPE(message.data[0], char);
HAS_TYPE(message.checksum_ok, int);
HAS_TYPE(ring.m_buf[0], char);
HAS_TYPE(ring.m_idx, int);
HAS_TYPE(ring.m_sz, int);

/* All of the messages have texts of that length at most, whatever the sizes. */
SAME(DP_MSG_TEXT_MAX, 96);
SAME(DP_HOST_OUTPUT_MAX, 5 + 17 + 5);

/* --- results: a number means the same in all protocols --- */

IS_INT(DP_RC_BUSY, 5);
IS_INT(DP_RC_NO_EVENT, 6);
SAME(OLP_RC_SUCCESS, DP_RC_SUCCESS);
SAME(OLP_RC_ERROR_GENERIC, DP_RC_ERROR_GENERIC);
SAME(OLP_RC_OVERFLOW, DP_RC_OVERFLOW);
SAME(OLP_RC_BUSY, DP_RC_BUSY);
SAME(OLP_RC_NO_EVENT, DP_RC_NO_EVENT);
IS_INT(OLP_RC_MALFORMED, 8);
IS_INT(OLP_RC_TOO_LONG, 9);
IS_INT(OLP_RC_RANGE, 10);
IS_INT(OLP_RC_NOT_FOUND, 11);
IS_INT(OLP_RC_NO_COMMAND, 12);
IS_INT(OLP_RC_NAME, 13);
SAME(GX_RC_SUCCESS, DP_RC_SUCCESS);
SAME(GX_RC_ERROR_GENERIC, DP_RC_ERROR_GENERIC);
SAME(GX_RC_OVERFLOW, DP_RC_OVERFLOW);
SAME(GX_RC_BUSY, DP_RC_BUSY);
SAME(GX_RC_NO_EVENT, DP_RC_NO_EVENT);
SAME(GX_RC_RANGE, OLP_RC_RANGE);
SAME(GX_RC_NOT_FOUND, OLP_RC_NOT_FOUND);

/* --- ContouringProtocol.h --- */

SAME(CPAxis_x + CPAxis_y + CPAxis_z + CPAxis_a + CPAxis_b + CPAxis_c, 15);
SAME(1 << CPAxis_x, CPMask_x);
SAME(1 << CPAxis_y, CPMask_y);
SAME(1 << CPAxis_z, CPMask_z);
SAME(1 << CPAxis_a, CPMask_a);
SAME(1 << CPAxis_b, CPMask_b);
SAME(1 << CPAxis_c, CPMask_c);
SAME(CPMask_velocity, 64);

/* --- what can only be seen at work --- */

static const char *name(unsigned char opcode)
{
    switch (opcode) {
    case DP_OPCODE_ACK: return "ACK";
    case DP_OPCODE_NACK: return "NACK";
    case DP_OPCODE_HOMING: return "HOMING";
    case DP_OPCODE_STATUS: return "STATUS";
    case DP_OPCODE_MOVE: return "MOVE";
    case DP_OPCODE_CANCEL: return "CANCEL";
    case DP_OPCODE_HOMING_REPL: return "HOMING_REPL";
    case DP_OPCODE_STATUS_REPL: return "STATUS_REPL";
    case DP_OPCODE_MOVE_REPL: return "MOVE_REPL";
    case DP_OPCODE_GENERAL_ERR: return "GENERAL_ERR";
    default: return "";
    }
}

static int take_none(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)usr;
    return bytes;
}

int main(void)
{
    /* The tags are not typedefs: C programs have variables of these names. */
    int protocol_msg = 1;
    int protocol_msg_status_report = 2;
    int protocol_msg_position = 3;
    struct protocol_data *protocol_data = &ring;
    /* The declared types of the functions, to the letter. */
    int (*process)(struct protocol_data *, void *, int) = dp_process;
    int (*recv)(struct protocol_data *, struct protocol_msg *) = dp_recv;
    int (*send)(struct protocol_msg *, send_func_t, void *) = dp_send;
    send_func_t callback = take_none;
    int (*plain_callback)(void *, int, void *) = callback;
    const char *opcode;

    CHECK_INT(protocol_msg + protocol_msg_status_report + protocol_msg_position, 6);
    CHECK(strcmp(joined, "<ANHSMChsme>") == 0);
    for (opcode = DP_PROTO_ALL_OPCODES; *opcode; ++opcode)
        CHECK(*name((unsigned char)*opcode) != '\0');
    message.opcode = DP_OPCODE_HOMING;
    CHECK_INT(send(&message, plain_callback, NULL), 5);
    CHECK_INT(process(protocol_data, message.data, 0), DP_RC_SUCCESS);
    CHECK_INT(recv(protocol_data, &message), DP_RC_NO_FRAME);
    return check_summary("values");
}
