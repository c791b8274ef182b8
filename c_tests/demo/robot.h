/*
 * What the messages of the delta robot carry, laid out as the shipped firmware does: floats are IEEE-754 binary32,
 * little-endian; a status report is DA, DB, DC, STAT and three bytes of padding.
 */
#ifndef ROBOT_H
#define ROBOT_H

#include "libdeltarobot/protocol.h"

#define ARMS 3
#define POSITION_BYTES (4 * ARMS)
#define STATUS_BYTES (POSITION_BYTES + 4)

#if DP_DATA_MAX_SIZE < STATUS_BYTES
#error "a status report has 16 bytes: build the library with DP_DATA_MAX_SIZE=16 or more"
#endif

/* How near to its target an arm has arrived. */
#define ROBOT_TOLERANCE 0.126f

struct status {
    int state;          /* DP_STATUS_* */
    int stops;          /* bit 0 to 2: end stop of arm A to C is pressed */
    int known;          /* 0 when no position is known, which only homing changes */
    float at[ARMS];     /* displacement of each arm */
};

/* How far an arm is from there. */
float robot_distance(float at, float there);

void robot_request(struct protocol_msg *msg, unsigned char opcode);
void robot_answer(struct protocol_msg *msg, unsigned char opcode, unsigned char answered);
void robot_move(struct protocol_msg *msg, const float to[ARMS]);
void robot_status(struct protocol_msg *msg, const struct status *status);

/* Each returns 0, or -1 when the payload is too short, or a number is none. */
int robot_read_move(const struct protocol_msg *msg, float to[ARMS]);
int robot_read_status(const struct protocol_msg *msg, struct status *status);

/* The message in words, on one line. */
void robot_print(const struct protocol_msg *msg);

#endif
