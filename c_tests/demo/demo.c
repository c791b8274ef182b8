/*
 * demo CONTROLLER HOST: makes a pseudo-terminal, runs the controller at one end of it and the host at the other.
 *
 * Exit status: the host's, or 1 when something else went wrong or it all took 10 s.
 */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#define LIMIT_S 10

static pid_t controller, host;

static void too_late(int signal_number)
{
    static const char text[] = "demo: not done in time\n";

    (void)signal_number;
    if (write(STDERR_FILENO, text, sizeof text - 1) < 0)
        _exit(2);
    if (host > 0)
        kill(host, SIGKILL);
    if (controller > 0)
        kill(controller, SIGKILL);
    _exit(1);
}

static int fail(const char *what)
{
    perror(what);
    return 1;
}

static int exit_status(pid_t child)
{
    int status;
    if (waitpid(child, &status, 0) != child || !WIFEXITED(status))
        return 1;
    return WEXITSTATUS(status);
}

int main(int argc, char **argv)
{
    const char *device;
    int robot_end, host_end, status;

    if (argc != 3) {
        fprintf(stderr, "usage: demo CONTROLLER HOST\n");
        return 2;
    }
    robot_end = posix_openpt(O_RDWR | O_NOCTTY);
    if (robot_end < 0 || grantpt(robot_end) != 0 || unlockpt(robot_end) != 0 || (device = ptsname(robot_end)) == NULL)
        return fail("demo: no pseudo-terminal");
    /* Held open, or the controller would see a line that hung up before the host comes. */
    host_end = open(device, O_RDWR | O_NOCTTY);
    if (host_end < 0)
        return fail(device);
    printf("The controller is at the other end of %s.\n", device);
    fflush(stdout);

    signal(SIGALRM, too_late);
    alarm(LIMIT_S);
    controller = fork();
    if (controller < 0)
        return fail("demo: fork");
    if (controller == 0) {
        close(host_end);
        dup2(robot_end, STDIN_FILENO);
        dup2(robot_end, STDOUT_FILENO);
        close(robot_end);
        execl(argv[1], argv[1], (char *)NULL);
        perror(argv[1]);
        _exit(127);
    }
    close(robot_end);
    host = fork();
    if (host == 0) {
        execl(argv[2], argv[2], device, (char *)NULL);
        perror(argv[2]);
        _exit(127);
    }
    status = host < 0 ? fail("demo: fork") : exit_status(host);
    close(host_end);
    if (exit_status(controller) != 0) {
        fprintf(stderr, "demo: the controller failed\n");
        return 1;
    }
    return status;
}
