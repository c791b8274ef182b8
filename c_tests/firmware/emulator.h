/* An emulator, frames to and from its UART, and what the phases of a test have in common. */
#ifndef EMULATOR_H
#define EMULATOR_H

#include <libdeltarobot/protocol.h>

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define ANSWER_MS 10000
#define ALL_SECONDS 240
#define FRAME_MAX (DP_DATA_MAX_SIZE + 5)

static pid_t emulator = -1;
static int line = -1;
static struct protocol_data from_firmware;
static const char *phase = "start";

static void stop_emulator(void)
{
    if (emulator > 0) {
        kill(emulator, SIGKILL);
        waitpid(emulator, NULL, 0);
        emulator = -1;
    }
}

static void on_alarm(int number)
{
    static const char text[] = "host: out of time\n";

    (void)number;
    if (write(2, text, sizeof text - 1) < 0 || emulator > 0)
        kill(emulator, SIGKILL);
    _exit(1);
}

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            fprintf(stderr, "host: %s: line %d: %s\n", phase, __LINE__, #condition); \
            exit(1); \
        } \
    } while (0)

static uint32_t seed = 12345;

static unsigned int any(unsigned int below)
{
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return seed % below;
}

static double seconds(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void put(const void *bytes, size_t count)
{
    const char *at = bytes;

    while (count > 0) {
        ssize_t written = write(line, at, count);

        CHECK(written > 0 || errno == EINTR);
        if (written > 0) {
            at += written;
            count -= (size_t)written;
        }
    }
}

/* Collects frames, to be sent at once or in pieces. */
struct stream {
    unsigned char bytes[4096];
    int count;
};

static int append(void *buf, int bytes, void *usr)
{
    struct stream *stream = usr;

    CHECK(stream->count + bytes <= (int)sizeof stream->bytes);
    memcpy(stream->bytes + stream->count, buf, (size_t)bytes);
    stream->count += bytes;
    return 0;
}

static void frame(struct stream *stream, unsigned char opcode, const void *data, int bytes)
{
    struct protocol_msg msg;

    msg.opcode = opcode;
    msg.data_s = bytes;
    if (bytes > 0)
        memcpy(msg.data, data, (size_t)bytes);
    CHECK(dp_send(&msg, append, stream) == 0);
}

static void request(unsigned char opcode, const void *data, int bytes)
{
    struct stream stream;

    stream.count = 0;
    frame(&stream, opcode, data, bytes);
    put(stream.bytes, (size_t)stream.count);
}

/* The next message from the firmware; 0 when none came in time. Nothing but frames may come. */
static int get(struct protocol_msg *msg, int wait_ms)
{
    for (;;) {
        struct pollfd ready;
        char bytes[64];
        ssize_t count;
        int rc = dp_recv(&from_firmware, msg);

        if (rc == DP_RC_SUCCESS)
            return 1;
        CHECK(rc == DP_RC_NO_FRAME);
        ready.fd = line;
        ready.events = POLLIN;
        rc = poll(&ready, 1, wait_ms);
        CHECK(rc >= 0 || errno == EINTR);
        if (rc == 0)
            return 0;
        count = read(line, bytes, sizeof bytes);
        CHECK(count > 0); /* else the emulator has ended */
        CHECK(dp_process(&from_firmware, bytes, (int)count) == DP_RC_SUCCESS);
    }
}

static void expect(struct protocol_msg *msg, unsigned char opcode)
{
    CHECK(get(msg, ANSWER_MS));
    CHECK(msg->opcode == opcode);
}

static void expect_answer(unsigned char answer, unsigned char to)
{
    struct protocol_msg msg;

    expect(&msg, answer);
    CHECK(msg.data_s == 1 && (unsigned char)msg.data[0] == to);
}

static void passed(double since, const char *what, int count)
{
    printf("    %-12s %5d %s, %.1f s\n", phase, count, what, seconds() - since);
    fflush(stdout);
}

/* Runs that with the UART at its standard input and output. */
static void start_emulator(char **command)
{
    int pair[2];

    CHECK(socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0);
    signal(SIGPIPE, SIG_IGN);
    emulator = fork();
    CHECK(emulator >= 0);
    if (emulator == 0) {
        dup2(pair[1], 0);
        dup2(pair[1], 1);
        close(pair[0]);
        close(pair[1]);
        execvp(command[0], command);
        perror(command[0]);
        _exit(127);
    }
    close(pair[1]);
    line = pair[0];
    atexit(stop_emulator);
    signal(SIGALRM, on_alarm);
    alarm(ALL_SECONDS);
}

static void wait_for_start(void)
{
    struct protocol_msg msg;
    int tries = 0;

    do {
        CHECK(++tries < 100);
        request(DP_OPCODE_STATUS, NULL, 0);
    } while (!get(&msg, 100));
    while (get(&msg, 300))
        ;
}

#endif
