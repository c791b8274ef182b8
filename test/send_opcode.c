/*
 * send_opcode [DEVICE]: reads opcode characters from standard input and sends each as a frame without data on a serial
 * device, by default /dev/ttyACM0. Any character is sent, whether it is an opcode or not, but for the ends of lines.
 *
 * Exit status: 0 when all was sent, 1 when the device failed, 2 on wrong usage.
 */
#define _DEFAULT_SOURCE
#include "libdeltarobot/protocol.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#define DEFAULT_DEVICE "/dev/ttyACM0"

struct line {
    const char *device;
    int fd;
};

static int complain(const struct line *line, const char *what)
{
    fprintf(stderr, "send_opcode: %s: %s: %s\n", line->device, what, strerror(errno));
    return -1;
}

/* 115200 baud, 8 data bits, no parity, 1 stop bit, no flow control, every byte as it is. */
static int configure(const struct line *line)
{
    struct termios settings;

    if (tcgetattr(line->fd, &settings) != 0)
        return complain(line, errno == ENOTTY ? "not a serial device" : "can't read its settings");
    cfmakeraw(&settings);
    settings.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB | CRTSCTS);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_iflag &= ~(tcflag_t)(IXOFF | IXANY);
    if (cfsetispeed(&settings, B115200) != 0 || cfsetospeed(&settings, B115200) != 0 ||
        tcsetattr(line->fd, TCSANOW, &settings) != 0)
        return complain(line, "can't set 115200 baud, 8N1");
    return 0;
}

/* Opening without O_NONBLOCK would wait for a carrier that a three-wire line never has. */
static int open_line(struct line *line)
{
    int flags;

    line->fd = open(line->device, O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (line->fd < 0)
        return complain(line, "can't open");
    if (configure(line) != 0)
        return -1;
    flags = fcntl(line->fd, F_GETFL);
    if (flags < 0 || fcntl(line->fd, F_SETFL, flags & ~O_NONBLOCK) != 0)
        return complain(line, "can't make it blocking");
    return 0;
}

static int write_all(void *buf, int bytes, void *usr)
{
    const struct line *line = usr;
    const char *at = buf;

    while (bytes > 0) {
        ssize_t written = write(line->fd, at, (size_t)bytes);
        if (written < 0) {
            if (errno == EINTR)
                continue;
            return complain(line, "can't write");
        }
        at += written;
        bytes -= (int)written;
    }
    return 0;
}

static int send_opcodes(struct line *line)
{
    struct protocol_msg message;
    int c;

    memset(&message, 0, sizeof message);
    while ((c = getchar()) != EOF) {
        if (c == '\n' || c == '\r')
            continue;
        message.opcode = (unsigned char)c;
        if (dp_send(&message, write_all, line) != 0)
            return -1;
    }
    if (ferror(stdin)) {
        perror("send_opcode: standard input");
        return -1;
    }
    return tcdrain(line->fd) == 0 ? 0 : complain(line, "can't finish writing");
}

int main(int argc, char **argv)
{
    struct line line = {DEFAULT_DEVICE, -1};
    int failed;

    if (argc > 2) {
        fprintf(stderr, "usage: send_opcode [DEVICE]\n");
        return 2;
    }
    if (argc == 2)
        line.device = argv[1];
    failed = open_line(&line) != 0 || send_opcodes(&line) != 0;
    if (line.fd >= 0)
        close(line.fd);
    return failed ? 1 : 0;
}
