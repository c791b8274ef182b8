/* The controller of the platform: answers the host's requests and moves three arms, which are simulated here. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include <libdeltarobot/protocol.h>

#include <stdint.h>

struct arm {
    float position; /* where the arm is, in units of the wire; means nothing until it is known */
    float target;
    int stop; /* 1: the end stop is pressed */
};

struct controller {
    struct arm arms[3];
    unsigned char status; /* DP_STATUS_* */
    unsigned char known; /* 1: the arms have been homed, so their positions are known */
    unsigned int moved_ms; /* when the arms were moved last */
    send_func_t send;
    void *usr;
};

/* Arms somewhere, nobody knows where. Answers go out through send, which is given usr. */
void controller_init(struct controller *controller, unsigned int now_ms, send_func_t send, void *usr);

/* Carries out one message of the host's and answers it. */
void controller_message(struct controller *controller, const struct protocol_msg *msg);

/* Moves the arms on to the present time, and reports. To be called at least every few milliseconds. */
void controller_run(struct controller *controller, unsigned int now_ms);

#endif
