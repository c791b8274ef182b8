/*
 * demo DELTAROBOT HOST: runs `DELTAROBOT sim`, which makes a device, and HOST with that device.
 *
 * Exit status: the host's, or 1 when something else went wrong or it all took 10 s.
 */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define LIMIT_S 10

static volatile sig_atomic_t simulator, host;

static void too_late(int number)
{
    static const char text[] = "demo: not done in time\n";

    (void)number;
    if (host > 0)
        kill((pid_t)host, SIGKILL);
    if (simulator > 0)
        kill((pid_t)simulator, SIGKILL);
    _exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 2 : 1);
}

static int fail(const char *what)
{
    perror(what);
    return 1;
}

/* Starts a program, its standard output redirected unless `output` is -1. */
static pid_t start(const char *program, const char *argument, int output)
{
    pid_t child = fork();

    if (child == 0) {
        if (output >= 0)
            dup2(output, STDOUT_FILENO);
        execl(program, program, argument, (char *)NULL);
        perror(program);
        _exit(127);
    }
    return child;
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
    char device[256];
    FILE *told;
    int output[2], status;

    if (argc != 3) {
        fprintf(stderr, "usage: demo DELTAROBOT HOST\n");
        return 2;
    }
    signal(SIGALRM, too_late);
    alarm(LIMIT_S);
    if (pipe(output) != 0)
        return fail("demo: pipe");
    simulator = start(argv[1], "sim", output[1]);
    if (simulator < 0)
        return fail("demo: fork");
    close(output[1]);
    told = fdopen(output[0], "r");
    if (told == NULL || fgets(device, sizeof device, told) == NULL) {
        fprintf(stderr, "demo: %s sim tells no device\n", argv[1]);
        return 1;
    }
    device[strcspn(device, "\n")] = '\0';
    printf("A simulated robot is at %s.\n", device);
    fflush(stdout);

    host = start(argv[2], device, -1);
    status = host < 0 ? fail("demo: fork") : exit_status((pid_t)host);
    host = 0;
    kill((pid_t)simulator, SIGTERM);
    if (exit_status((pid_t)simulator) != 0) {
        fprintf(stderr, "demo: the simulator failed\n");
        return 1;
    }
    return status;
}
