/*
 * demo PROGRAM SIMULATOR ARGUMENT...: runs the simulator, which makes a device and prints its path, and PROGRAM with
 * that path.
 *
 * demo --line PROGRAM SIMULATOR ARGUMENT...: makes the device itself, a pseudo-terminal, whose other end is the
 * simulator's standard input and output, and runs PROGRAM with its path; the simulator ends when nobody has that open
 * any more.
 *
 * Exit status: PROGRAM's, or 1 when something else went wrong or it all took 10 s.
 */
#define _XOPEN_SOURCE 700
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#define LIMIT_S 10

static volatile sig_atomic_t simulator, program;

static void too_late(int number)
{
    static const char text[] = "demo: not done in time\n";

    (void)number;
    if (program > 0)
        kill((pid_t)program, SIGKILL);
    if (simulator > 0)
        kill((pid_t)simulator, SIGKILL);
    _exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 2 : 1);
}

static int fail(const char *what)
{
    perror(what);
    return 1;
}

/* Starts a program; its standard input and output are these unless they are -1. */
static pid_t start(char *const *arguments, int input, int output)
{
    pid_t child = fork();

    if (child == 0) {
        if (input >= 0)
            dup2(input, STDIN_FILENO);
        if (output >= 0)
            dup2(output, STDOUT_FILENO);
        execv(arguments[0], arguments);
        perror(arguments[0]);
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

/* Starts a simulator that tells its device. */
static int simulate(char *const *arguments, char *device, int size)
{
    FILE *told;
    int output[2];

    if (pipe(output) != 0)
        return fail("demo: pipe");
    simulator = start(arguments, -1, output[1]);
    if (simulator < 0)
        return fail("demo: fork");
    close(output[1]);
    told = fdopen(output[0], "r");
    if (told == NULL || fgets(device, size, told) == NULL) {
        fprintf(stderr, "demo: %s tells no device\n", arguments[0]);
        return 1;
    }
    device[strcspn(device, "\n")] = '\0';
    return 0;
}

/* Starts a simulator on a pseudo-terminal, over which bytes go as they are, even before a program has set it. */
static int attach(char *const *arguments, char *device, size_t size)
{
    int line = posix_openpt(O_RDWR | O_NOCTTY), end = -1;
    struct termios settings;
    const char *path;

    if (line < 0 || grantpt(line) != 0 || unlockpt(line) != 0 || (path = ptsname(line)) == NULL || strlen(path) >= size)
        return fail("demo: no pseudo-terminal");
    strcpy(device, path);
    end = open(device, O_RDWR | O_NOCTTY);
    if (end < 0 || tcgetattr(end, &settings) != 0)
        return fail(device);
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    if (tcsetattr(end, TCSANOW, &settings) != 0)
        return fail(device);
    /* Once it was opened and closed, the other end is told that nobody has it open. */
    close(end);
    simulator = start(arguments, line, line);
    if (simulator < 0)
        return fail("demo: fork");
    close(line);
    return 0;
}

int main(int argc, char **argv)
{
    int on_line = argc > 1 && strcmp(argv[1], "--line") == 0, status;
    char device[256], *arguments[3];

    argv += on_line;
    if (argc - on_line < 3) {
        fprintf(stderr, "usage: demo [--line] PROGRAM SIMULATOR ARGUMENT...\n");
        return 2;
    }
    signal(SIGALRM, too_late);
    alarm(LIMIT_S);
    if (on_line ? attach(argv + 2, device, sizeof device) : simulate(argv + 2, device, sizeof device)) {
        if (simulator > 0)
            kill((pid_t)simulator, SIGKILL);
        return 1;
    }
    printf("A simulated device is at %s.\n", device);
    fflush(stdout);

    arguments[0] = argv[1];
    arguments[1] = device;
    arguments[2] = NULL;
    program = start(arguments, -1, -1);
    status = program < 0 ? fail("demo: fork") : exit_status((pid_t)program);
    program = 0;
    if (!on_line)
        kill((pid_t)simulator, SIGTERM);
    if (exit_status((pid_t)simulator) != 0) {
        fprintf(stderr, "demo: the simulator failed\n");
        return 1;
    }
    return status;
}
