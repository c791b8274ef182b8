/*
 * far_end LINK COMMAND...: makes LINK a link to a pseudo-terminal, runs the command and is its other end: sends back what
 * it receives, but reads nothing for a second after a '!', and closes after a '~'. Its status is the command's.
 */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

int main(int argc, char **argv)
{
    int fd = posix_openpt(O_RDWR | O_NOCTTY), near_end, status;
    struct termios raw;
    pid_t child;

    if (argc < 3 || fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0)
        return 2;
    unlink(argv[1]);
    /* As long as this is open, reading at the far end is no error. */
    near_end = open(ptsname(fd), O_RDWR | O_NOCTTY);
    if (near_end < 0 || tcgetattr(near_end, &raw) != 0 || symlink(ptsname(fd), argv[1]) != 0)
        return 2;
    cfmakeraw(&raw);
    tcsetattr(near_end, TCSANOW, &raw);
    child = fork();
    if (child == 0) {
        close(fd);
        close(near_end);
        execvp(argv[2], argv + 2);
        _exit(127);
    }
    while (waitpid(child, &status, WNOHANG) == 0) {
        char bytes[4096];
        struct pollfd arrival;
        ssize_t got;

        arrival.fd = fd;
        arrival.events = POLLIN;
        if (fd < 0 || poll(&arrival, 1, 20) <= 0) {
            usleep(20000);
            continue;
        }
        got = read(fd, bytes, sizeof bytes);
        if (got > 0 && memchr(bytes, '!', (size_t)got) != NULL)
            sleep(1);
        if (got > 0 && memchr(bytes, '~', (size_t)got) != NULL) {
            close(near_end);
            close(fd);
            fd = -1;
        } else if (got > 0 && write(fd, bytes, (size_t)got) != got) {
            fprintf(stderr, "far_end: bytes lost\n");
        }
    }
    unlink(argv[1]);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
