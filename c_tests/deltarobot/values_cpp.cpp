// C++98: the macros' types, as overloads and streams see them.
#include "libdeltarobot/protocol.h"

#include "check.h"

#include <sstream>
#include <string>

static const char *kind(char) { return "char"; }
static const char *kind(unsigned char) { return "unsigned char"; }
static const char *kind(int) { return "int"; }

template <int N> static int literal_size(const char (&)[N]) { return N; }

template <typename T> static std::string printed(T value)
{
    std::ostringstream stream;
    stream << value;
    return stream.str();
}

#define CHECK_TEXT(got, want) check_true(std::string(got) == (want), #got " is " #want, __FILE__, __LINE__)
#define CHECK_OPCODE(macro, text)                                                                                      \
    do {                                                                                                               \
        CHECK_TEXT(kind(macro), "unsigned char");                                                                      \
        CHECK_TEXT(printed(macro), text);                                                                              \
    } while (0)

static int take_none(void *, int bytes, void *) { return bytes; }

int main()
{
    CHECK_TEXT(kind(DP_PROTO_FRAME_START), "char");
    CHECK_TEXT(kind(DP_PROTO_FRAME_END), "char");
    CHECK_TEXT(printed(DP_PROTO_FRAME_START), "$");
    CHECK_TEXT(printed(DP_PROTO_FRAME_END), ":");
    CHECK_OPCODE(DP_OPCODE_ACK, "A");
    CHECK_OPCODE(DP_OPCODE_NACK, "N");
    CHECK_OPCODE(DP_OPCODE_HOMING, "H");
    CHECK_OPCODE(DP_OPCODE_STATUS, "S");
    CHECK_OPCODE(DP_OPCODE_MOVE, "M");
    CHECK_OPCODE(DP_OPCODE_CANCEL, "C");
    CHECK_OPCODE(DP_OPCODE_HOMING_REPL, "h");
    CHECK_OPCODE(DP_OPCODE_STATUS_REPL, "s");
    CHECK_OPCODE(DP_OPCODE_MOVE_REPL, "m");
    CHECK_OPCODE(DP_OPCODE_GENERAL_ERR, "e");
    CHECK_TEXT(kind(DP_BUFSIZE), "int");
    CHECK_TEXT(kind(DP_DATA_MAX_SIZE), "int");
    CHECK_TEXT(kind(DP_RC_GARBAGE), "int");
    CHECK_TEXT(kind(DP_STATUS_ERROR), "int");
    CHECK_TEXT(kind(DP_BIT_STAT_STOP_C_BIT), "int");
    CHECK_INT(literal_size(DP_PROTO_ALL_OPCODES), 11);
    CHECK_TEXT("<" DP_PROTO_ALL_OPCODES ">", "<ANHSMChsme>");

    // In C++ a tag is a type's name, and may be hidden by a variable's.
    protocol_msg message = protocol_msg();
    struct protocol_data protocol_data = {{0}, 0, 0};
    message.opcode = DP_OPCODE_STATUS;
    CHECK_INT(dp_send(&message, take_none, 0), 5);
    CHECK_INT(dp_recv(&protocol_data, &message), DP_RC_NO_FRAME);
    switch (message.opcode) {
    case DP_OPCODE_ACK:
    case DP_OPCODE_NACK:
        CHECK(!"an opcode without a message");
        break;
    default:
        break;
    }
    return check_summary("values_cpp");
}
