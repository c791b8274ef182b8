/*
 * A sketch on line_device.h: a heater that tells its temperature, and a switch. What it takes of the controller, beside
 * what the board alone takes (-DBOARD_ONLY), is what the library costs a sketch.
 */
#include "../../examples/firmware/board.h"

#ifdef BOARD_ONLY

int main(void)
{
    board_init();
    for (;;) {
        int byte = board_uart_read();
        if (byte >= 0 && board_ms() != 0)
            board_uart_write((unsigned char)byte);
    }
}

#else

#include <libdeltarobot/line_device.h>

#include <stddef.h>

#define HEATER "M1F910"
#define SWITCH "9o5qzg"
#define PUSH_MS 50u

static struct olp_device device;
static unsigned char switched;

int main(void);
int setswitch(const struct olp_message *command, struct olp_encoder *answer, void *usr);
int send_line(const void *line, int bytes, void *usr);

int setswitch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    long state;

    (void)usr;
    if (olp_get_int(command, "state", 0, &state) != OLP_RC_SUCCESS)
        return 1;
    switched = state != 0;
    olp_add_int(answer, "state", switched);
    olp_add_int(answer, "pwm", 254);
    return 0;
}

int send_line(const void *line, int bytes, void *usr)
{
    const unsigned char *byte = line;
    int i;

    (void)usr;
    for (i = 0; i < bytes; ++i)
        while (!board_uart_write(byte[i]))
            ;
    return bytes;
}

/* In hundredths: a sketch without floating point. */
static void add_hundredths(struct olp_encoder *event, const char *name, int value)
{
    char text[8];
    int at = sizeof text - 1, digits = 0;
    unsigned int rest = value < 0 ? 0u - (unsigned int)value : (unsigned int)value;

    text[at] = '\0';
    do {
        text[--at] = (char)('0' + rest % 10);
        rest /= 10;
        if (++digits == 2)
            text[--at] = '.';
    } while ((rest > 0 || digits < 3) && at > 1);
    if (value < 0)
        text[--at] = '-';
    olp_add_string(event, name, text + at);
}

static void send_heater_info(void)
{
    char line[72];
    struct olp_encoder event;

    olp_begin(&event, line, sizeof line, "heaterinfo");
#ifdef WITH_FLOATS
    olp_add_float(&event, "temp", (float)(20 + switched), 2);
    (void)add_hundredths;
#else
    add_hundredths(&event, "temp", 2000 + switched * 100);
#endif
    olp_add_int(&event, "state", switched);
    olp_device_event(&device, &event, HEATER);
}

/* What is not changed need not be in RAM on other controllers than this. */
static const struct olp_device_info DEVICES[] = {
    {HEATER, "OzekiTemperatureController", 1, NULL, NULL},
    {SWITCH, "OzekiSwitchController", 2, NULL, NULL},
};
static const struct olp_command COMMANDS[] = {{SWITCH, "setswitch", setswitch}};
static const struct olp_device_table TABLE = {DEVICES, 2, COMMANDS, 1, send_line, 0};

int main(void)
{
    unsigned long now = 0, pushed_at = 0;
    int byte = -1;

    board_init();
    olp_device_init(&device, &TABLE, NULL);
    olp_device_linksetup(&device, 1, 1, 1);
    for (;;) {
        now += (unsigned int)(board_ms() - (unsigned int)now);
        if (byte < 0)
            byte = board_uart_read();
        if (byte >= 0) {
            unsigned char received = (unsigned char)byte;
            if (olp_device_receive(&device, &received, 1, now) > 0)
                byte = -1;
        }
        olp_device_poll(&device, now);
        if (now - pushed_at >= PUSH_MS) {
            pushed_at = now;
            send_heater_info();
        }
    }
}

#endif
