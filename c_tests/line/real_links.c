/*
 * The host on links as people have them: a board with a receive ring of 63 bytes that it empties in its loop, lines of a
 * known speed behind an output queue, noise. The board is not the library's: like all public ones it acknowledges and
 * checks, and does not recognise repeats.
 *
 * Usage: line_real_links [PART]    A PARTth of the commands, 20 by default; 1 for all.
 */
#include "libdeltarobot/line_host.h"

#include "check.h"

#include <stdlib.h>

enum { RING = 63, COMMANDS_MAX = 100000, WIRE = 1 << 15 };

static struct link {
    unsigned baud, loop_ms;
    int window, ack, checksum;
    double down, up; /* bytes lost, and bytes with a bit flipped, each */
    long commands;
} run;

static struct {
    long answered, refused, timed_out, restarted, twice, unexecuted, repeats, overruns;
    double ms; /* a command */
} result;

static unsigned long long now_us, seed;
static struct olp_host host;

static double chance(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

/* --- bytes on their way: a queue in front of a wire --- */

struct wire {
    unsigned char byte[WIRE];
    unsigned long long at[WIRE], free_at;
    unsigned first, last;
};
static struct wire down, up;

static void put(struct wire *wire, const char *bytes, int length, double noise)
{
    int i;
    if (wire->free_at < now_us)
        wire->free_at = now_us;
    for (i = 0; i < length; ++i) {
        wire->free_at += 10000000ull / run.baud;
        if (noise > 0 && chance() < noise)
            continue;
        wire->byte[wire->last % WIRE] = (unsigned char)bytes[i];
        if (noise > 0 && chance() < noise)
            wire->byte[wire->last % WIRE] ^= (unsigned char)(1u << (unsigned)(chance() * 8));
        wire->at[wire->last++ % WIRE] = wire->free_at;
        CHECK(wire->last - wire->first < WIRE);
    }
}

static int take(struct wire *wire, unsigned char *byte)
{
    if (wire->first == wire->last || wire->at[wire->first % WIRE] > now_us)
        return 0;
    *byte = wire->byte[wire->first++ % WIRE];
    return 1;
}

/* --- the board --- */

static struct {
    unsigned char ring[RING];
    int used, length;
    char line[128];
    unsigned t;
} board;
static unsigned char executed[COMMANDS_MAX];

static void board_says(const char *line)
{
    char text[200];
    int length = sprintf(text, "%.190s\n", line);
    put(&up, text, length, run.up);
}

static void board_handles(void)
{
    struct olp_message message;
    char text[160], id[16], name[16];
    long t = 0, n;

    if (board.length == 0)
        return;
    if (board.length > (int)sizeof board.line ||
        olp_parse(board.line, board.length, &message) != OLP_RC_SUCCESS ||
        (run.checksum && message.checksum != OLP_CHECKSUM_RIGHT) ||
        olp_get_int(&message, "n", 0, &n) != OLP_RC_SUCCESS || n < 0 || n >= run.commands ||
        olp_get_string(&message, "id", 0, id, sizeof id) < 0 ||
        olp_get_string(&message, "c", 0, name, sizeof name) < 0 ||
        olp_get_int(&message, "t", 0, &t) != OLP_RC_SUCCESS) {
        sprintf(text, "c=onerror&code=checksum&t=%u&id=dev1", board.t++ & 255);
        board_says(text);
        return;
    }
    if (run.ack) {
        if (run.checksum)
            sprintf(text, "c=ack&checksum=%04x&t=%ld&id=%s", message.sum, t, id);
        else
            sprintf(text, "c=ack&checksum=null&t=%ld&id=%s", t, id);
        board_says(text);
    }
    executed[n] = (unsigned char)(executed[n] + 1);
    sprintf(text, "c=%s_resp&state=1&id=%s&t=%u", name, id, board.t++ & 255);
    board_says(text);
}

static void board_receives(void)
{
    unsigned char byte;
    while (take(&down, &byte)) {
        if (board.used < RING)
            board.ring[board.used++] = byte;
        else
            ++result.overruns;
    }
}

static void board_loops(void)
{
    int i;
    for (i = 0; i < board.used; ++i) {
        if (board.ring[i] == '\n') {
            board_handles();
            board.length = 0;
        } else {
            if (board.length < (int)sizeof board.line)
                board.line[board.length] = (char)board.ring[i];
            ++board.length;
        }
    }
    board.used = 0;
}

/* --- the host and its user --- */

static long handles[32768], asked, ended;

static void ends(const struct olp_host_event *event)
{
    long n = handles[event->handle];
    ++ended;
    result.answered += event->outcome == OLP_HOST_ANSWERED;
    result.refused += event->outcome == OLP_HOST_REFUSED;
    result.timed_out += event->outcome == OLP_HOST_TIMED_OUT;
    result.restarted += event->outcome == OLP_HOST_RESTARTED;
    if (event->outcome == OLP_HOST_ANSWERED && executed[n] == 0)
        executed[n] = 128; /* told too early: counted at the end, unless it is executed by then */
}

static void user_asks(void)
{
    static const char *const NAMES[] = {"set", "add"}, *const IDS[] = {"dev001", "dev002"};
    char text[OLP_COMMAND_MAX];
    while (asked < run.commands && asked - ended < run.window) {
        int length = sprintf(text, "c=%s&n=%ld", NAMES[chance() < 0.5], asked);
        int handle = olp_host_send(&host, text, length, IDS[chance() < 0.5]);
        if (handle < 0)
            return;
        handles[handle] = asked++;
    }
}

static void host_turns(void)
{
    struct olp_host_event event;
    unsigned char byte;
    char out[OLP_COMMAND_MAX];
    unsigned long now = (unsigned long)(now_us / 1000);
    int length, have = 0;

    do {
        if (have && olp_host_receive(&host, &byte, 1, now) == 1)
            have = 0;
        while (olp_host_poll(&host, now, &event) == OLP_RC_SUCCESS)
            if (event.kind == OLP_HOST_ENDED)
                ends(&event);
    } while (have || (have = take(&up, &byte)) != 0);
    user_asks();
    while ((length = olp_host_output(&host, out, sizeof out, now)) > 0)
        put(&down, out, length, run.down);
}

static void link_runs(struct link settings)
{
    struct olp_host_settings of_host = {0};
    struct olp_host_health health;
    char line[80];
    unsigned long long begin;
    long n;

    run = settings;
    memset(&result, 0, sizeof result);
    memset(&board, 0, sizeof board);
    memset(executed, 0, sizeof executed);
    memset(&down, 0, sizeof down);
    memset(&up, 0, sizeof up);
    asked = ended = 0;
    seed = 0x9E3779B97F4A7C15ull;
    of_host.baud = run.baud;
    olp_host_init(&host, &of_host);
    sprintf(line, "c=linksetup&windowsize=%d&ack=%s&checksum=%s&t=0&id=dev\n", run.window, run.ack ? "on" : "off",
            run.checksum ? "fletcher16" : "none");
    olp_host_receive(&host, line, (int)strlen(line), (unsigned long)(now_us / 1000));
    begin = now_us;
    while (ended < run.commands) {
        board_receives();
        if (now_us / 1000 % run.loop_ms == 0)
            board_loops();
        host_turns();
        now_us += 1000;
    }
    for (n = 0; n < run.commands; ++n) {
        result.unexecuted += executed[n] == 128;
        result.twice += (executed[n] & 127) > 1;
    }
    olp_host_get_health(&host, &health);
    result.repeats = (long)health.repeats;
    result.ms = (double)(now_us - begin) / 1000 / (double)run.commands;
    printf("%6u baud, loop %2u ms, window %d, ack %-3s checksum %-3s noise %g down %g up: %ld commands, %.1f ms each, "
           "%ld answered, %ld timed out, %ld repeats, %ld twice, %ld answered and not executed, %ld bytes overrun\n",
           run.baud, run.loop_ms, run.window, run.ack ? "on" : "off", run.checksum ? "on" : "off", run.down, run.up,
           run.commands, result.ms, result.answered, result.timed_out, result.repeats, result.twice,
           result.unexecuted, result.overruns);
}

int main(int argc, char **argv)
{
    static const int WINDOWS[] = {1, 4, 8};
    static const unsigned LOOPS[] = {1, 5, 10}, BAUDS[] = {2400, 9600, 115200};
    static const double NOISE[] = {1e-4, 1e-3};
    long part = argc > 1 ? atol(argv[1]) : 20;
    int i, k, acks;

    puts("More in flight than the board's ring takes: never.");
    for (i = 0; i < 3; ++i) {
        double alone = 0;
        for (k = 0; k < 3; ++k) {
            struct link link = {115200, LOOPS[i], WINDOWS[k], 1, 1, 0, 0, 20000 / part};
            link_runs(link);
            CHECK_INT(result.answered, link.commands);
            CHECK_INT(result.overruns, 0);
            CHECK(k == 0 || result.ms <= alone * 1.001);
            alone = k ? alone : result.ms;
        }
    }
    puts("Clean lines of any speed.");
    for (acks = 0; acks < 2; ++acks)
        for (i = 0; i < 3; ++i)
            for (k = 0; k < 3; ++k) {
                struct link link = {BAUDS[i], 1, WINDOWS[k], acks, 1, 0, 0, 20000 / part};
                link_runs(link);
                CHECK_INT(result.answered, link.commands);
                CHECK(result.repeats * 1000 <= link.commands);
            }
    puts("Noise on the commands alone, and a board that does not recognise repeats.");
    for (i = 0; i < 2; ++i)
        for (k = 0; k < 2; ++k) {
            struct link link = {115200, 1, WINDOWS[k], 1, 1, NOISE[i], 0, COMMANDS_MAX / part};
            link_runs(link);
            CHECK_INT(result.twice, 0);
            CHECK_INT(result.unexecuted, 0);
        }
    puts("Noise both ways: without the board's help an ack that is lost makes a command be executed twice.");
    for (i = 0; i < 2; ++i)
        for (k = 0; k < 2; ++k) {
            struct link link = {115200, 1, WINDOWS[k], 1, 1, NOISE[i], NOISE[i], COMMANDS_MAX / part};
            link_runs(link);
            CHECK_INT(result.unexecuted, 0);
        }
    puts("Without acks: told as answered and not executed.");
    for (i = 0; i < 2; ++i)
        for (k = 0; k < 2; ++k) {
            struct link link = {115200, 1, WINDOWS[k], 0, 1, NOISE[i], NOISE[i], COMMANDS_MAX / part};
            link_runs(link);
            CHECK(result.unexecuted * part <= (i ? 20 : 0));
        }
    return check_summary("line_real_links");
}
