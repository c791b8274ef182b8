// An object as it was compiled with the original's header: these prototypes are recorded from it.
#include <string>

struct protocol_msg;

namespace deltarobot {
const char *protocol_opcode_to_str(unsigned char opcode);
std::string protocol_msg_to_str(const protocol_msg *msg);
const char *protocol_status_to_str(int status);
}

std::string recorded(unsigned char opcode, int status, const protocol_msg *msg)
{
    return std::string(deltarobot::protocol_opcode_to_str(opcode)) + " " +
        deltarobot::protocol_status_to_str(status) + " " + deltarobot::protocol_msg_to_str(msg);
}
