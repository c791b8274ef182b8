// protocol_pc_utils.h, used as programs written against the original's use it; the texts are made by streams once more.
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_pc_utils.h"

#include "check.h"
#include "wire.h"

#include <iostream>
#include <sstream>

static std::string text_of(unsigned char opcode, const void *payload, int size)
{
    protocol_msg msg;
    msg.opcode = opcode;
    msg.data_s = size;
    msg.checksum_ok = 1;
    memcpy(msg.data, payload, static_cast<size_t>(size));
    return deltarobot::protocol_msg_to_str(&msg);
}

static void names()
{
    CHECK(std::string(deltarobot::protocol_opcode_to_str(DP_OPCODE_ACK)) == "ACK");
    CHECK(std::string(deltarobot::protocol_opcode_to_str(DP_OPCODE_STATUS)) == "STATUS?");
    CHECK(std::string(deltarobot::protocol_opcode_to_str(0)) == "UNKNOWN_OPCODE");
    CHECK(text_of(DP_OPCODE_ACK, "M", 1) == "ACK: (MOVE!)");
    CHECK(text_of(DP_OPCODE_NACK, "M", 1) == "NACK");
    CHECK(text_of(DP_OPCODE_HOMING, "", 0) == "HOMING!");
    CHECK(deltarobot::protocol_msg_to_str(0).empty());
}

#if DP_DATA_MAX_SIZE >= 16
static std::string streamed(const float *at)
{
    std::ostringstream out;
    out << "  DA=" << at[0] << "  DB=" << at[1] << "  DC=" << at[2];
    return out.str();
}

static void numbers()
{
    static const char *const STATES[] = {"IDLE", "HOMING", "MOVING", "ERROR"};
    unsigned long seed = 3;
    for (int i = 0; i < 3000; ++i) {
        unsigned char payload[16];
        float at[3];
        wire_random_bytes(&seed, payload, sizeof payload);
        memcpy(at, payload, sizeof at);
        CHECK(text_of(DP_OPCODE_MOVE, payload, 12) == "MOVE!:" + streamed(at));

        const int stat = payload[12];
        std::string expected = std::string("STATUS_REPLY: ") + STATES[stat & DP_BIT_STAT_STATUS_BITS] + streamed(at);
        if (stat & DP_BIT_STAT_STOP_A_BIT)
            expected += " STP_A";
        if (stat & DP_BIT_STAT_STOP_B_BIT)
            expected += " STP_B";
        if (stat & DP_BIT_STAT_STOP_C_BIT)
            expected += " STP_C";
        // Of any length, as the original reads it: floats first.
        for (int size = 13; size <= 16; ++size)
            CHECK(text_of(DP_OPCODE_STATUS_REPL, payload, size) == expected);
        CHECK(static_cast<int>(expected.size()) < DP_MSG_TEXT_MAX);
    }
}
#endif

int main()
{
    names();
#if DP_DATA_MAX_SIZE >= 16
    numbers();
#endif
    return check_summary("pc_utils");
}
