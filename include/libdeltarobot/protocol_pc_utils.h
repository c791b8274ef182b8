/*
 * libdeltarobot/protocol_pc_utils.h: messages as text, for C++ programs (C++98 and later) on computers.
 *
 * Source-compatible with the original's header of this name; all of it stands on payload.h.
 */
#ifndef LIBDELTAROBOT_PROTOCOL_PC_UTILS_H
#define LIBDELTAROBOT_PROTOCOL_PC_UTILS_H

#include <string>

#include "libdeltarobot/payload.h"

namespace deltarobot {

/* The opcode's name, e.g. "MOVE!"; "UNKNOWN_OPCODE" for others. */
inline const char *protocol_opcode_to_str(unsigned char opcode)
{
    return dp_opcode_name(opcode);
}

/* The message as a line of text, e.g. "ACK: (MOVE!)"; empty for a null pointer. */
inline std::string protocol_msg_to_str(const protocol_msg *msg)
{
    char text[DP_MSG_TEXT_MAX];
    const int length = dp_msg_format(msg, text, DP_MSG_TEXT_MAX);
    return length < 0 ? std::string() : std::string(text, static_cast<std::string::size_type>(length));
}

} /* namespace deltarobot */

#endif
