// Answers as a controller that is idle and knows its position, and refuses to move. Try it:
// deltarobot status /dev/ttyACM0 --wait ready
#include <libdeltarobot.h>

static struct dp_receiver receiver;

static int write_frame(void *buf, int bytes, void *)
{
    return Serial.write((const uint8_t *)buf, bytes) == (size_t)bytes ? 0 : -1;
}

static void answer(const struct protocol_msg &msg)
{
    struct protocol_msg reply;

    if (msg.opcode == DP_OPCODE_STATUS) {
        const struct protocol_msg_status_report report = {1, 2, 3, DP_STATUS_IDLE};
        dp_build_status_report(&reply, &report, DP_LAYOUT_FIRMWARE);
    } else {
        dp_build_nack(&reply, msg.opcode);
    }
    dp_send(&reply, write_frame, NULL);
}

void setup()
{
    Serial.begin(115200);
}

void loop()
{
    while (Serial.available() > 0) {
        struct protocol_msg msg;

        if (dp_receiver_byte(&receiver, Serial.read()))
            while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
                answer(msg);
    }
}
