/*
 * pc DEVICE: a PC program that works with the devices of device.c: waits for them to sign in, settles the link,
 * switches, heats, watches, and meets with errors. Prints each line of either side in words, and checks that everything
 * goes as it should. Exit status 0 if it did, 1 if not, 2 when there is no line.
 */
#define _XOPEN_SOURCE 700
#include "libdeltarobot/line_host.h"
#include "libdeltarobot/serial.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static struct olp_host session;
static struct dp_serial port;
static unsigned long began;
static int expected, failed;
static struct olp_receiver sent, heard; /* for printing */

/* Commands to have unanswered. */
#define AT_ONCE (OLP_WINDOW_MAX < 4 ? OLP_WINDOW_MAX : 4)

/* What the devices have told. */
static struct {
    int gone, devices, reports, presses, errors, ended[16];
    float temperature;
    char heater[OLP_HOST_ID_MAX + 1], fan[OLP_HOST_ID_MAX + 1];
} seen;

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000 - began;
}

/* Lines in words. */

static int is_event_of_link(const char *name)
{
    return strcmp(name, "welcome") == 0 || strcmp(name, "ack") == 0 || strcmp(name, "onerror") == 0;
}

static void print(const char *arrow, const struct olp_line *line)
{
    struct olp_message message;
    char name[64] = "", id[64] = "";
    const char *separator = ":";
    size_t length;
    int i;

    printf("%6.3f %s ", (double)now_ms() / 1000, arrow);
    if (line->kind != OLP_LINE_COMPLETE || olp_parse(line->text, line->length, &message) != OLP_RC_SUCCESS) {
        printf("something unreadable\n");
        return;
    }
    olp_get_string(&message, "c", 0, name, sizeof name);
    olp_get_string(&message, "id", 0, id, sizeof id);
    length = strlen(name);
    if (length > 5 && strcmp(name + length - 5, "_resp") == 0)
        printf("answer to %.*s from %s", (int)length - 5, name, id);
    else if (*arrow == '-')
        printf("command %s to %s", name, id);
    else if (is_event_of_link(name))
        printf("%s from %s", name, id);
    else
        printf("event %s from %s", name, id);
    for (i = 1; i < message.count; ++i) {
        struct olp_param param;
        char text[128];

        olp_param_at(&message, i, &param);
        if (param.name_length == 2 && memcmp(param.name, "id", 2) == 0)
            continue;
        if (param.name_length == 1 && param.name[0] == 's')
            continue;
        if (olp_value_string(&param, text, sizeof text) < 0)
            strcpy(text, "...");
        printf("%s %.*s %s", separator, param.name_length, param.name, text);
        separator = ",";
    }
    if (message.checksum != OLP_CHECKSUM_NONE)
        printf(", checksum %s", message.checksum == OLP_CHECKSUM_RIGHT ? "right" : "wrong");
    printf("\n");
}

static void print_all(const char *arrow, struct olp_receiver *lines, const char *bytes, int count)
{
    struct olp_line line;

    while (count > 0) {
        int taken = olp_receive(lines, bytes, count, &line);
        if (line.kind != OLP_LINE_NONE)
            print(arrow, &line);
        bytes += taken;
        count -= taken;
    }
}

/* The session. */

static void handle(const struct olp_host_event *event)
{
    struct olp_host_device device;
    long pressed;

    switch (event->kind) {
    case OLP_HOST_WELCOME:
        if (olp_host_get_device(&session, event->device, &device) != OLP_RC_SUCCESS)
            break;
        ++seen.devices;
        if (strcmp(device.type, "OzekiTemperatureController") == 0)
            strcpy(seen.heater, device.id);
        if (strcmp(device.type, "OzekiSwitchController") == 0)
            strcpy(seen.fan, device.id);
        break;
    case OLP_HOST_ENDED:
        seen.ended[event->handle % 16] = event->outcome;
        break;
    case OLP_HOST_ERROR:
        ++seen.errors;
        break;
    case OLP_HOST_LINE:
        if (olp_is(&event->message, "c", 0, "heaterinfo")) {
            ++seen.reports;
            olp_get_float(&event->message, "temp", 0, &seen.temperature);
        }
        if (olp_is(&event->message, "c", 0, "button") &&
            olp_get_int(&event->message, "pressed", 0, &pressed) == OLP_RC_SUCCESS)
            seen.presses += pressed != 0;
        break;
    default:
        break;
    }
}

/* Runs the session until `done` says so, at most so long. */
static int run_until(int (*done)(void), unsigned long limit_ms)
{
    static char in[256];
    static int got, taken;
    unsigned long start = now_ms();

    for (;;) {
        struct olp_host_event event;
        char out[256];
        long wait;
        int count;

        while (olp_host_poll(&session, now_ms(), &event) == OLP_RC_SUCCESS)
            handle(&event);
        while ((count = olp_host_output(&session, out, sizeof out, now_ms())) > 0) {
            print_all("->", &sent, out, count);
            seen.gone |= dp_serial_write(&port, out, count, 1000) != count;
        }
        if (seen.gone || now_ms() - start >= limit_ms)
            return 0;
        if (taken == got) {
            if (done())
                return 1;
            wait = olp_host_next_deadline(&session, now_ms());
            taken = 0;
            got = dp_serial_read(&port, in, sizeof in, wait < 0 || wait > 50 ? 50 : wait);
            if (got < 0) {
                got = 0;
                seen.gone = 1;
            }
            print_all("<-", &heard, in, got);
        }
        taken += olp_host_receive(&session, in + taken, got - taken, now_ms());
    }
}

static void expect(int ok, const char *what)
{
    ++expected;
    if (!ok) {
        ++failed;
        printf("%6.3f !! expected %s\n", (double)now_ms() / 1000, what);
    }
}

static int order(const char *id, const char *command)
{
    int handle = olp_host_send(&session, command, (int)strlen(command), id);

    if (handle > 0)
        seen.ended[handle % 16] = 0;
    return handle;
}

static int awaited[4], awaited_count;

static int all_ended(void)
{
    int i;
    for (i = 0; i < awaited_count; ++i)
        if (seen.ended[awaited[i] % 16] == 0)
            return 0;
    return 1;
}

static void expect_end(int handle, int outcome, const char *what)
{
    if (handle > 0) {
        awaited[0] = handle;
        awaited_count = 1;
        run_until(all_ended, 3000);
    }
    expect(handle > 0 && seen.ended[handle % 16] == outcome, what);
}

static int setup(int ack, int checksum, long window)
{
    int handle = olp_host_setup(&session, seen.fan, ack, checksum, window);

    if (handle > 0)
        seen.ended[handle % 16] = 0;
    return handle;
}

static void title(const char *text)
{
    printf("\n%s\n", text);
}

static int three_devices(void)
{
    return seen.devices >= 3;
}

static int three_reports(void)
{
    return seen.reports >= 3;
}

static int is_warm(void)
{
    return seen.temperature >= 50;
}

static int two_presses(void)
{
    return seen.presses >= 2;
}

static int one_error(void)
{
    return seen.errors >= 1;
}

static void converse(void)
{
    static const char DAMAGED[] = "c=setswitch&state=1&t=200&id=9o5qzg&s=0000\n";
    struct olp_host_link in_force;
    int i;

    title("The devices sign in.");
    expect(run_until(three_devices, 2000), "three devices");
    expect(seen.heater[0] != '\0' && seen.fan[0] != '\0', "a heater and a switch");
    if (failed)
        return;

    title("The link is settled: acks and checksums, and then a window of several commands.");
    expect_end(setup(1, 1, -1), OLP_HOST_ANSWERED, "acks and checksums");
    expect_end(setup(-1, -1, AT_ONCE), OLP_HOST_ANSWERED, "a window");
    olp_host_get_link(&session, &in_force);
    expect(in_force.ack && in_force.checksum && in_force.windowsize == AT_ONCE, "all of this in force");

    title("The heater shall tell its temperature every 150 ms.");
    expect_end(order(seen.heater, "c=setpushinfo&interval=150&state=1"), OLP_HOST_ANSWERED, "setpushinfo carried out");
    expect(run_until(three_reports, 2000), "three reports");

    title("Several commands to the switch at once.");
    for (i = 0; i < AT_ONCE; ++i)
        awaited[i] = order(seen.fan, i % 2 ? "c=setswitch&state=0" : "c=setswitch&state=1&pwm=128");
    awaited_count = AT_ONCE;
    expect(run_until(all_ended, 3000), "all to end");
    for (i = 0; i < AT_ONCE; ++i)
        expect(awaited[i] > 0 && seen.ended[awaited[i] % 16] == OLP_HOST_ANSWERED, "setswitch carried out");

    title("A command that no switch knows, and one with a value it refuses.");
    expect_end(order(seen.fan, "c=setcolour&rgb=112233"), OLP_HOST_REFUSED, "setcolour refused");
    expect_end(order(seen.fan, "c=setswitch&state=7"), OLP_HOST_REFUSED, "setswitch refused");

    title("A line that is damaged on its way is not carried out.");
    seen.errors = 0;
    print_all("->", &sent, DAMAGED, sizeof DAMAGED - 1);
    expect(dp_serial_write(&port, DAMAGED, sizeof DAMAGED - 1, 1000) == (int)sizeof DAMAGED - 1, "the line written");
    expect(run_until(one_error, 1000), "an error reported");

    title("Heating.");
    expect_end(order(seen.heater, "c=settemp&temp=50"), OLP_HOST_ANSWERED, "settemp carried out");
    expect(run_until(is_warm, 4000), "50 degrees");
    expect_end(order(seen.heater, "c=settemp&temp=-1000"), OLP_HOST_ANSWERED, "settemp carried out");
    expect_end(order(seen.heater, "c=setpushinfo&interval=150&state=0"), OLP_HOST_ANSWERED, "setpushinfo carried out");

    title("Somebody presses the button.");
    seen.presses = 0;
    expect(run_until(two_presses, 4000), "the button pressed twice");
}

int main(int argc, char **argv)
{
    struct olp_host_health health;

    if (argc != 2) {
        fprintf(stderr, "usage: pc DEVICE\n");
        return 2;
    }
    if (dp_serial_open(&port, argv[1], DP_SERIAL_BAUD) != DP_RC_SUCCESS) {
        fprintf(stderr, "pc: %s\n", dp_serial_error(&port));
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, 0);
    began = now_ms();
    olp_host_init(&session, NULL);
    converse();
    olp_host_get_health(&session, &health);
    expect(health.lost == 0 && health.overlong == 0 && health.malformed == 0, "no line lost");
    printf("\n%lu lines received, %lu commands repeated, %lu lines lost, %lu ms for the slowest round trip, in %.1f s; "
           "%d expectations, %d not met: %s\n",
           health.lines, health.repeats, health.lost, health.rtt_max, (double)now_ms() / 1000, expected, failed,
           failed ? "FAILED" : "all as expected");
    dp_serial_close(&port);
    return failed ? 1 : 0;
}
