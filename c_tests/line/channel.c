/*
 * Both ends of the line protocol's link over the lines of channel.h: each run is one setup of the link, one line
 * quality and a user's random commands.
 *
 * What has to hold in every run, however bad the line:
 *   - each command ends exactly once, and in bounded time;
 *   - with checksums, none is carried out twice, or otherwise than it was sent.
 *
 * And with acks and checksums, or without damage to the lines that arrive at all and with acks or a window of 1:
 *   - answered means carried out once, refused not at all, and nothing else is certain.
 *
 * Where nothing has to hold, what happens is counted.
 *
 * Usage: line_channel [RUNS [FIRST_SEED]]
 */
#include "libdeltarobot/line_device.h"
#include "libdeltarobot/line_host.h"

#include "channel.h"

enum {
    RUNS = 4000,
    WIDE = OLP_WINDOW_MAX < 8 ? OLP_WINDOW_MAX : 8, /* the larger window */
    COMMANDS = 40,
    ONE_WAY_MS = 120,
    /* By when any command has to have ended, behind all others: each may be sent four times, and waited for 2 s. */
    BOUND_MS = 20000 + 9000 * OLP_WINDOW_MAX,
    SENT_MAX = 1024
};

static const Quality QUALITIES[] = {
    {0, 0, 0, 0, 0, 0, 0, 0},                /* a good line */
    {0, 0, 0, 1000, 0, 20, 0, 0},            /* whole lines lost */
    {0, 0, 0, 3000, 0, ONE_WAY_MS, 0, 0},    /* many of them, others late */
    {0, 0, 0, 1000, 1000, ONE_WAY_MS, 0, 0}, /* doubled too */
    {20, 20, 0, 0, 0, 20, 0, 0},             /* single bytes */
    {0, 200, 0, 0, 0, 5, 0, 0},              /* flips alone, in most lines */
    {60, 60, 0, 500, 500, ONE_WAY_MS, 0, 0}  /* everything */
};

enum kind { SET, ADD, TOGGLE, BAD, UNKNOWN, NOBODY, LONG, KINDS };

struct command {
    int handle, ended, outcome, executed;
    enum kind kind;
    unsigned value, device;
    unsigned long at;
};

static struct olp_host hosts[2], *host = hosts;
static struct olp_device devices[2], *device = devices;
static struct command commands[COMMANDS];
static int command_count, toggles, toggled, setup_handle, setup_step, restarts, widened;
static int want_ack, want_checksum, want_window;
static char sent[SENT_MAX][OLP_COMMAND_MAX + 1];
static int sent_count;

/* The link is set up, or the user would not have sent a command yet. */
enum { TO_SETTLE, TO_WIDEN, SETTLED };

/* Of one setup of the link. */
static struct sums {
    long runs, answered, refused, timed_out, restarted, twice, altered, mistaken, forged_runs, lines;
    long repeats, unsettled;
} sums[8], *sum;

/* --- the device --- */

static int send_up(const void *line, int bytes, void *usr)
{
    (void)usr;
    ++sum->lines;
    transmit(&up, line, bytes);
    return 0;
}

/* Whether the host has sent that line; the checksum is not looked at. */
static int was_sent(const struct olp_message *message)
{
    int i, length = message->length;
    if (message->checksum != OLP_CHECKSUM_NONE)
        length -= 7;
    for (i = 0; i < sent_count; ++i)
        if (strncmp(sent[i], message->line, (size_t)length) == 0 && (sent[i][length] == '\n' || sent[i][length] == '&'))
            return 1;
    return 0;
}

/* Which of the commands that is; NULL when it is none. */
static struct command *meant(const struct olp_message *message)
{
    long number, value;
    char id[16], name[16];

    if (!was_sent(message)) {
        forged |= want_checksum && !restarts;
        ++sum->altered;
        HOLDS(!want_checksum || restarts, "a command was carried out otherwise than it was sent");
        return NULL;
    }
    if (olp_get_int(message, "n", 0, &number) != OLP_RC_SUCCESS || number < 0 || number >= command_count ||
        olp_get_int(message, "v", 0, &value) != OLP_RC_SUCCESS)
        return NULL;
    olp_get_string(message, "id", 0, id, sizeof id);
    olp_get_string(message, "c", 0, name, sizeof name);
    HOLDS((unsigned long)value == commands[number].value && id[3] == (char)('0' + commands[number].device),
          "a parameter is not what was sent");
    return &commands[number];
}

static void execute(const struct olp_message *message)
{
    struct command *command = meant(message);
    if (command == NULL)
        return;
    ++command->executed;
    if (command->executed > 1 && !restarts) {
        ++sum->twice;
        HOLDS(is_damaged() && !want_checksum, "a command was carried out twice");
    }
    HOLDS(!command->ended || command->outcome == OLP_HOST_TIMED_OUT || restarts || (is_damaged() && !want_checksum) ||
              !want_ack,
          "a command was carried out after its end");
}

static int run_set(const struct olp_message *message, struct olp_encoder *answer, void *usr)
{
    (void)usr;
    execute(message);
    olp_add_int(answer, "state", 1);
    return 0;
}

static int run_toggle(const struct olp_message *message, struct olp_encoder *answer, void *usr)
{
    (void)usr;
    (void)answer;
    if (was_sent(message)) {
        ++toggled;
    } else {
        forged |= want_checksum && !restarts;
        ++sum->altered;
        HOLDS(!want_checksum || restarts, "a toggle was carried out that was not sent");
    }
    return 0;
}

static int run_bad(const struct olp_message *message, struct olp_encoder *answer, void *usr)
{
    (void)message;
    (void)answer;
    (void)usr;
    return 1;
}

static int run_long(const struct olp_message *message, struct olp_encoder *answer, void *usr)
{
    char text[OLP_REPLY_MAX + 1];
    (void)usr;
    execute(message);
    memset(text, 'x', OLP_REPLY_MAX);
    text[OLP_REPLY_MAX] = '\0';
    olp_add_string(answer, "text", text);
    return 0;
}

static const struct olp_device_info DEVICES[] = {
    {"dev0", "IDManager", 1, NULL, "1.0.0"},
    {"dev1", "Switch", 2, "Fan", "1.0.0"},
    {"dev2", "Heater", 3, "Heater", "1.0.0"},
};
static const struct olp_command COMMANDS_KNOWN[] = {
    {NULL, "set", run_set},   {NULL, "add", run_set},   {NULL, "toggle", run_toggle},
    {"dev1", "bad", run_bad}, {"dev2", "bad", run_bad}, {NULL, "long", run_long},
};
static const struct olp_device_table TABLE = {DEVICES, 3, COMMANDS_KNOWN, 6, send_up, 0};

static int device_receives(const unsigned char *bytes, int count)
{
    return olp_device_receive(device, bytes, count, clock_ms());
}

static void device_does(void)
{
    while (olp_device_poll(device, clock_ms()) != OLP_RC_NO_EVENT)
        continue;
}

static void device_tells(void)
{
    char line[80];
    struct olp_encoder event;
    olp_begin(&event, line, sizeof line, "heaterinfo");
    olp_add_float(&event, "temp", (float)below(2000) / 10, 2);
    olp_device_event(device, &event, "dev2");
}

/* --- the user --- */

static void set_up(void)
{
    int rc;
    if (setup_handle > 0)
        return;
    /* Three parameters are one too many for a line. */
    rc = setup_step == TO_SETTLE ? olp_host_setup(host, "dev0", want_ack, want_checksum, -1)
                                 : olp_host_setup(host, "dev0", -1, -1, want_window);
    HOLDS(rc > 0 || rc == -OLP_RC_BUSY, "a setup was not taken");
    if (rc > 0)
        setup_handle = rc;
}

static int is_settled(const struct olp_host_link *link)
{
    return link->ack == want_ack && link->checksum == want_checksum;
}

static void setup_ended(const struct olp_host_event *event)
{
    struct olp_host_link link;
    olp_host_get_link(host, &link);
    setup_handle = 0;
    if (event->outcome != OLP_HOST_ANSWERED)
        return;
    if (setup_step == TO_SETTLE && is_settled(&link))
        setup_step = want_window > 1 ? TO_WIDEN : SETTLED;
    else if (setup_step == TO_WIDEN)
        setup_step = is_settled(&link) ? link.windowsize == (unsigned)want_window ? SETTLED : TO_WIDEN : TO_SETTLE;
}

static void command_ended(const struct olp_host_event *event)
{
    int i;
    /* Handles are used again: the last one is meant. */
    for (i = command_count - 1; i >= 0 && commands[i].handle != event->handle; --i)
        continue;
    HOLDS(i >= 0 && !commands[i].ended, "a command ended twice, or was none");
    if (i < 0)
        return;
    commands[i].ended = 1;
    commands[i].outcome = event->outcome;
    HOLDS(event->outcome >= OLP_HOST_ANSWERED && event->outcome <= OLP_HOST_RESTARTED, "an outcome");
    HOLDS((event->message.length > 0) == (event->outcome <= OLP_HOST_REFUSED), "only answers have a line");
    sum->answered += event->outcome == OLP_HOST_ANSWERED;
    sum->refused += event->outcome == OLP_HOST_REFUSED;
    sum->timed_out += event->outcome == OLP_HOST_TIMED_OUT;
    sum->restarted += event->outcome == OLP_HOST_RESTARTED;
    HOLDS(event->outcome != OLP_HOST_RESTARTED || restarts || is_damaged() || quality.repeat_piece, "no restart");
}

static void look_at(const struct olp_host_event *event)
{
    struct olp_host_link link;
    switch (event->kind) {
    case OLP_HOST_ENDED:
        if (event->handle == setup_handle)
            setup_ended(event);
        else
            command_ended(event);
        break;
    case OLP_HOST_LINKSETUP:
        olp_host_get_link(host, &link);
        if (!is_settled(&link) && setup_step != TO_SETTLE)
            setup_step = TO_SETTLE; /* the device has started anew */
        break;
    case OLP_HOST_WELCOME:
        HOLDS(event->device >= 0 || is_damaged() || OLP_DEVICES_MAX < 3, "a device is not in the table");
        break;
    default:
        break;
    }
}

static void request(void)
{
    static const char *const NAMES[KINDS] = {"set", "add", "toggle", "bad", "nope", "set", "long"};
    struct command *command = &commands[command_count];
    struct olp_host_link link;
    char text[OLP_COMMAND_MAX], id[8];
    int handle;

    /* Without having been asked, the device may want more than 1. */
    olp_host_get_link(host, &link);
    widened |= link.windowsize > 1;
    memset(command, 0, sizeof *command);
    command->kind = below(3) ? (enum kind)below(3) : (enum kind)below(KINDS);
    command->value = below(1000);
    command->device = command->kind == NOBODY ? 7 : 1 + below(2);
    command->at = now;
    sprintf(id, "dev%u", command->device);
    if (command->kind == TOGGLE)
        sprintf(text, "c=toggle"); /* all of them the same */
    else
        sprintf(text, "c=%s&n=%d&v=%u", NAMES[command->kind], command_count, command->value);
    if (command->kind == TOGGLE)
        strcpy(id, "dev1");
    handle = olp_host_send(host, text, (int)strlen(text), id);
    HOLDS(handle > 0 || handle == -OLP_RC_BUSY, "a command was not taken");
    if (handle > 0) {
        command->handle = handle;
        toggles += command->kind == TOGGLE;
        ++command_count;
    }
}

static int commands_out(void)
{
    int i, out = 0;
    for (i = 0; i < command_count; ++i)
        out += !commands[i].ended;
    return out;
}

static void user_acts(void)
{
    int i;
    if (setup_step != SETTLED) {
        set_up();
        return;
    }
    if (setup_handle == 0)
        for (i = 1 + (int)below((unsigned)want_window); i > 0 && command_count < COMMANDS; --i)
            request();
}

/* --- a run --- */

static int host_receives(const unsigned char *bytes, int count)
{
    return olp_host_receive(host, bytes, count, clock_ms());
}

static void host_tells(void)
{
    struct olp_host_event event;
    while (olp_host_poll(host, clock_ms(), &event) == OLP_RC_SUCCESS) {
        look_at(&event);
        /* A user who does not wait for the loop. */
        if (event.kind == OLP_HOST_ENDED && setup_step == SETTLED && setup_handle == 0 && below(2) &&
            command_count < COMMANDS)
            request();
    }
}

static void host_sends(void)
{
    char bytes[OLP_COMMAND_MAX + 200], *line, *end;
    int length;

    while ((length = olp_host_output(host, bytes, OLP_COMMAND_MAX + (int)below(200), clock_ms())) > 0)
        /* Line by line, so that each has its own fate. */
        for (line = bytes; line < bytes + length; line = end) {
            end = memchr(line, '\n', (size_t)(bytes + length - line));
            HOLDS(end != NULL && end - line < OLP_COMMAND_MAX, "what is sent is lines");
            if (end == NULL)
                return;
            ++end;
            if (sent_count < SENT_MAX) {
                memcpy(sent[sent_count], line, (size_t)(end - line));
                sent[sent_count++][end - line] = '\0';
            }
            transmit(&down, line, (int)(end - line));
        }
}

static void choose(unsigned long run)
{
    struct olp_host_settings settings;

    begin_run(run, QUALITIES, sizeof QUALITIES / sizeof *QUALITIES, 20000);
    want_ack = (int)(run >> 2 & 1);
    want_checksum = (int)(run >> 1 & 1);
    want_window = run & 1 ? WIDE : 1;
    sum = &sums[run & 7];
    ++sum->runs;
    command_count = toggles = toggled = setup_handle = restarts = widened = sent_count = 0;
    setup_step = TO_SETTLE;
    memset(&settings, 0, sizeof settings);
    if (below(4) == 0)
        settings.timeout_ms = 2 * ONE_WAY_MS + 10 + below(300);
    settings.recognises = (int)below(2);
    settings.receive_room = below(2) ? -1 : 0;
    memset(host, 0xA5, sizeof *host);
    CHECK_INT(olp_host_init(host, &settings), OLP_RC_SUCCESS);
    memset(device, 0xA5, sizeof *device);
    CHECK_INT(olp_device_init(device, &TABLE, NULL), OLP_RC_SUCCESS);
    if (below(3) == 0)
        olp_device_linksetup(device, (int)below(2), (int)below(2), 1 + (int)below(OLP_WINDOW_MAX));
}

static void judge(void)
{
    int i, known = 0, unknown = 0, strict;
    struct command *command;

    /* Where each end knows what the other has received. */
    strict = want_ack && want_checksum;
    if (!is_damaged() && (want_ack || !(widened || quality.repeat_piece)))
        strict = 1;
    for (command = commands; command < commands + command_count; ++command) {
        int does = command->kind == SET || command->kind == ADD || command->kind == LONG;
        if (command->kind == TOGGLE) {
            known += command->outcome == OLP_HOST_ANSWERED;
            unknown += command->outcome == OLP_HOST_TIMED_OUT || command->outcome == OLP_HOST_RESTARTED;
        }
        for (i = 0; i < 2; ++i) {
            int outcome = i ? OLP_HOST_REFUSED : OLP_HOST_ANSWERED;
            int expected = i ? command->executed == 0 : does ? command->executed == 1 : 0;
            if (command->kind == TOGGLE)
                expected = !i;
            if (command->outcome == outcome && !expected) {
                ++sum->mistaken;
                HOLDS(!strict || restarts, i ? "refused, and carried out" : "answered, and not carried out once");
            }
        }
        HOLDS(!strict || restarts || command->outcome != OLP_HOST_REFUSED || !does, "refused without a reason");
    }
    if (toggled < known || toggled > known + unknown) {
        ++sum->mistaken;
        HOLDS(!strict || restarts, "toggled too often, or not often enough");
    }
    HOLDS(!(want_checksum || !is_damaged()) || restarts || toggled <= toggles, "toggled more often than asked to");
}

static int is_overdue(void)
{
    int i;
    for (i = 0; i < command_count; ++i)
        if (!commands[i].ended && now - commands[i].at > BOUND_MS)
            return 1;
    return 0;
}

static void run_once(unsigned long run)
{
    unsigned long next_act = 0, next_event, next_restart = 0;
    struct olp_host_health health;

    choose(run);
    next_event = below(500);
    if (below(6) == 0)
        next_restart = 1 + below(20000);
    for (;;) {
        unsigned long next;

        if (now >= next_act) {
            user_acts();
            next_act = now + 1 + below(400);
        }
        if (now >= next_event) {
            device_tells();
            next_event = now + 1 + below(below(4) ? 2000 : 20);
        }
        if (next_restart && now >= next_restart) {
            next_restart = 0;
            ++restarts;
            olp_device_restart(device);
        }
        MOVE_AT_TIMES(host, hosts);
        MOVE_AT_TIMES(device, devices);
        arrive(&down, 1 + (int)below(300), device_receives, device_does);
        arrive(&up, 1 + (int)below(300), host_receives, host_tells);
        host_sends();
        HOLDS(!is_overdue(), "a command does not end");
        if (wrong || (command_count == COMMANDS && !commands_out() && setup_handle == 0 && !up.count && !down.count))
            break;
        if (now > 400000) { /* hardly a line gets through */
            ++sum->unsettled;
            break;
        }

        next = next_act;
        earlier(&next, next_event);
        earlier_deadline(&next, olp_host_next_deadline(host, clock_ms()));
        go_on(next);
    }
    if (!wrong)
        judge();
    olp_host_get_health(host, &health);
    sum->repeats += (long)health.repeats;
    sum->forged_runs += forged;
    end_run(run, is_damaged());
}

int main(int argc, char **argv)
{
    int i;

    run_all(argc, argv, RUNS, run_once, 1);
    for (i = 0; i < 8; ++i) {
        const struct sums *of = &sums[i];
        printf("ack %-3s checksum %-3s window %d: %ld runs: %ld answered, %ld refused, %ld timed out, %ld restarted; "
               "%ld lines, %ld repeats; twice %ld, altered %ld, mistaken %ld; forged in %ld runs; "
               "unsettled %ld\n",
               i & 4 ? "on" : "off", i & 2 ? "on" : "off", i & 1 ? WIDE : 1, of->runs, of->answered, of->refused,
               of->timed_out, of->restarted, of->lines, of->repeats, of->twice, of->altered, of->mistaken,
               of->forged_runs, of->unsettled);
    }
    return check_summary("line_channel");
}
