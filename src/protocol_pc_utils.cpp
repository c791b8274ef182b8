/*
 * The C++ symbols of the original's protocol_pc_utils.h, for objects that were compiled with that: our header is inline.
 * A source, since an archive of Rust has none of C++. CMakeLists.txt compiles it into its library; other programs that
 * need it compile it themselves, with the include directory of their library.
 */
#include "libdeltarobot/payload.h"

#include <string>

namespace deltarobot {

const char *protocol_opcode_to_str(unsigned char opcode)
{
    return dp_opcode_name(opcode);
}

/* The original's header does not declare it, but its library has it. */
const char *protocol_status_to_str(int status)
{
    switch (status) {
    case DP_STATUS_IDLE: return "IDLE";
    case DP_STATUS_HOMING: return "HOMING";
    case DP_STATUS_MOVING: return "MOVING";
    case DP_STATUS_ERROR: return "ERROR";
    default: return "UNKNOWN_STATUS";
    }
}

std::string protocol_msg_to_str(const protocol_msg *msg)
{
    char text[DP_MSG_TEXT_MAX];
    const int length = dp_msg_format(msg, text, DP_MSG_TEXT_MAX);
    return length < 0 ? std::string() : std::string(text, static_cast<std::string::size_type>(length));
}

} /* namespace deltarobot */
