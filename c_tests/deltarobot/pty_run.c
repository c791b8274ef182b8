/* pty_run SEND_OPCODE: runs send_opcode at one end of a pseudo-terminal and reads what it sends at the other. */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE
#include "libdeltarobot/protocol.h"

#include "check.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#define QUIET_MS 10000
#define TYPED "HSC\nx\r\n" DP_PROTO_ALL_OPCODES "\xFF"
#define SENT "HSCx" DP_PROTO_ALL_OPCODES "\xFF"

struct outcome {
    int status;
    char complaints[1024];
};

static int exit_status(pid_t child)
{
    int status;
    if (waitpid(child, &status, 0) != child)
        return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Runs the program with `typed` on its standard input; its standard error comes back. Both are too short to block. */
static struct outcome run(const char *program, const char *device, const char *extra, const char *typed)
{
    struct outcome outcome;
    int in[2], err[2];
    size_t length = 0;
    ssize_t got;
    pid_t child;

    memset(&outcome, 0, sizeof outcome);
    outcome.status = -1;
    if (pipe(in) != 0 || pipe(err) != 0 || (child = fork()) < 0) {
        perror("pty_run");
        return outcome;
    }
    if (child == 0) {
        dup2(in[0], STDIN_FILENO);
        dup2(err[1], STDERR_FILENO);
        close(in[0]);
        close(in[1]);
        close(err[0]);
        close(err[1]);
        execl(program, program, device, extra, (char *)NULL);
        _exit(127);
    }
    close(in[0]);
    close(err[1]);
    CHECK_INT(write(in[1], typed, strlen(typed)), strlen(typed));
    close(in[1]);
    while (length < sizeof outcome.complaints - 1 &&
           (got = read(err[0], outcome.complaints + length, sizeof outcome.complaints - 1 - length)) > 0)
        length += (size_t)got;
    close(err[0]);
    outcome.status = exit_status(child);
    return outcome;
}

/* Reads frames until there are as many as `expected` has characters, whose opcodes they carry. */
static void read_opcodes(int fd, const char *expected)
{
    static struct protocol_data ring;
    struct protocol_msg message;
    const unsigned char *next = (const unsigned char *)expected;
    unsigned char byte;
    int stray = 0;
    struct pollfd arrival;

    arrival.fd = fd;
    arrival.events = POLLIN;
    while (*next && poll(&arrival, 1, QUIET_MS) == 1 && read(fd, &byte, 1) == 1) {
        int rc;
        CHECK_INT(dp_process(&ring, &byte, 1), DP_RC_SUCCESS);
        rc = dp_recv(&ring, &message);
        if (strchr(DP_PROTO_ALL_OPCODES, *next) == NULL) {
            /* Whatever is typed is sent, and what is no opcode is no frame to the reader: five bytes of garbage. */
            if (++stray == 5) {
                ++next;
                stray = 0;
            }
            CHECK(rc != DP_RC_SUCCESS);
        } else if (rc == DP_RC_SUCCESS) {
            CHECK_INT(message.opcode, *next);
            CHECK_INT(message.data_s, 0);
            ++next;
        }
    }
    CHECK_INT(*next, 0);
    CHECK_INT(poll(&arrival, 1, 0), 0);
}

static void check_raw(int fd)
{
    struct termios settings;
    CHECK_INT(tcgetattr(fd, &settings), 0);
    CHECK_INT(cfgetospeed(&settings), B115200);
    CHECK_INT(cfgetispeed(&settings), B115200);
    CHECK((settings.c_cflag & CSIZE) == CS8);
    CHECK((settings.c_cflag & (CSTOPB | PARENB | CRTSCTS)) == 0);
    CHECK((settings.c_lflag & (ICANON | ECHO | ISIG | IEXTEN)) == 0);
    CHECK((settings.c_iflag & (IXON | IXOFF | ICRNL | INLCR | ISTRIP)) == 0);
    CHECK((settings.c_oflag & OPOST) == 0);
}

static void sends_what_is_typed(const char *program)
{
    int far_end = posix_openpt(O_RDWR | O_NOCTTY);
    const char *device;
    struct outcome outcome;
    int held;

    CHECK(far_end >= 0 && grantpt(far_end) == 0 && unlockpt(far_end) == 0);
    device = ptsname(far_end);
    if (!CHECK(device != NULL))
        return;
    held = open(device, O_RDWR | O_NOCTTY); /* or closing the other end would hang the line up */
    CHECK(held >= 0);
    outcome = run(program, device, NULL, TYPED);
    CHECK_INT(outcome.status, 0);
    CHECK(outcome.complaints[0] == '\0');
    read_opcodes(far_end, SENT);
    check_raw(held);
    close(held);
    close(far_end);
}

static void fails_naming(const char *program, const char *device)
{
    struct outcome outcome = run(program, device, NULL, "");
    CHECK_INT(outcome.status, 1);
    if (!CHECK(strstr(outcome.complaints, device) != NULL))
        fprintf(stderr, "    it said: %s\n", outcome.complaints);
}

int main(int argc, char **argv)
{
    const char *locked = "pty_run.locked";

    if (argc != 2) {
        fprintf(stderr, "usage: pty_run SEND_OPCODE\n");
        return 2;
    }
    sends_what_is_typed(argv[1]);
    fails_naming(argv[1], "/nonexistent/ttyS0");
    fails_naming(argv[1], "/dev/null");
    fails_naming(argv[1], argv[1]);
    CHECK_INT(run(argv[1], "one", "two", "").status, 2);
    if (access("/dev/ttyACM0", F_OK) != 0)
        CHECK(strstr(run(argv[1], NULL, NULL, "").complaints, "/dev/ttyACM0") != NULL);
    if (geteuid() != 0) {
        int fd = open(locked, O_CREAT | O_WRONLY, 0);
        CHECK(fd >= 0);
        fails_naming(argv[1], locked);
        close(fd);
        unlink(locked);
    }
    return check_summary("pty_run");
}
