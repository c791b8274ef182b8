// A host and two controllers talk for 200 rounds, each over its own receive ring: C++98 on the original's API alone.
#include "libdeltarobot/protocol.h"

#include "check.h"

#include <cstdio>
#include <cstring>
#include <sstream>
#include <string>

static const int ROUNDS = 200;
static const int ROUNDS_SHOWN = 2;
static const int FRAME_OVERHEAD = 5;

// One end of a line: what arrives here goes into `received`.
struct Station {
    const char *name;
    protocol_data received;
    long bytes_in;

    explicit Station(const char *station) : name(station), received(), bytes_in(0) {}
};

// A program that looks into the ring's fields finds the unread bytes there.
static std::string unread(const Station &station)
{
    const protocol_data &ring = station.received;
    std::string bytes;
    for (int i = 0; i < ring.m_sz; ++i)
        bytes += ring.m_buf[(ring.m_idx + i) % DP_BUFSIZE];
    return bytes;
}

static void dump(const Station &station, int round)
{
    if (round >= ROUNDS_SHOWN)
        return;
    const std::string bytes = unread(station);
    std::printf("round %d, %s: m_idx=%d m_sz=%d:", round, station.name, station.received.m_idx, station.received.m_sz);
    for (std::string::size_type i = 0; i < bytes.size(); ++i)
        std::printf(" %02X", static_cast<unsigned>(static_cast<unsigned char>(bytes[i])));
    std::printf("\n");
}

// A line whose far end is a station's ring.
static int deliver(void *buf, int bytes, void *usr)
{
    Station *to = static_cast<Station *>(usr);
    const std::string before = unread(*to);
    const int rc = dp_process(&to->received, buf, bytes);
    to->bytes_in += bytes;
    CHECK_INT(rc, DP_RC_SUCCESS);
    const std::string sent(static_cast<const char *>(buf), static_cast<std::string::size_type>(bytes));
    CHECK(unread(*to) == before + sent);
    return rc;
}

static std::string payload_for(int round, int length)
{
    std::string payload;
    for (int i = 0; i < length; ++i)
        payload += static_cast<char>((round * 31 + i * 7) & 0xFF);
    return payload;
}

static void send(Station &to, unsigned char opcode, const std::string &payload)
{
    protocol_msg message;
    std::memset(&message, 0, sizeof message);
    message.opcode = opcode;
    message.data_s = static_cast<int>(payload.size());
    std::memcpy(message.data, payload.data(), payload.size());
    CHECK_INT(dp_send(&message, deliver, &to), DP_RC_SUCCESS);
}

static void expect(Station &at, unsigned char opcode, const std::string &payload)
{
    protocol_msg message;
    std::memset(&message, 0, sizeof message);
    CHECK_INT(dp_recv(&at.received, &message), DP_RC_SUCCESS);
    CHECK_INT(message.opcode, opcode);
    CHECK_INT(message.checksum_ok, 1);
    if (CHECK_INT(message.data_s, payload.size()))
        CHECK_BYTES(message.data, payload.data(), payload.size());
}

static void expect_nothing(Station &at)
{
    protocol_msg message;
    CHECK_INT(dp_recv(&at.received, &message), DP_RC_NO_FRAME);
    CHECK_INT(at.received.m_sz, 0);
    CHECK(at.received.m_idx >= 0 && at.received.m_idx < DP_BUFSIZE);
    CHECK_INT(at.received.m_idx, at.bytes_in % DP_BUFSIZE);
}

// A request and its answer, to and from each controller.
static void converse(Station &host, Station &controller, int round)
{
    const std::string target = payload_for(round, round % (DP_DATA_MAX_SIZE + 1));

    send(controller, DP_OPCODE_MOVE, target);
    dump(controller, round);
    expect(controller, DP_OPCODE_MOVE, target);
    expect_nothing(controller);
    send(host, DP_OPCODE_ACK, std::string(1, static_cast<char>(DP_OPCODE_MOVE)));
    dump(host, round);
    expect(host, DP_OPCODE_ACK, std::string(1, static_cast<char>(DP_OPCODE_MOVE)));
    expect_nothing(host);
}

// Three messages stand in the ring before one is read (fewer where three do not fit).
static void three_at_once(Station &controller, int round)
{
    static const unsigned char OPCODES[] = {DP_OPCODE_HOMING, DP_OPCODE_STATUS, DP_OPCODE_CANCEL};
    const int fitting = DP_BUFSIZE / (FRAME_OVERHEAD + 1);
    const int count = fitting < 3 ? fitting : 3;

    for (int i = 0; i < count; ++i)
        send(controller, OPCODES[i], payload_for(round, 1));
    CHECK_INT(controller.received.m_sz, count * (FRAME_OVERHEAD + 1));
    dump(controller, round);
    for (int i = 0; i < count; ++i)
        expect(controller, OPCODES[i], payload_for(round, 1));
    expect_nothing(controller);
}

int main()
{
    Station host("host"), left("left controller"), right("right controller");

    for (int round = 0; round < ROUNDS; ++round) {
        converse(host, left, round);
        converse(host, right, round);
        three_at_once(left, round);
        three_at_once(right, round);
        three_at_once(host, round);
    }
    return check_summary("cross_comm");
}
