/**
 * @file
 * libdeltarobot/protocol_pc_utils.h: messages as text, for C++ programs (C++98 and later) on computers.
 *
 * Source-compatible with the original's header of this name; all of it stands on payload.h, whose rules about pointers,
 * threads and interrupts hold here too.
 */
#ifndef LIBDELTAROBOT_PROTOCOL_PC_UTILS_H
#define LIBDELTAROBOT_PROTOCOL_PC_UTILS_H

#include <string>

#include "payload.h"

namespace deltarobot {

/**
 * The opcode's name, e.g. "MOVE!"; "UNKNOWN_OPCODE" for others. The string lives as long as the program.
 *
 *     std::cout << deltarobot::protocol_opcode_to_str(msg.opcode) << '\n';
 */
inline const char *protocol_opcode_to_str(unsigned char opcode)
{
    return dp_opcode_name(opcode);
}

/**
 * The message as a line of text without a line's end, e.g. "ACK: (MOVE!)"; empty for a null pointer. Status reports of
 * 13 bytes are read with the floats first, as the original does; dp_msg_format finds out which layout they have. Throws
 * nothing but what std::string does when there is no memory: not for interrupts.
 *
 *     while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
 *         std::cout << deltarobot::protocol_msg_to_str(&msg) << '\n';
 */
inline std::string protocol_msg_to_str(const protocol_msg *msg)
{
    char text[DP_MSG_TEXT_MAX];
    protocol_msg_status_report report;
    protocol_msg padded;
    if (dp_read_status_report(msg, DP_LAYOUT_FIRMWARE, &report) == DP_RC_SUCCESS &&
        dp_build_status_report(&padded, &report, DP_LAYOUT_FIRMWARE) == DP_RC_SUCCESS)
        msg = &padded;
    const int length = dp_msg_format(msg, text, DP_MSG_TEXT_MAX);
    return length < 0 ? std::string() : std::string(text, static_cast<std::string::size_type>(length));
}

} /* namespace deltarobot */

#endif
