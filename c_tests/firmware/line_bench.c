/*
 * What a device of the line protocol costs on an AVR, in cycles a byte received: olp_device_receive and olp_device_poll
 * after each byte, as a sketch calls them, without what the UART takes. Prints a table on it, and "done".
 */
#include "bench.h"

#include <libdeltarobot/line_device.h>

#include <string.h>

static struct olp_device device;

int main(void);

static int setswitch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
{
    long state;

    (void)usr;
    if (olp_get_int(command, "state", 0, &state) != OLP_RC_SUCCESS)
        return 1;
    olp_add_int(answer, "state", state);
    return 0;
}

static int send_line(const void *line, int bytes, void *usr)
{
    (void)line;
    (void)usr;
    return bytes;
}

static const struct olp_device_info DEVICES[] = {{"9o5qzg", "OzekiSwitchController", 1, 0, 0}};
static const struct olp_command COMMANDS[] = {{0, "setswitch", setswitch}};
static const struct olp_device_table TABLE = {DEVICES, 1, COMMANDS, 1, send_line, 0};

/* The stream again and again, as bytes that come one by one. */
static void measure(const char *name, const char *stream, unsigned int bytes)
{
    uint32_t sum = 0, longest = 0, began, took, idle;
    unsigned int at, round, count = 0;

    began = ticks();
    idle = ticks() - began;
    olp_device_init(&device, &TABLE, 0);
    olp_device_linksetup(&device, 1, 1, 1);
    while (olp_device_poll(&device, 0) == OLP_RC_SUCCESS)
        ;
    for (round = 0; round < 3; ++round)
        for (at = 0; at < bytes; ++at) {
            began = ticks();
            olp_device_receive(&device, stream + at, 1, round * 10000ul);
            olp_device_poll(&device, round * 10000ul);
            took = ticks() - began - idle;
            sum += took;
            ++count;
            if (took > longest)
                longest = took;
        }
    print(name);
    print(" ");
    print_number(sum / count, 1);
    print(" cycles a byte, at most ");
    print_number(longest, 1);
    print("\n");
}

#define MEASURE(name, stream) measure(name, stream, sizeof(stream) - 1)

int main(void)
{
    static const char inside[] = "c=setswitch&state=1&x=yyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyy";

    board_init();
    clock_init();
    MEASURE("a byte inside a line:          ", inside);
    MEASURE("command, ack and answer:       ", "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\n");
    MEASURE("its repeat:                    ", "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\nc=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\n");
    MEASURE("wrong checksum:                ", "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d7\n");
    MEASURE("a line too long:               ", "yyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyyy\n");
    MEASURE("empty lines:                   ", "\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n");
    MEASURE("lines of a byte:               ", "c\nc\nc\nc\nc\nc\nc\nc\n");
    print("done\n");
    stop();
}
