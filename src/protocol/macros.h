/** First byte of every frame. */
#define DP_PROTO_FRAME_START '$'
/** Last byte of every frame. */
#define DP_PROTO_FRAME_END ':'

/** All opcodes, see the specification's section "Opcodes". */
#define DP_PROTO_ALL_OPCODES "ANHSMChsme"
/** Either way: accepted. The payload is the opcode that is answered. */
#define DP_OPCODE_ACK ((unsigned char)'A')
/** Either way: refused. The payload is the opcode that is answered. */
#define DP_OPCODE_NACK ((unsigned char)'N')
/** Host to controller: home. */
#define DP_OPCODE_HOMING ((unsigned char)'H')
/** Host to controller: report the status. */
#define DP_OPCODE_STATUS ((unsigned char)'S')
/** Host to controller: move. The payload is a struct protocol_msg_position. */
#define DP_OPCODE_MOVE ((unsigned char)'M')
/** Host to controller: cancel the operation. */
#define DP_OPCODE_CANCEL ((unsigned char)'C')
/** Controller to host: homing has finished. */
#define DP_OPCODE_HOMING_REPL ((unsigned char)'h')
/** Controller to host: the status. The payload is a struct protocol_msg_status_report. */
#define DP_OPCODE_STATUS_REPL ((unsigned char)'s')
/** Controller to host: the move has finished. */
#define DP_OPCODE_MOVE_REPL ((unsigned char)'m')
/** Controller to host: general error. */
#define DP_OPCODE_GENERAL_ERR ((unsigned char)'e')

/** Position of end stop A's bit in STAT (1 = pressed); bits 5 to 7 are reserved. */
#define DP_BIT_STAT_STOP_A_BIT (1 << 2)
/** Position of end stop B's bit in STAT. */
#define DP_BIT_STAT_STOP_B_BIT (1 << 3)
/** Position of end stop C's bit in STAT. */
#define DP_BIT_STAT_STOP_C_BIT (1 << 4)
