/*
 * host DEVICE: drives a controller through a conversation, and prints each message in words. The device may be a real
 * one with a real robot behind it, which should have room to move.
 *
 * Exit status: 0 when everything happened as expected, 1 when something did not, 2 when there is no device to talk to.
 */
#define _DEFAULT_SOURCE
#include "libdeltarobot/protocol.h"
#include "line.h"
#include "robot.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>

/* How long an answer, the next status report of a moving robot and homing may take. */
#define ANSWER_MS 2000
/* How long to listen where nothing shall come. */
#define SILENCE_MS 100

struct host {
    struct line line;
    struct protocol_data ring;
    unsigned long began;
    int sent, received, expected, failed;
};

static void stamp(const struct host *host, const char *direction)
{
    unsigned long ms = line_now() - host->began;
    printf("%3lu.%03lu s  host %s controller  ", ms / 1000, ms % 1000, direction);
}

static void title(const char *text)
{
    printf("\n%s\n", text);
}

static int expect(struct host *host, int ok, const char *what)
{
    ++host->expected;
    if (!ok) {
        ++host->failed;
        printf("    NOT AS EXPECTED: %s\n", what);
    }
    return ok;
}

static void send(struct host *host, struct protocol_msg *msg)
{
    stamp(host, "->");
    robot_print(msg);
    ++host->sent;
    expect(host, dp_send(msg, line_write, &host->line) == 0, "the line takes the request");
}

static void request(struct host *host, unsigned char opcode)
{
    struct protocol_msg msg;
    robot_request(&msg, opcode);
    send(host, &msg);
}

static void request_move(struct host *host, const float to[ARMS])
{
    struct protocol_msg msg;
    robot_move(&msg, to);
    send(host, &msg);
}

/* Waits for the next message. Returns 0, or -1 when none came in time. */
static int receive(struct host *host, struct protocol_msg *msg, int timeout_ms)
{
    unsigned long end = line_now() + (unsigned long)timeout_ms;
    long left;

    while (dp_recv(&host->ring, msg) != DP_RC_SUCCESS) {
        left = (long)(end - line_now());
        if (left <= 0 || line_receive(&host->line, &host->ring, (int)left) < 0)
            return -1;
    }
    stamp(host, "<-");
    robot_print(msg);
    ++host->received;
    return 0;
}

static int expect_answer(struct host *host, unsigned char opcode, unsigned char answered)
{
    struct protocol_msg msg;
    int came;

    /* Reports of a moving robot may be on their way already. */
    do
        came = receive(host, &msg, ANSWER_MS) == 0;
    while (came && msg.opcode == DP_OPCODE_STATUS_REPL);
    return expect(host, came && msg.opcode == opcode && msg.data_s == 1 && (unsigned char)msg.data[0] == answered,
                  opcode == DP_OPCODE_ACK ? "the request is acknowledged" : "the request is refused");
}

static int expect_status(struct host *host, struct status *status, int state, const char *what)
{
    struct protocol_msg msg;
    memset(status, 0, sizeof *status);
    return expect(host, receive(host, &msg, ANSWER_MS) == 0 && robot_read_status(&msg, status) == 0 &&
                            status->state == state, what);
}

static void expect_silence(struct host *host, const char *what)
{
    struct protocol_msg msg;
    expect(host, receive(host, &msg, SILENCE_MS) != 0, what);
}

/* Follows status reports until the robot is in another state than `state`, or `limit` came. Returns their number. */
static int follow(struct host *host, struct status *status, int state, int limit)
{
    struct protocol_msg msg;
    int count = 0;

    do {
        if (receive(host, &msg, ANSWER_MS) != 0 || robot_read_status(&msg, status) != 0) {
            expect(host, 0, "status reports until the operation ends");
            break;
        }
    } while (++count < limit && status->state == state);
    return count;
}

static int arrived(const struct status *status, const float at[ARMS])
{
    int arm, here = status->known;
    for (arm = 0; here && arm < ARMS; ++arm)
        here = robot_distance(status->at[arm], at[arm]) <= ROBOT_TOLERANCE;
    return here;
}

static void disturb(struct host *host, const char *bytes, size_t size)
{
    char noise[64];
    size_t i;

    memcpy(noise, bytes, size);
    stamp(host, "->");
    printf("noise:");
    for (i = 0; i < size; ++i)
        printf(" %02X", (unsigned)(unsigned char)noise[i]);
    putchar('\n');
    expect(host, line_write(noise, (int)size, &host->line) == 0, "the line takes the noise");
}

#define DISTURB(host, bytes) disturb((host), (bytes), sizeof(bytes) - 1)

static void damage_move(struct host *host)
{
    static const char move_with_flipped_bit[] = "$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD7:";
    disturb(host, move_with_flipped_bit, sizeof move_with_flipped_bit - 1);
}

static void converse(struct host *host)
{
    static const float home[ARMS] = {0, 0, 0}, first[ARMS] = {10, 7.5f, 12.5f}, second[ARMS] = {80, 90, 80},
                       beyond[ARMS] = {-5, 10, 10};
    struct status status, before;
    int reports;

    title("A robot that was just switched on does not know where its arms are, and refuses to move.");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_IDLE, "an idle robot");
    expect(host, !status.known, "an unknown position");
    request_move(host, first);
    expect_answer(host, DP_OPCODE_NACK, DP_OPCODE_MOVE);
    expect_silence(host, "a refusal without a status report");

    title("Homing: the arms go to their end stops.");
    request(host, DP_OPCODE_HOMING);
    expect_answer(host, DP_OPCODE_ACK, DP_OPCODE_HOMING);
    expect_status(host, &status, DP_STATUS_HOMING, "homing began");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_HOMING, "homing goes on");
    expect_status(host, &status, DP_STATUS_IDLE, "homing ended");
    expect(host, status.stops == 7 && arrived(&status, home), "all arms at their end stops");

    title("A move, with a status report for each step of the encoders.");
    request_move(host, first);
    expect_answer(host, DP_OPCODE_ACK, DP_OPCODE_MOVE);
    expect_status(host, &status, DP_STATUS_MOVING, "the move began");
    reports = follow(host, &status, DP_STATUS_MOVING, 100);
    expect(host, reports >= 5, "a report for each 2.5 units of the 12.5");
    expect(host, status.state == DP_STATUS_IDLE && status.stops == 0 && arrived(&status, first),
           "the arms at the target");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_IDLE, "an idle robot");
    expect(host, arrived(&status, first), "the arms still there");

    title("Noise with false starts directly before a request, which is answered all the same.");
    DISTURB(host, "\x01\xFF$$$A$M\xFFn$C\0:$S\0\xB0:\x9B$h\x01\x80:::$");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_IDLE, "the request behind the noise is answered");

    title("Noise that looks like the beginning of a long frame: a request behind it is heard when the line is quiet.");
    DISTURB(host, "$M\x10");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_IDLE, "the request behind the false start is answered");

    title("A damaged request is lost: no answer, no movement.");
    damage_move(host);
    expect_silence(host, "nothing");
    request(host, DP_OPCODE_STATUS);
    expect_status(host, &status, DP_STATUS_IDLE, "an idle robot");
    expect(host, arrived(&status, first), "the arms where they were");

    title("A second move, cancelled on its way.");
    before = status;
    request_move(host, second);
    expect_answer(host, DP_OPCODE_ACK, DP_OPCODE_MOVE);
    expect_status(host, &status, DP_STATUS_MOVING, "the move began");
    follow(host, &status, DP_STATUS_MOVING, 4);
    request(host, DP_OPCODE_CANCEL);
    expect_answer(host, DP_OPCODE_ACK, DP_OPCODE_CANCEL);
    expect_status(host, &status, DP_STATUS_IDLE, "the move ended");
    expect(host, status.at[1] > before.at[1] && status.at[1] < second[1], "the arms between start and target");
    expect_silence(host, "no more reports");

    title("A move beyond an end stop is an error, in which everything but a status request is refused.");
    request_move(host, beyond);
    expect_answer(host, DP_OPCODE_ACK, DP_OPCODE_MOVE);
    expect_status(host, &status, DP_STATUS_MOVING, "the move began");
    follow(host, &status, DP_STATUS_MOVING, 100);
    expect(host, status.state == DP_STATUS_ERROR && status.stops == 1, "an error at the end stop of arm A");
    request(host, DP_OPCODE_HOMING);
    expect_answer(host, DP_OPCODE_NACK, DP_OPCODE_HOMING);
    expect_status(host, &status, DP_STATUS_ERROR, "the error stays");
}

int main(int argc, char **argv)
{
    static struct host host;
    int fd;

    if (argc != 2) {
        fprintf(stderr, "usage: host DEVICE\n");
        return 2;
    }
    fd = open(argv[1], O_RDWR | O_NOCTTY);
    if (fd < 0 || line_configure(fd) != 0) {
        perror(argv[1]);
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, 0);
    host.line.in = host.line.out = fd;
    host.began = line_now();
    converse(&host);
    printf("\n%d messages sent, %d received in %.1f s; %d expectations, %d not met: %s\n", host.sent, host.received,
           (double)(line_now() - host.began) / 1000, host.expected, host.failed,
           host.failed ? "FAILED" : "all as expected");
    return host.failed ? 1 : 0;
}
