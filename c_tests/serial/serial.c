/* serial.h over pseudo-terminals, whose other end is driven by this program, a thread of it or a child. */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE
#include "libdeltarobot/serial.h"

#include "check.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define MEGABYTE (1 << 20)

struct pair {
    int far_end;
    struct dp_serial port;
    char device[128];
};

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000;
}

static void make_pty(struct pair *pair)
{
    const char *name;
    pair->far_end = posix_openpt(O_RDWR | O_NOCTTY);
    if (pair->far_end < 0 || grantpt(pair->far_end) != 0 || unlockpt(pair->far_end) != 0 ||
        (name = ptsname(pair->far_end)) == NULL) {
        perror("serial: no pseudo-terminal");
        exit(2);
    }
    strcpy(pair->device, name);
}

static void connect_pair(struct pair *pair)
{
    make_pty(pair);
    memset(&pair->port, 0xA5, sizeof pair->port);
    if (!CHECK_INT(dp_serial_open(&pair->port, pair->device, 0), DP_RC_SUCCESS)) {
        fprintf(stderr, "    %s\n", dp_serial_error(&pair->port));
        exit(1);
    }
    CHECK(dp_serial_error(&pair->port)[0] == '\0');
}

static void disconnect_pair(struct pair *pair)
{
    CHECK_INT(dp_serial_close(&pair->port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_close(&pair->port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_read(&pair->port, pair->device, 1, 0), -DP_RC_ERROR_GENERIC);
    if (pair->far_end >= 0)
        close(pair->far_end);
}

/* The error names the device and says `what`. */
static void check_error(const struct dp_serial *port, const char *device, const char *what)
{
    const char *text = dp_serial_error(port);
    if (!CHECK(strncmp(text, device, strlen(device)) == 0 && strstr(text, what) != NULL))
        fprintf(stderr, "    it said: %s\n", text);
}

static void layout(void)
{
    CHECK_INT(DP_RC_DEVICE, 7);
    CHECK_INT(sizeof(struct dp_serial), 384);
    CHECK_INT(offsetof(struct dp_serial_settings, dtr), sizeof(long));
    CHECK_INT(offsetof(struct dp_serial_settings, rts), sizeof(long) + sizeof(int));
    CHECK_INT(offsetof(struct dp_serial_settings, keep_lines), sizeof(long) + 2 * sizeof(int));
    CHECK(DP_SERIAL_ON > 0 && DP_SERIAL_OFF < 0);
}

static void settings_are_those_of_the_link(void)
{
    static const struct {
        unsigned long baud;
        speed_t speed;
    } speeds[] = {{0, B115200},  {DP_SERIAL_BAUD, B115200}, {1200, B1200},
                  {9600, B9600}, {57600, B57600},           {230400, B230400}};
    struct pair pair;
    size_t i;

    make_pty(&pair);
    for (i = 0; i < sizeof speeds / sizeof *speeds; ++i) {
        struct termios got;
        CHECK_INT(dp_serial_open(&pair.port, pair.device, speeds[i].baud), DP_RC_SUCCESS);
        CHECK_INT(tcgetattr(dp_serial_handle(&pair.port), &got), 0);
        CHECK_INT(cfgetospeed(&got), speeds[i].speed);
        CHECK_INT(cfgetispeed(&got), speeds[i].speed);
        CHECK((got.c_cflag & CSIZE) == CS8);
        CHECK((got.c_cflag & (CSTOPB | PARENB | CRTSCTS)) == 0);
        CHECK((got.c_cflag & (CLOCAL | CREAD)) == (CLOCAL | CREAD));
        CHECK((got.c_lflag & (ICANON | ECHO | ECHONL | ISIG | IEXTEN)) == 0);
        CHECK((got.c_iflag & (IXON | IXOFF | ICRNL | INLCR | IGNCR | ISTRIP | PARMRK | BRKINT | IGNBRK)) == 0);
        CHECK((got.c_oflag & OPOST) == 0);
        CHECK(got.c_cc[VMIN] == 1 && got.c_cc[VTIME] == 0);
        CHECK((fcntl(dp_serial_handle(&pair.port), F_GETFL) & O_NONBLOCK) != 0);
        CHECK((fcntl(dp_serial_handle(&pair.port), F_GETFD) & FD_CLOEXEC) != 0);
        CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    }
    close(pair.far_end);
}

#if defined(__linux__) && defined(__GLIBC__)
/* A driver between the library and the pseudo-terminal: with modem lines, and with speeds that divide its clock. */
static struct {
    int has_lines, lines;
    int changes[4], change_count; /* to what the lines were set */
    unsigned clock;
    int is_exclusive, keeps_lines;
} driver;

/* Linux' own settings; their header can't be included beside <termios.h>. */
struct kernel_termios {
    unsigned iflag, oflag, cflag, lflag;
    unsigned char line, cc[19];
    unsigned ispeed, ospeed;
};
#define GET_SETTINGS 0x802C542AUL
#define SET_SETTINGS 0x402C542BUL

/* The library's calls come here. */
int ioctl(int fd, unsigned long request, ...)
{
    struct kernel_termios settings;
    va_list rest;
    void *argument;

    va_start(rest, request);
    argument = va_arg(rest, void *);
    va_end(rest);
    if (driver.has_lines && request == TIOCMGET) {
        *(int *)argument = driver.lines;
        return 0;
    }
    if (driver.has_lines && request == TIOCMSET) {
        driver.lines = *(const int *)argument;
        driver.changes[driver.change_count++ & 3] = driver.lines;
        return 0;
    }
    if (request == TIOCEXCL || request == TIOCNXCL)
        driver.is_exclusive = request == TIOCEXCL;
    if (request == SET_SETTINGS) {
        settings = *(const struct kernel_termios *)argument;
        driver.keeps_lines = (settings.cflag & HUPCL) == 0;
        if (driver.clock != 0) {
            settings.cflag = (settings.cflag & ~(unsigned)CBAUD) | 0010000;
            settings.ospeed = driver.clock / ((driver.clock + settings.ospeed / 2) / settings.ospeed);
        }
        argument = &settings;
    }
    return (int)syscall(SYS_ioctl, fd, request, argument);
}

static void any_speed_can_be_had(void)
{
    static const unsigned long speeds[] = {250000, 74880, 31250, 12345, 110, 460800, 4000000};
    struct pair pair;
    struct kernel_termios got;
    size_t i;

    make_pty(&pair);
    for (i = 0; i < sizeof speeds / sizeof *speeds; ++i) {
        CHECK_INT(dp_serial_open(&pair.port, pair.device, speeds[i]), DP_RC_SUCCESS);
        CHECK_INT(ioctl(dp_serial_handle(&pair.port), GET_SETTINGS, &got), 0);
        CHECK_INT(got.ospeed, speeds[i]);
        CHECK_INT(got.ispeed, speeds[i]);
        CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    }
    if (sizeof(long) > 4) {
        /* Not its lowest 32 bits. */
        CHECK_INT(dp_serial_open(&pair.port, pair.device, (1UL << 31) * 2 + 9600), DP_RC_DEVICE);
        check_error(&pair.port, pair.device, ": can't be set to 4294976896 baud 8N1");
    }

    /* 3 MHz divided by whole numbers are within 2 % of the slower ones. */
    driver.clock = 3000000;
    for (i = 0; i < 5; ++i) {
        CHECK_INT(dp_serial_open(&pair.port, pair.device, speeds[i]), DP_RC_SUCCESS);
        CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    }
    CHECK_INT(dp_serial_open(&pair.port, pair.device, 921600), DP_RC_DEVICE); /* 8 % too fast */
    check_error(&pair.port, pair.device, ": can't be set to 921600 baud 8N1");
    driver.clock = 0;
    close(pair.far_end);
}

static void lines_are_set(void)
{
    static const int BOTH = TIOCM_DTR | TIOCM_RTS;
    static const struct {
        int dtr, rts, changes, lines;
    } cases[] = {
        {0, 0, 0, TIOCM_DTR | TIOCM_RTS},
        {DP_SERIAL_ON, DP_SERIAL_ON, 0, TIOCM_DTR | TIOCM_RTS},
        {DP_SERIAL_OFF, 0, 1, TIOCM_RTS},
        {0, DP_SERIAL_OFF, 1, TIOCM_DTR},
        {DP_SERIAL_OFF, DP_SERIAL_OFF, 1, 0}, /* both at once */
    };
    struct pair pair;
    struct dp_serial_settings settings;
    size_t i;

    make_pty(&pair);
    memset(&settings, 0, sizeof settings);
    driver.has_lines = 1;
    for (i = 0; i < sizeof cases / sizeof *cases; ++i) {
        driver.lines = BOTH | TIOCM_CTS; /* as the system opens it */
        driver.change_count = 0;
        settings.dtr = cases[i].dtr;
        settings.rts = cases[i].rts;
        CHECK_INT(dp_serial_open_with(&pair.port, pair.device, &settings), DP_RC_SUCCESS);
        CHECK(driver.is_exclusive);
        CHECK_INT(driver.change_count, cases[i].changes);
        CHECK_INT(driver.lines & BOTH, cases[i].lines);
        CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
        CHECK(!driver.is_exclusive);
    }

    driver.lines = TIOCM_DTR;
    CHECK_INT(dp_serial_open_with(&pair.port, pair.device, NULL), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_set_rts(&pair.port, 1), DP_RC_SUCCESS);
    CHECK_INT(driver.lines, BOTH);
    CHECK_INT(dp_serial_set_dtr(&pair.port, DP_SERIAL_OFF), DP_RC_SUCCESS);
    CHECK_INT(driver.lines, TIOCM_RTS);
    CHECK_INT(dp_serial_set_rts(&pair.port, 0), DP_RC_SUCCESS);
    CHECK_INT(driver.lines, 0);
    CHECK_INT(dp_serial_set_dtr(&pair.port, DP_SERIAL_ON), DP_RC_SUCCESS);
    CHECK_INT(driver.lines, TIOCM_DTR);
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK_INT(driver.lines, TIOCM_DTR);
    driver.has_lines = 0;
    close(pair.far_end);
}

static void closing_can_keep_the_lines(void)
{
    struct pair pair;
    struct termios serial_port;
    struct dp_serial_settings settings;

    make_pty(&pair);
    memset(&settings, 0, sizeof settings);
    CHECK_INT(dp_serial_open_with(&pair.port, pair.device, &settings), DP_RC_SUCCESS);
    CHECK_INT(tcgetattr(dp_serial_handle(&pair.port), &serial_port), 0);
    serial_port.c_cflag |= HUPCL; /* which pseudo-terminals don't have to begin with */
    CHECK_INT(tcsetattr(dp_serial_handle(&pair.port), TCSANOW, &serial_port), 0);
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_open_with(&pair.port, pair.device, &settings), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK(!driver.keeps_lines);
    settings.keep_lines = 1;
    CHECK_INT(dp_serial_open_with(&pair.port, pair.device, &settings), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK(driver.keeps_lines);
    CHECK_INT(dp_serial_open(&pair.port, pair.device, 0), DP_RC_SUCCESS); /* as it was found */
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK(driver.keeps_lines);
    close(pair.far_end);
}
#endif

/* Asked for when opening they are ignored, so that a simulator passes for a board. */
static void a_pseudo_terminal_has_no_lines(void)
{
    struct pair pair;
    struct dp_serial_settings settings;

    make_pty(&pair);
    memset(&settings, 0, sizeof settings);
    settings.dtr = DP_SERIAL_OFF;
    settings.rts = DP_SERIAL_ON;
    CHECK_INT(dp_serial_open_with(&pair.port, pair.device, &settings), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_set_dtr(&pair.port, 1), DP_RC_DEVICE);
    check_error(&pair.port, pair.device, ": has no such line");
    CHECK_INT(dp_serial_set_rts(&pair.port, 0), DP_RC_DEVICE);
    disconnect_pair(&pair);
    CHECK_INT(dp_serial_set_dtr(&pair.port, 1), DP_RC_ERROR_GENERIC);
}

static void bytes_pass_as_they_are(void)
{
    struct pair pair;
    unsigned char all[256], got[300];
    int i, count = 0;

    connect_pair(&pair);
    for (i = 0; i < 256; ++i)
        all[i] = (unsigned char)i;
    CHECK_INT(dp_serial_write(&pair.port, all, 256, 1000), 256);
    CHECK_INT(dp_serial_drain(&pair.port), DP_RC_SUCCESS);
    for (count = 0; count < 256;) {
        ssize_t part = read(pair.far_end, got + count, (size_t)(300 - count));
        if (!CHECK(part > 0))
            break;
        count += (int)part;
    }
    CHECK_BYTES(got, all, 256);
    CHECK_INT(write(pair.far_end, all, 256), 256);
    for (count = 0; count < 256;) {
        int part = dp_serial_read(&pair.port, got + count, 100, 1000);
        if (!CHECK(part > 0 && part <= 100))
            break;
        count += part;
    }
    CHECK_BYTES(got, all, 256);

    CHECK_INT(write(pair.far_end, all, 256), 256);
    while (poll(&(struct pollfd){dp_serial_handle(&pair.port), POLLIN, 0}, 1, 1000) == 0)
        ;
    CHECK_INT(dp_serial_discard(&pair.port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_read(&pair.port, got, 100, 50), 0);
    disconnect_pair(&pair);
}

static void messages_are_sent(void)
{
    struct pair pair;
    struct protocol_msg msg;
    char got[5];

    connect_pair(&pair);
    memset(&msg, 0, sizeof msg);
    msg.opcode = DP_OPCODE_STATUS;
    CHECK_INT(dp_send(&msg, dp_serial_send, &pair.port), DP_RC_SUCCESS);
    CHECK_INT(read(pair.far_end, got, 5), 5);
    CHECK_BYTES(got, "$S\0\xB1:", 5);
    disconnect_pair(&pair);
    CHECK_INT(dp_send(&msg, dp_serial_send, &pair.port), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_send(&msg, dp_serial_send, NULL), DP_RC_ERROR_GENERIC);
}

static void the_device_is_exclusive(void)
{
    struct pair pair;
    struct dp_serial second;
    struct termios before, after;

    connect_pair(&pair);
    CHECK_INT(tcgetattr(dp_serial_handle(&pair.port), &before), 0);
    CHECK_INT(dp_serial_open(&second, pair.device, 9600), DP_RC_DEVICE);
    check_error(&second, pair.device, ": in use by another program");
    CHECK_INT(dp_serial_read(&second, &before, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(tcgetattr(dp_serial_handle(&pair.port), &after), 0);
    CHECK_INT(cfgetospeed(&after), B115200); /* who was refused has changed nothing */
    CHECK_INT(dp_serial_close(&pair.port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_open(&second, pair.device, 9600), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_close(&second), DP_RC_SUCCESS);
    close(pair.far_end);
}

/* The device is free again when who used it was killed. */
static void a_killed_program_leaves_the_device_open_to_others(void)
{
    struct pair pair;
    int ready[2];
    char byte;
    pid_t child;

    make_pty(&pair);
    CHECK_INT(pipe(ready), 0);
    child = fork();
    if (child == 0) {
        if (dp_serial_open(&pair.port, pair.device, 0) == DP_RC_SUCCESS && write(ready[1], "", 1) == 1)
            pause();
        _exit(1);
    }
    close(ready[1]);
    CHECK_INT(read(ready[0], &byte, 1), 1);
    CHECK_INT(dp_serial_open(&pair.port, pair.device, 0), DP_RC_DEVICE);
    kill(child, SIGKILL);
    CHECK_INT(waitpid(child, NULL, 0), child);
    CHECK_INT(dp_serial_open(&pair.port, pair.device, 0), DP_RC_SUCCESS);
    close(ready[0]);
    disconnect_pair(&pair);
}

static void reading_ends_in_time(void)
{
    static const long waits[] = {0, 1, 150};
    struct pair pair;
    char byte;
    size_t i;

    connect_pair(&pair);
    for (i = 0; i < sizeof waits / sizeof *waits; ++i) {
        unsigned long began = now_ms();
        long took;
        CHECK_INT(dp_serial_read(&pair.port, &byte, 1, waits[i]), 0);
        took = (long)(now_ms() - began);
        CHECK(took >= waits[i] - 1 && took < waits[i] + 5000);
    }
    CHECK_INT(write(pair.far_end, "x", 1), 1);
    CHECK_INT(dp_serial_read(&pair.port, &byte, 1, -1), 1);
    CHECK_INT(byte, 'x');
    CHECK_INT(dp_serial_read(&pair.port, &byte, 0, -1), 0);
    disconnect_pair(&pair);
}

static void on_alarm(int number)
{
    (void)number;
}

static void handle_alarms(long interval_us)
{
    struct sigaction action;
    struct itimerval timer;

    memset(&action, 0, sizeof action);
    action.sa_handler = on_alarm;
    CHECK_INT(sigaction(SIGALRM, &action, NULL), 0);
    memset(&timer, 0, sizeof timer);
    timer.it_value.tv_usec = timer.it_interval.tv_usec = interval_us;
    CHECK_INT(setitimer(ITIMER_REAL, &timer, NULL), 0);
}

static void a_signal_ends_reading(void)
{
    struct pair pair;
    char byte;

    connect_pair(&pair);
    handle_alarms(20000);
    CHECK_INT(dp_serial_read(&pair.port, &byte, 1, -1), 0);
    handle_alarms(0);
    disconnect_pair(&pair);
}

static void fill(char *bytes, int count)
{
    int i;
    for (i = 0; i < count; ++i)
        bytes[i] = (char)(i * 31 + (i >> 8));
}

/* Reads a little at a time, and compares. */
static void *slow_reader(void *usr)
{
    const struct pair *pair = usr;
    static char expected[MEGABYTE], got[MEGABYTE];
    int count = 0;

    fill(expected, MEGABYTE);
    while (count < MEGABYTE) {
        size_t rest = (size_t)(MEGABYTE - count);
        ssize_t part = read(pair->far_end, got + count, rest < 3001 ? rest : 3001);
        if (part < 0 && errno == EINTR)
            continue;
        if (part <= 0)
            break;
        count += (int)part;
        if (count % 64 == 0)
            usleep(1000);
    }
    return count == MEGABYTE && memcmp(got, expected, MEGABYTE) == 0 ? usr : NULL;
}

/* With signals coming in, and in pieces: nothing is lost or sent twice. */
static void a_megabyte_goes_through_a_slow_reader(void)
{
    static char bytes[MEGABYTE];
    struct pair pair;
    pthread_t reader;
    sigset_t alarms;
    void *result = NULL;

    connect_pair(&pair);
    fill(bytes, MEGABYTE);
    /* The signals are for this thread alone. */
    sigemptyset(&alarms);
    sigaddset(&alarms, SIGALRM);
    pthread_sigmask(SIG_BLOCK, &alarms, NULL);
    CHECK_INT(pthread_create(&reader, NULL, slow_reader, &pair), 0);
    pthread_sigmask(SIG_UNBLOCK, &alarms, NULL);
    handle_alarms(3000);
    CHECK_INT(dp_serial_write(&pair.port, bytes, MEGABYTE, 60000), MEGABYTE);
    handle_alarms(0);
    pthread_join(reader, &result);
    CHECK(result != NULL);
    disconnect_pair(&pair);
}

static void writing_ends_in_time(void)
{
    static char bytes[MEGABYTE];
    struct pair pair;
    unsigned long began = now_ms();
    int written;

    connect_pair(&pair);
    handle_alarms(20000); /* which end no waiting */
    written = dp_serial_write(&pair.port, bytes, MEGABYTE, 150);
    handle_alarms(0);
    CHECK(written > 0 && written < MEGABYTE);
    CHECK(now_ms() - began >= 149 && now_ms() - began < 5000);
    CHECK_INT(dp_serial_write(&pair.port, bytes, 1, 0), 0);
    CHECK_INT(dp_serial_send(bytes, MEGABYTE, &pair.port), DP_RC_DEVICE);
    check_error(&pair.port, pair.device, ": no bytes were taken in time");
    CHECK_INT(tcflush(dp_serial_handle(&pair.port), TCOFLUSH), 0);
    disconnect_pair(&pair);
}

static void a_device_that_disappears_is_an_error(void)
{
    static char bytes[MEGABYTE];
    struct pair pair;
    int i;

    connect_pair(&pair);
    close(pair.far_end);
    pair.far_end = -1;
    for (i = 0; i < 3; ++i) {
        CHECK_INT(dp_serial_read(&pair.port, bytes, 10, -1), -DP_RC_DEVICE);
        check_error(&pair.port, pair.device, ": disconnected");
        CHECK_INT(dp_serial_write(&pair.port, bytes, MEGABYTE, -1), -DP_RC_DEVICE);
        check_error(&pair.port, pair.device, ": disconnected");
    }
    CHECK_INT(dp_serial_send(bytes, 5, &pair.port), DP_RC_DEVICE);
    disconnect_pair(&pair);
}

static void *disappear_soon(void *usr)
{
    struct pair *pair = usr;
    usleep(100000);
    close(pair->far_end);
    return NULL;
}

static void a_device_that_disappears_meanwhile_is_an_error(void)
{
    static char bytes[MEGABYTE];
    int writing;

    for (writing = 0; writing < 2; ++writing) {
        struct pair pair;
        pthread_t thread;

        connect_pair(&pair);
        CHECK_INT(pthread_create(&thread, NULL, disappear_soon, &pair), 0);
        if (writing)
            CHECK_INT(dp_serial_write(&pair.port, bytes, MEGABYTE, -1), -DP_RC_DEVICE);
        else
            CHECK_INT(dp_serial_read(&pair.port, bytes, 10, -1), -DP_RC_DEVICE);
        check_error(&pair.port, pair.device, ": disconnected");
        pthread_join(thread, NULL);
        pair.far_end = -1;
        disconnect_pair(&pair);
    }
}

static void what_is_no_serial_port(const char *program)
{
    static const char *const missing = "/nonexistent/tty/with/a/long/name/of/many/characters";
    struct dp_serial port;
    char long_name[2000];

    CHECK_INT(dp_serial_open(&port, missing, 0), DP_RC_DEVICE);
    check_error(&port, missing, ": No such file or directory");
    CHECK_INT(dp_serial_open(&port, "/dev/null", 0), DP_RC_DEVICE);
    check_error(&port, "/dev/null", ": not a serial port");
    CHECK_INT(dp_serial_open(&port, "/", 0), DP_RC_DEVICE);
    check_error(&port, "/", ": not a serial port");
    if (access(program, W_OK) == 0) {
        CHECK_INT(dp_serial_open(&port, program, 0), DP_RC_DEVICE);
        check_error(&port, program, ": not a serial port");
    }
    memset(long_name, 'x', sizeof long_name);
    long_name[sizeof long_name - 1] = '\0';
    CHECK_INT(dp_serial_open(&port, long_name, 0), DP_RC_DEVICE);
    check_error(&port, "...xxx", "xxx: File name too long");
    CHECK_INT(dp_serial_open(&port, "", 0), DP_RC_DEVICE);
    check_error(&port, "", "No such file or directory");
}

static void nulls_and_negative_sizes(void)
{
    struct pair pair;
    char byte = 0;
    struct dp_serial zero;

    CHECK_INT(dp_serial_open(NULL, "/dev/null", 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_open(&zero, NULL, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(&zero, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(NULL, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_write(NULL, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_send(&byte, 1, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_open_with(NULL, "/dev/null", NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_open_with(&zero, NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_drain(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_set_dtr(NULL, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_set_rts(NULL, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_handle(NULL), -1);
    CHECK_INT(dp_serial_discard(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_close(NULL), DP_RC_ERROR_GENERIC);
    CHECK(dp_serial_error(NULL)[0] == '\0');

    /* All zero is a closed port, not standard input. */
    memset(&zero, 0, sizeof zero);
    CHECK_INT(dp_serial_read(&zero, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_write(&zero, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_drain(&zero), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_discard(&zero), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_set_dtr(&zero, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_handle(&zero), -1);
    CHECK(dp_serial_error(&zero)[0] == '\0');
    CHECK_INT(dp_serial_close(&zero), DP_RC_SUCCESS);
    CHECK(fcntl(STDIN_FILENO, F_GETFD) != -1);

    connect_pair(&pair);
    CHECK_INT(dp_serial_read(&pair.port, NULL, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(&pair.port, &byte, -1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(&pair.port, &byte, INT_MIN, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(&pair.port, NULL, 0, 0), 0);
    CHECK_INT(dp_serial_write(&pair.port, NULL, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_write(&pair.port, &byte, -1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_write(&pair.port, NULL, 0, 0), 0);
    CHECK_INT(dp_serial_send(NULL, 1, &pair.port), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_send(NULL, 0, &pair.port), DP_RC_SUCCESS);
    disconnect_pair(&pair);
}

int main(int argc, char **argv)
{
    (void)argc;
    layout();
    settings_are_those_of_the_link();
#if defined(__linux__) && defined(__GLIBC__)
    any_speed_can_be_had();
    lines_are_set();
    closing_can_keep_the_lines();
#endif
    a_pseudo_terminal_has_no_lines();
    bytes_pass_as_they_are();
    messages_are_sent();
    the_device_is_exclusive();
    a_killed_program_leaves_the_device_open_to_others();
    reading_ends_in_time();
    a_signal_ends_reading();
    a_megabyte_goes_through_a_slow_reader();
    writing_ends_in_time();
    a_device_that_disappears_is_an_error();
    a_device_that_disappears_meanwhile_is_an_error();
    what_is_no_serial_port(argv[0]);
    nulls_and_negative_sizes();
    return check_summary("serial");
}
