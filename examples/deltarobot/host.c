/*
 * host DEVICE: a host program. Has a robot home and move, prints every message in words, and checks that each request
 * ends as it should. Exit status 0 if all of them did, 1 if not, 2 when there is no device.
 */
#define _XOPEN_SOURCE 700
#include "libdeltarobot/host.h"
#include "libdeltarobot/protocol_ext.h"
#include "libdeltarobot/serial.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static struct dp_host session;
static struct dp_serial port;
static struct protocol_data sent; /* for printing */
static struct protocol_msg_status_report last;
static unsigned long began;
static int expected, failed;

static unsigned long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (unsigned long)now.tv_sec * 1000 + (unsigned long)now.tv_nsec / 1000000 - began;
}

static void print(const char *arrow, const struct protocol_msg *msg)
{
    char text[DP_MSG_TEXT_MAX];
    dp_msg_format(msg, text, sizeof text);
    printf("%6.3f %s %s\n", (double)now_ms() / 1000, arrow, text);
}

static int print_sent(const struct protocol_msg *msg, void *usr)
{
    (void)usr;
    print("->", msg);
    return 0;
}

static int transmit(const char *bytes, int count)
{
    dp_process_each(&sent, bytes, count, print_sent, NULL);
    return dp_serial_write(&port, bytes, count, 1000) == count ? 0 : -1;
}

/*
 * Runs the session until the request of that opcode has ended, and returns how; -1 when the device is gone. Cancels
 * once arm A is at `cancel_at` or beyond.
 */
static int run(unsigned char opcode, float cancel_at)
{
    char in[64], out[DP_HOST_OUTPUT_MAX];
    int got = 0, taken = 0, count;

    for (;;) {
        struct dp_host_event event;

        while (dp_host_poll(&session, now_ms(), &event) == DP_RC_SUCCESS) {
            if (event.kind == DP_HOST_MESSAGE)
                print("<-", &event.msg);
            if (event.kind == DP_HOST_STATUS)
                last = event.report;
            if (event.kind == DP_HOST_STATUS && event.state == DP_STATUS_MOVING && last.DA >= cancel_at)
                dp_host_cancel(&session);
            if (event.kind == DP_HOST_ENDED && event.opcode == opcode)
                return event.outcome;
        }
        while ((count = dp_host_output(&session, out, sizeof out, now_ms())) > 0)
            if (transmit(out, count) != 0)
                return -1;
        if (taken == got) {
            taken = 0;
            got = dp_serial_read(&port, in, sizeof in, dp_host_next_deadline(&session, now_ms()));
            if (got < 0)
                return -1;
        }
        taken += dp_host_receive(&session, in + taken, got - taken, now_ms());
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

static const char *outcome_name(int outcome)
{
    static const char *const names[] = {"?", "finished", "refused", "failed", "cancelled", "timed out"};
    return outcome >= 0 && outcome <= DP_HOST_TIMED_OUT ? names[outcome] : dp_serial_error(&port);
}

static void expect_end(unsigned char opcode, int wanted, float cancel_at)
{
    int outcome = run(opcode, cancel_at);
    printf("%6.3f    %s %s\n", (double)now_ms() / 1000, dp_opcode_name(opcode), outcome_name(outcome));
    expect(outcome == wanted, outcome_name(wanted));
}

static void status(void)
{
    dp_host_status(&session);
    expect_end(DP_OPCODE_STATUS, DP_HOST_FINISHED, 1e9f);
}

static void home(int wanted)
{
    dp_host_home(&session);
    expect_end(DP_OPCODE_HOMING, wanted, 1e9f);
}

static void move(float a, float b, float c, int wanted, float cancel_at)
{
    struct protocol_msg_position target;
    target.DA = a;
    target.DB = b;
    target.DC = c;
    dp_host_move(&session, &target);
    expect_end(DP_OPCODE_MOVE, wanted, cancel_at);
}

static void title(const char *text)
{
    printf("\n%s\n", text);
}

static int is_at(float a, float b, float c)
{
    return last.DA == a && last.DB == b && last.DC == c;
}

static void converse(void)
{
    title("A robot that was just switched on does not know where its arms are, and refuses to move.");
    status();
    expect(last.DA != last.DA, "an unknown position");
    move(10, 7.5f, 12.5f, DP_HOST_REFUSED, 1e9f);

    title("Homing: the arms go to their end stops.");
    home(DP_HOST_FINISHED);
    status();
    expect(is_at(0, 0, 0), "all arms at their end stops");

    title("A move, with a status report for each step of the encoders.");
    move(10, 7.5f, 12.5f, DP_HOST_FINISHED, 1e9f);
    status();
    expect(is_at(10, 7.5f, 12.5f), "the arms at the target");

    title("Noise that looks like the beginning of a long frame: the request behind it is answered all the same.");
    expect(dp_serial_write(&port, "\xFF:$M\x10", 5, 1000) == 5, "noise on the line");
    status();

    title("A move that is cancelled on its way.");
    move(600, 600, 600, DP_HOST_CANCELLED, 30);
    expect(last.DA > 29 && last.DA < 600, "the arms between start and target");

    title("A move beyond an end stop fails. Shipped firmware stops there and can be homed; by the specification that is an "
          "error, in which everything but a status request is refused.");
    move(-5, 10, 10, DP_HOST_FAILED, 1e9f);
    status();
    home((last.STAT & DP_BIT_STAT_STATUS_BITS) == DP_BIT_STAT_STATUS_ERROR ? DP_HOST_REFUSED : DP_HOST_FINISHED);
    status();
}

int main(int argc, char **argv)
{
    struct dp_host_settings settings;
    struct dp_host_health health;

    if (argc != 2) {
        fprintf(stderr, "usage: host DEVICE\n");
        return 2;
    }
    if (dp_serial_open(&port, argv[1], DP_SERIAL_BAUD) != DP_RC_SUCCESS) {
        fprintf(stderr, "host: %s\n", dp_serial_error(&port));
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, 0);
    memset(&settings, 0, sizeof settings);
    settings.messages = 1;
    dp_host_init(&session, &settings);
    began = now_ms();
    converse();
    dp_host_get_health(&session, &health);
    printf("\n%lu frames received, %lu requests retransmitted, %lu of %lu answers late, %lu ms for the slowest, in %.1f s; "
           "%d expectations, %d not met: %s\n",
           health.frames, health.retransmissions, health.timeouts, health.rtt_count + health.timeouts, health.rtt_max,
           (double)now_ms() / 1000, expected, failed, failed ? "FAILED" : "all as expected");
    dp_serial_close(&port);
    return failed ? 1 : 0;
}
