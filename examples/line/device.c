/*
 * device: a heater, a switch and a button behind one serial line, whose other end is this program's standard input and
 * output. Firmware looks like this too, but for the part at the end.
 *
 * Like a microcontroller whose port is opened it starts when somebody opens the line; it ends, with status 0, when
 * nobody has it open any more.
 */
#define _XOPEN_SOURCE 700
#include "libdeltarobot/line_device.h"

#include <poll.h>
#include <stddef.h>
#include <time.h>
#include <unistd.h>

#define HEATER "M1F910"
#define SWITCH "9o5qzg"
#define BUTTON "3Mx14T"

#define ROOM_TEMPERATURE 20.0f
#define HEATER_MAX 250.0f
#define NO_TEMPERATURE (-1000.0f)
#define STEP_MS 10ul

static unsigned long now_ms(void);
static int send_line(const void *line, int bytes, void *usr);

struct board {
    struct olp_device link;
    /* Heater. */
    float temperature, desired;
    int heats, pushes;
    unsigned long push_ms, pushed_at, stepped_at;
    /* Switch. */
    long on, pwm;
    /* Button, which somebody presses for half a second every second. */
    int pressed;
    unsigned long started_at;
};

/* What the PC may order. */

static int setpushinfo(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    struct board *board = usr;
    long interval, state;

    if (olp_get_int(command, "interval", 0, &interval) != OLP_RC_SUCCESS || interval < 10 || interval > 60000)
        return 1;
    if (olp_get_int(command, "state", 0, &state) != OLP_RC_SUCCESS)
        return 1;
    board->push_ms = (unsigned long)interval;
    board->pushes = state != 0;
    board->pushed_at = now_ms();
    olp_add_int(answer, "state", board->pushes);
    olp_add_int(answer, "interval", interval);
    return 0;
}

static int settemp(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    struct board *board = usr;
    float desired;

    if (olp_get_float(command, "temp", 0, &desired) != OLP_RC_SUCCESS || desired > HEATER_MAX)
        return 1;
    board->desired = desired;
    olp_add_float(answer, "temp", desired, 2);
    return 0;
}

static int setswitch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    struct board *board = usr;
    long on, pwm;

    if (olp_get_int(command, "state", 0, &on) != OLP_RC_SUCCESS || on < 0 || on > 1)
        return 1;
    if (olp_get_int(command, "pwm", 0, &pwm) == OLP_RC_SUCCESS && pwm >= 0 && pwm <= 255)
        board->pwm = pwm;
    board->on = on;
    olp_add_int(answer, "state", board->on);
    olp_add_int(answer, "pwm", board->pwm);
    return 0;
}

static const struct olp_device_info DEVICES[] = {
    {HEATER, "OzekiTemperatureController", 1, "HeaterExt1", "1.0.0"},
    {SWITCH, "OzekiSwitchController", 2, "FanExt1", "1.0.0"},
    {BUTTON, "OzekiButtonController", 3, "StopYmin", "1.0.0"},
};
static const struct olp_command COMMANDS[] = {
    {HEATER, "setpushinfo", setpushinfo},
    {HEATER, "settemp", settemp},
    {SWITCH, "setswitch", setswitch},
};
#define COUNT(array) (int)(sizeof(array) / sizeof *(array))
static const struct olp_device_table TABLE = {DEVICES, COUNT(DEVICES), COMMANDS, COUNT(COMMANDS), send_line, 0};

/* What happens by itself. */

static void send_heater_info(struct board *board)
{
    char line[OLP_REPLY_MAX];
    struct olp_encoder event;

    olp_begin(&event, line, sizeof line, "heaterinfo");
    olp_add_float(&event, "temp", board->temperature, 2);
    olp_add_float(&event, "desiredtemp", board->desired, 2);
    olp_add_int(&event, "state", board->heats);
    olp_device_event(&board->link, &event, HEATER);
}

static void run_heater(struct board *board, unsigned long now)
{
    while (now - board->stepped_at >= STEP_MS) {
        float goal;

        board->stepped_at += STEP_MS;
        board->heats = board->temperature < board->desired;
        goal = board->heats ? HEATER_MAX : ROOM_TEMPERATURE;
        board->temperature += (goal - board->temperature) * 0.002f;
    }
    if (board->pushes && now - board->pushed_at >= board->push_ms) {
        board->pushed_at += board->push_ms;
        send_heater_info(board);
    }
}

static void run_button(struct board *board, unsigned long now)
{
    int pressed = (now - board->started_at) / 500 % 2 == 1;

    if (pressed != board->pressed) {
        char line[OLP_REPLY_MAX];
        struct olp_encoder event;

        board->pressed = pressed;
        olp_begin(&event, line, sizeof line, "button");
        olp_add_int(&event, "pressed", pressed);
        olp_device_event(&board->link, &event, BUTTON);
    }
}

static void start(struct board *board)
{
    unsigned long now = now_ms();

    olp_device_init(&board->link, &TABLE, board);
    board->temperature = ROOM_TEMPERATURE;
    board->desired = NO_TEMPERATURE;
    board->pwm = 254;
    board->started_at = board->stepped_at = now;
}

/* What firmware does in another way: the clock and the line. */

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000;
}

static int send_line(const void *line, int bytes, void *usr)
{
    const char *rest = line;

    (void)usr;
    while (bytes > 0) {
        ssize_t written = write(STDOUT_FILENO, rest, (size_t)bytes);
        if (written <= 0)
            return -1;
        rest += written;
        bytes -= (int)written;
    }
    return 0;
}

/* Waits until there is something to read, or a moment. -1: nobody has the line open. */
static int wait_for_bytes(void)
{
    struct pollfd line = {STDIN_FILENO, POLLIN, 0};

    poll(&line, 1, (int)STEP_MS / 2);
    if (line.revents & POLLIN)
        return 1;
    return line.revents ? -1 : 0;
}

static void sleep_ms(long ms)
{
    struct timespec time = {0, 0};
    time.tv_nsec = ms * 1000000;
    nanosleep(&time, NULL);
}

int main(void)
{
    static struct board board;
    char in[64];
    int got = 0, taken = 0, waited;

    while (wait_for_bytes() < 0)
        sleep_ms(1);
    sleep_ms(100); /* The boot loader's time. Who opened the line may throw away what came before. */
    start(&board);
    while ((waited = wait_for_bytes()) >= 0) {
        if (taken == got && waited > 0) {
            got = (int)read(STDIN_FILENO, in, sizeof in);
            taken = 0;
            if (got <= 0)
                break;
        }
        if (taken < got)
            taken += olp_device_receive(&board.link, in + taken, got - taken, now_ms());
        olp_device_poll(&board.link, now_ms());
        run_heater(&board, now_ms());
        run_button(&board, now_ms());
    }
    return 0;
}
