#include "robot.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* The shipped firmware's unknown position, a signalling NaN: no float is made of it, which could change its bits. */
#define UNKNOWN UINT32_C(0x7F800001)

/* Reserved bits of STAT, which the shipped firmware sends as 1. */
#define STAT_RESERVED 0xE0

static void put_word(char *out, uint32_t word)
{
    int i;
    for (i = 0; i < 4; ++i)
        out[i] = (char)(word >> 8 * i);
}

static uint32_t get_word(const char *in)
{
    uint32_t word = 0;
    int i;
    for (i = 0; i < 4; ++i)
        word |= (uint32_t)(unsigned char)in[i] << 8 * i;
    return word;
}

static void put_float(char *out, float number)
{
    uint32_t word;
    memcpy(&word, &number, sizeof word);
    put_word(out, word);
}

static int get_float(const char *in, float *number)
{
    uint32_t word = get_word(in);

    if ((word & UINT32_C(0x7FFFFFFF)) > UINT32_C(0x7F800000))
        return -1; /* a NaN */
    memcpy(number, &word, sizeof word);
    return 0;
}

static int get_position(const char *in, float at[ARMS])
{
    int arm, failed = 0;
    for (arm = 0; arm < ARMS; ++arm)
        failed |= get_float(in + 4 * arm, &at[arm]);
    return failed;
}

float robot_distance(float at, float there)
{
    return at < there ? there - at : at - there;
}

void robot_request(struct protocol_msg *msg, unsigned char opcode)
{
    memset(msg, 0, sizeof *msg);
    msg->opcode = opcode;
}

void robot_answer(struct protocol_msg *msg, unsigned char opcode, unsigned char answered)
{
    robot_request(msg, opcode);
    msg->data_s = 1;
    msg->data[0] = (char)answered;
}

void robot_move(struct protocol_msg *msg, const float to[ARMS])
{
    int arm;
    robot_request(msg, DP_OPCODE_MOVE);
    msg->data_s = POSITION_BYTES;
    for (arm = 0; arm < ARMS; ++arm)
        put_float(msg->data + 4 * arm, to[arm]);
}

void robot_status(struct protocol_msg *msg, const struct status *status)
{
    int arm;
    robot_request(msg, DP_OPCODE_STATUS_REPL);
    msg->data_s = STATUS_BYTES;
    for (arm = 0; arm < ARMS; ++arm) {
        if (status->known)
            put_float(msg->data + 4 * arm, status->at[arm]);
        else
            put_word(msg->data + 4 * arm, UNKNOWN);
    }
    /* The end stops' bits are neighbours. */
    msg->data[POSITION_BYTES] = (char)(STAT_RESERVED | status->stops * DP_BIT_STAT_STOP_A_BIT | status->state);
}

int robot_read_move(const struct protocol_msg *msg, float to[ARMS])
{
    return msg->data_s == POSITION_BYTES ? get_position(msg->data, to) : -1;
}

int robot_read_status(const struct protocol_msg *msg, struct status *status)
{
    int stat;

    if (msg->opcode != DP_OPCODE_STATUS_REPL || msg->data_s < POSITION_BYTES + 1)
        return -1;
    stat = (unsigned char)msg->data[POSITION_BYTES];
    status->state = stat & DP_BIT_STAT_STATUS_BITS;
    status->stops = (stat & (DP_BIT_STAT_STOP_A_BIT | DP_BIT_STAT_STOP_B_BIT | DP_BIT_STAT_STOP_C_BIT)) /
                    DP_BIT_STAT_STOP_A_BIT;
    status->known = get_position(msg->data, status->at) == 0;
    return 0;
}

static const char *opcode_name(unsigned char opcode)
{
    switch (opcode) {
    case DP_OPCODE_ACK:         return "ACK";
    case DP_OPCODE_NACK:        return "NACK";
    case DP_OPCODE_HOMING:      return "HOMING!";
    case DP_OPCODE_STATUS:      return "STATUS?";
    case DP_OPCODE_MOVE:        return "MOVE!";
    case DP_OPCODE_CANCEL:      return "CANCEL!";
    case DP_OPCODE_HOMING_REPL: return "HOMING_REPLY";
    case DP_OPCODE_STATUS_REPL: return "STATUS_REPLY";
    case DP_OPCODE_MOVE_REPL:   return "MOVE_REPLY";
    case DP_OPCODE_GENERAL_ERR: return "GENERAL_ERROR";
    default:                    return "UNKNOWN_OPCODE";
    }
}

static void print_position(const float at[ARMS])
{
    printf("  DA=%g  DB=%g  DC=%g", (double)at[0], (double)at[1], (double)at[2]);
}

void robot_print(const struct protocol_msg *msg)
{
    static const char *const states[] = {"IDLE", "HOMING", "MOVING", "ERROR"};
    struct status status;
    float to[ARMS];
    int arm;

    fputs(opcode_name(msg->opcode), stdout);
    if ((msg->opcode == DP_OPCODE_ACK || msg->opcode == DP_OPCODE_NACK) && msg->data_s == 1) {
        printf(": (%s)", opcode_name((unsigned char)msg->data[0]));
    } else if (msg->opcode == DP_OPCODE_MOVE && robot_read_move(msg, to) == 0) {
        putchar(':');
        print_position(to);
    } else if (robot_read_status(msg, &status) == 0) {
        printf(": %s", states[status.state]);
        if (status.known)
            print_position(status.at);
        else
            fputs("  position unknown", stdout);
        for (arm = 0; arm < ARMS; ++arm)
            if (status.stops & 1 << arm)
                printf("  STP_%c", 'A' + arm);
    }
    putchar('\n');
}
