#define _DEFAULT_SOURCE
#include "line.h"

#include <errno.h>
#include <poll.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

unsigned long line_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000;
}

int line_configure(int fd)
{
    struct termios settings;

    if (tcgetattr(fd, &settings) != 0)
        return -1;
    cfmakeraw(&settings);
    settings.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB | CRTSCTS);
    settings.c_cflag |= CLOCAL | CREAD;
    if (cfsetispeed(&settings, B115200) != 0 || cfsetospeed(&settings, B115200) != 0)
        return -1;
    return tcsetattr(fd, TCSANOW, &settings);
}

int line_receive(const struct line *line, struct protocol_data *ring, int timeout_ms)
{
    char bytes[DP_BUFSIZE];
    struct pollfd arrival;
    ssize_t count;

    arrival.fd = line->in;
    arrival.events = POLLIN;
    if (poll(&arrival, 1, timeout_ms) <= 0)
        return 0;
    count = read(line->in, bytes, (size_t)(DP_BUFSIZE - ring->m_sz));
    if (count < 0 && (errno == EINTR || errno == EAGAIN))
        return 0;
    if (count <= 0)
        return -1;
    dp_process(ring, bytes, (int)count);
    return (int)count;
}

int line_write(void *buf, int bytes, void *usr)
{
    const struct line *line = usr;
    const char *at = buf;

    while (bytes > 0) {
        ssize_t count = write(line->out, at, (size_t)bytes);
        if (count < 0 && errno != EINTR)
            return -1;
        if (count > 0) {
            at += count;
            bytes -= (int)count;
        }
    }
    return 0;
}
