/* gx_host.h alone, against hand-written answers: how a session begins, what is sent, again too, and how moves end. */
#include "libdeltarobot/gx_host.h"

#include "check.h"

static struct gx_host host;
static unsigned long now;
static struct gx_host_event event;
static struct gx_host_settings settings;

#define SAYS(bytes) CHECK(says(bytes, (int)sizeof(bytes) - 1))
#define HEARS(bytes) hears(bytes, (int)sizeof(bytes) - 1)

static int says(const char *expected, int count)
{
    unsigned char out[512];
    int got = gx_host_output(&host, out, sizeof out, now);
    if (got == count && memcmp(out, expected, (size_t)count) == 0)
        return 1;
    check_dump("said", out, got < 0 ? 0 : (size_t)got);
    return 0;
}

static void hears(const void *bytes, int count)
{
    CHECK_INT(gx_host_receive(&host, bytes, count, now), count);
}

static struct gx_host_health health(void)
{
    struct gx_host_health copy;
    memset(&copy, 0xA5, sizeof copy);
    CHECK_INT(gx_host_get_health(&host, &copy), GX_RC_SUCCESS);
    return copy;
}

static int kind_of_event(void)
{
    int rc = gx_host_poll(&host, now, &event);
    CHECK_INT(rc, event.kind ? GX_RC_SUCCESS : GX_RC_NO_EVENT);
    return event.kind;
}

static int ends(int outcome, int code)
{
    return CHECK_INT(kind_of_event(), GX_HOST_ENDED) & CHECK_INT(event.outcome, outcome) & CHECK_INT(event.code, code) &
           CHECK_INT(event.number, -1);
}

static int nothing_happens(void)
{
    return CHECK_INT(kind_of_event(), 0);
}

static void move(long x, long y, int axes, int velocity)
{
    int32_t target[GX_AXES] = {0, 0, 0, 0, 0, 0};
    target[0] = (int32_t)x;
    target[1] = (int32_t)y;
    CHECK_INT(gx_host_move(&host, target, axes, velocity), GX_RC_SUCCESS);
}

static void begin(void)
{
    memset(&host, 0xA5, sizeof host);
    CHECK_INT(gx_host_init(&host, &settings), GX_RC_SUCCESS);
    memset(&settings, 0, sizeof settings);
    now = 0xFFFFFFFFul - 300; /* wraps in between */
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
}

/* From number 0: the requests have numbers 0 and 5461, the first move has 5462 (D6 AA). */
static void open_session(void)
{
    nothing_happens();
    SAYS("\x1B#\x80\x80~\x80\x80");
    HEARS("#\x80\x80\n");
    nothing_happens();
    SAYS("\x1B#\xD5\xAA~\x80\x80");
    HEARS("#\x80\x80#\xD5\xAA\n");
    CHECK_INT(kind_of_event(), GX_HOST_BEGUN);
    nothing_happens();
}

static void moves_take_the_shortest_form(void)
{
    begin();
    move(1000, -1000, 3, 1000);
    move(1001, -1001, 3, -1);
    move(1001, -1001, 3, 1000);
    move(1001, -938, 2, -1);
    move(1001, -1002, 3, -1);
    move(0, 0, 0, 5);
    CHECK_INT(gx_host_unfinished(&host), 6);
    open_session();
    SAYS("#\xD6\xAA\x21\xC3\xE8\x87\xE8\x87\x80\x80\x98\xF8\xFF\xFF"
         "#\xD7\xAA\x2A\x83\x81\xFF"
         "#\xD8\xAA\x2A\x81\x80" /* stays where it is, and has an end all the same */
         "#\xD9\xAA\x2A\x82\xBF" /* 63 */
         "#\xDA\xAA\x21\x82\x96\xF8\xFF\xFF" /* -64 is not written as a delta */
         "#\xDB\xAA\x2A\xC0\x85\x80");
    HEARS("#\xD6\xAA#\xD7\xAA\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    CHECK(ends(GX_HOST_FINISHED, 0));
    nothing_happens();
    HEARS("#\xDA\xAA"); /* the notice before it was lost; this one is told when the line is quiet */
    nothing_happens();
    CHECK_INT(gx_host_next_deadline(&host, now), 50);
    now += 50;
    CHECK(ends(GX_HOST_FINISHED, 0));
    CHECK(ends(GX_HOST_FINISHED, 0));
    CHECK(ends(GX_HOST_FINISHED, 0));
    nothing_happens();
    CHECK_INT(gx_host_unfinished(&host), 1);
    HEARS("#\xDB\xAA\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    move(1002, -1002, 1, -1);
    SAYS("#\xDC\xAA\x2A\x81\x81"); /* where it stands is known from moves that have ended too */
    CHECK_INT((long)health().moves, 7);
    CHECK_INT((long)health().sessions, 1);
}

/* The check of where a move leads: x and y, and the velocity unless it is -1. */
static void confirms(int number, int axes, int velocity, long x, long y, int wrong)
{
    unsigned char bytes[8];
    struct gx_vector target;
    struct gx_number its_number;
    int check;
    memset(&target, 0, sizeof target);
    target.mask = (unsigned char)(axes | (velocity >= 0 ? GX_MASK_VELOCITY : 0));
    target.velocity = (uint16_t)(velocity >= 0 ? velocity : 0);
    target.axes[0] = (int32_t)x;
    target.axes[1] = (int32_t)y;
    its_number.value = (uint16_t)number;
    its_number.format = GX_BINARY;
    check = (gx_check(&target, number) + wrong) % 127;
    hears(bytes, gx_write_confirmed(&its_number, check, bytes, sizeof bytes));
}

static void confirmations_are_compared_with_the_plan(void)
{
    begin();
    move(1000, -1000, 3, 1000);
    move(1001, -1000, 1, -1);
    move(1001, -999, 2, -1);
    move(1001, -998, 2, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\xC3\xE8\x87\xE8\x87\x80\x80\x98\xF8\xFF\xFF"
         "#\xD7\xAA\x2A\x81\x81"
         "#\xD8\xAA\x2A\x82\x81"
         "#\xD9\xAA\x2A\x82\x81");
    confirms(5462, 3, 1000, 1000, -1000, 0);
    CHECK(ends(GX_HOST_FINISHED, 0)); /* at once */
    CHECK_INT(gx_host_next_deadline(&host, now), 50); /* the gap, though nothing waits for it */
    confirms(5463, 3, 1000, 1001, -1000, 1);
    CHECK(ends(GX_HOST_DEVIATED, 0));
    /* One that is not the oldest may itself be damaged: the next decides, about those before it too. */
    confirms(5465, 3, 1000, 1001, -998, 1);
    nothing_happens();
    confirms(5465, 3, 1000, 1001, -998, 0);
    CHECK(ends(GX_HOST_DEVIATED, 0));
    CHECK(ends(GX_HOST_FINISHED, 0));
    nothing_happens();
    /* The next goes out with all that is known, the one behind it need not. */
    move(1002, -998, 1, -1);
    move(1003, -998, 1, -1);
    SAYS("#\xDA\xAA\x21\xC3\xE8\x87\xEA\x87\x80\x80\x9A\xF8\xFF\xFF"
         "#\xDB\xAA\x2A\x81\x81");
    /* Twice wrong: all up to there. */
    confirms(5467, 3, 1000, 1003, -998, 5);
    nothing_happens();
    confirms(5467, 3, 1000, 1003, -998, 5);
    CHECK(ends(GX_HOST_DEVIATED, 0));
    CHECK(ends(GX_HOST_DEVIATED, 0));
    confirms(5467, 3, 1000, 1003, -998, 0); /* late */
    nothing_happens();
    CHECK_INT((long)health().deviations, 4);
    CHECK_INT((long)health().strays, 1);
    CHECK_INT((long)health().completions, 10); /* three of them of the handshake */
}

static void every_so_manieth_move_is_absolute(void)
{
    int i;
    settings.absolute_every = 3;
    settings.window = 1;
    begin();
    for (i = 0; i < 7; ++i) {
        move(i, 5, i == 0 ? 3 : 1, -1);
        if (i == 0)
            open_session();
        if (i == 0)
            SAYS("#\xD6\xAA\x21\x83\x80\x80\x80\x80\x85\x80\x80\x80");
        else if (i == 2)
            SAYS("#\xD8\xAA\x21\x81\x82\x80\x80\x80");
        else if (i == 5)
            SAYS("#\xDB\xAA\x21\x81\x85\x80\x80\x80");
        else
            CHECK_INT(gx_host_output(&host, (unsigned char[128]){0}, 128, now), 6);
        confirms(5462 + i, 3, -1, i, 5, 0);
        CHECK(ends(GX_HOST_FINISHED, 0));
    }
}

static void reports_are_compared_with_the_plan(void)
{
    begin();
    move(100, 0, 3, -1);
    move(200, 50, 3, -1);
    open_session();
    gx_host_output(&host, (unsigned char[128]){0}, 128, now);
    HEARS("=x-5y7\n"); /* where it came from is not known */
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    confirms(5462, 3, -1, 100, 0, 0);
    CHECK(ends(GX_HOST_FINISHED, 0));
    HEARS("=x150y25z9\n");
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    HEARS("=x201y50\n");
    CHECK_INT(kind_of_event(), GX_HOST_DRIFT);
    CHECK_INT(event.position.axes[0], 201);
    HEARS("=x201y50\n"); /* said already */
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    move(201, 50, 1, -1);
    SAYS("#\xD8\xAA\x21\x83\xC9\x81\x80\x80\xB2\x80\x80\x80");
    HEARS("=x201y51\n");
    CHECK_INT(kind_of_event(), GX_HOST_DRIFT);
    nothing_happens();
    CHECK_INT((long)health().deviations, 2);
}

static void hosts_ask_past_the_queue(void)
{
    int i;
    settings.attempts = 3;
    settings.move_ms = 3000;
    begin();
    move(1, 0, 1, -1);
    move(2, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80#\xD7\xAA\x2A\x81\x81");
    CHECK_INT(gx_host_control(&host, 4), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_control(&host, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_control(NULL, 0), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_host_control(&host, GX_CONTROL_QUERY), GX_RC_SUCCESS);
    SAYS("\n%\xFF\x80");
    HEARS("%\x8E\x80");
    CHECK_INT(kind_of_event(), GX_HOST_STATUS);
    CHECK_INT(event.number, 14);
    CHECK_INT(event.code, 0);
    /* Hold: repeated until the status says so; then moves may last as long as they like. */
    CHECK_INT(gx_host_control(&host, GX_CONTROL_HOLD), GX_RC_SUCCESS);
    SAYS("\n%\xFE\x81");
    HEARS("%\x8E\x80");
    CHECK_INT(kind_of_event(), GX_HOST_STATUS);
    now += 250;
    nothing_happens();
    SAYS("\n%\xFE\x81");
    HEARS("%\x8E\x82");
    CHECK_INT(kind_of_event(), GX_HOST_STATUS);
    CHECK_INT(event.code, 1);
    for (i = 0; i < 9; ++i) {
        now += 1000;
        nothing_happens();
        SAYS("#\xD7\xAA\x21\x81\x82\x80\x80\x80"); /* is it still there? */
        HEARS("=x1\n");
        CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    }
    CHECK_INT(gx_host_control(&host, GX_CONTROL_RESUME), GX_RC_SUCCESS);
    SAYS("\n%\xFD\x82");
    HEARS("%\x8E\x80");
    CHECK_INT(kind_of_event(), GX_HOST_STATUS);
    now += 2999;
    nothing_happens();
    CHECK_INT(gx_host_unfinished(&host), 2);
    gx_host_output(&host, (unsigned char[128]){0}, 128, now);
    /* Stop: nothing else is sent any more, and the end is told by the notice, or at the latest by the position. */
    CHECK_INT(gx_host_control(&host, GX_CONTROL_STOP), GX_RC_SUCCESS);
    move(3, 0, 1, -1);
    SAYS("\n%\xFC\x83");
    HEARS("#\xD6\xAA?\x94");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK(ends(GX_HOST_FAILED, GX_FAULT_STOPPED));
    CHECK(ends(GX_HOST_DROPPED, GX_FAULT_STOPPED));
    CHECK(ends(GX_HOST_DROPPED, GX_FAULT_STOPPED));
    move(4, 0, 1, -1);
    nothing_happens();
    SAYS(""); /* no session before it is known where */
    HEARS("=V900x1\n");
    CHECK_INT(kind_of_event(), GX_HOST_STOPPED);
    CHECK_INT(event.position.mask, 0x41);
    CHECK_INT(event.position.velocity, 900);
    nothing_happens();
    SAYS("\x1B#\xAA\xD5~\x80\x80");

    /* Nobody knows that, or nobody is there. */
    begin();
    move(1, 0, 1, -1);
    CHECK_INT(gx_host_control(&host, GX_CONTROL_STOP), GX_RC_SUCCESS);
    CHECK(ends(GX_HOST_DROPPED, 0)); /* it was never sent */
    SAYS("\n%\xFC\x83");
    HEARS("\n?\x81");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK_INT(kind_of_event(), GX_HOST_UNANSWERED);
    CHECK_INT(event.code, GX_CONTROL_STOP);
    settings.attempts = 3;
    begin();
    CHECK_INT(gx_host_control(&host, GX_CONTROL_QUERY), GX_RC_SUCCESS);
    for (i = 0; i < 3; ++i) {
        nothing_happens();
        SAYS("\n%\xFF\x80");
        CHECK_INT(gx_host_next_deadline(&host, now), 250);
        now += 250;
    }
    CHECK_INT(kind_of_event(), GX_HOST_UNANSWERED);
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
}

/* One move at a time, in positions, and no session. */
static void a_mere_echo_is_driven_if_that_is_set(void)
{
    settings.echo = 1;
    settings.probe_ms = 5000;
    settings.move_ms = 60000;
    settings.attempts = 2;
    begin();
    move(1, 2, 3, 700);
    move(2, 2, 1, -1);
    CHECK_INT(kind_of_event(), GX_HOST_BEGUN);
    nothing_happens();
    SAYS("#\x81\x80\x21\xC3\xBC\x85\x81\x80\x80\x80\x82\x80\x80\x80");
    SAYS("");
    now += 5000;
    nothing_happens();
    SAYS("#\x81\x80\x21\xC3\xBC\x85\x81\x80\x80\x80\x82\x80\x80\x80");
    now += 5000;
    nothing_happens();
    SAYS("#\x81\x80\x21\xC3\xBC\x85\x81\x80\x80\x80\x82\x80\x80\x80"); /* it may be a long one */
    HEARS("#\x81\x80\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    SAYS("#\x82\x80\x21\xC3\xBC\x85\x82\x80\x80\x80\x82\x80\x80\x80");
    HEARS("#\x81\x80\n#\x81\x80\n"); /* of what was sent again */
    nothing_happens();
    HEARS("#\x82\x80?\x84"); /* the line has damaged it */
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    nothing_happens();
    SAYS("#\x82\x80\x21\xC3\xBC\x85\x82\x80\x80\x80\x82\x80\x80\x80");
    now += 60000;
    CHECK(ends(GX_HOST_TIMED_OUT, 0));
}

static void in_ascii(void)
{
    settings.ascii = 1;
    settings.window = 1;
    settings.first_number = 16383;
    begin();
    CHECK_INT(gx_host_report(&host, 250), GX_RC_SUCCESS);
    move(400, 300, 3, 1000);
    if (GX_WINDOW_MAX > 1)
        move(401, 300, 3, -1);
    nothing_happens();
    SAYS("\x1B#16383R250\n");
    HEARS("#16383\n");
    nothing_happens();
    SAYS("\x1B#5460R250\n");
    HEARS("#16383\n#5460\n");
    CHECK_INT(kind_of_event(), GX_HOST_BEGUN);
    SAYS("#5461V1000x400y300\n");
    SAYS("");
    HEARS("=x10y-20\n");
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    CHECK_INT(event.position.mask, 3);
    CHECK_INT(event.position.axes[0], 10);
    CHECK_INT(event.position.axes[1], -20);
    HEARS("#5461\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    if (GX_WINDOW_MAX == 1)
        move(401, 300, 3, -1);
    SAYS("#5462x401y300\n");
    /* Reports stay away: they are asked for again. */
    now += 499;
    nothing_happens();
    SAYS("");
    now += 1;
    nothing_happens();
    SAYS("\nR250\n");
    /* When there are to be none, none is waited for. */
    CHECK_INT(gx_host_report(&host, 0), GX_RC_SUCCESS);
    SAYS("\nR0\n");
    HEARS("#5462\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    nothing_happens();
    now += 50; /* the gap */
    nothing_happens();
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
}

static void errors_have_all_sent_again_in_long_form(void)
{
    begin();
    move(1, 1, 3, 7);
    move(2, 1, 3, -1);
    move(3, 1, 3, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\xC3\x87\x80\x81\x80\x80\x80\x81\x80\x80\x80#\xD7\xAA\x2A\x81\x81#\xD8\xAA\x2A\x81\x81");
    HEARS("#\xD6\xAA\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    HEARS("#\xD8\xAA?\x90"); /* 5463 was lost */
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK_INT(event.code, GX_FAULT_ORDER);
    CHECK_INT(event.number, 5464);
    nothing_happens();
    SAYS("#\xD7\xAA\x21\xC3\x87\x80\x82\x80\x80\x80\x81\x80\x80\x80"
         "#\xD8\xAA\x21\xC3\x87\x80\x83\x80\x80\x80\x81\x80\x80\x80");
    /* Of what was on its way meanwhile, not at once again. */
    HEARS("\n?\x84");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK_INT(event.number, -1);
    nothing_happens();
    SAYS("");
    CHECK_INT(gx_host_next_deadline(&host, now), 50); /* the gap; then the rest of 250 */
    now += 250;
    nothing_happens();
    SAYS("#\xD7\xAA\x21\xC3\x87\x80\x82\x80\x80\x80\x81\x80\x80\x80"
         "#\xD8\xAA\x21\xC3\x87\x80\x83\x80\x80\x80\x81\x80\x80\x80");
    HEARS("#\xD8\xAA\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    CHECK(ends(GX_HOST_FINISHED, 0));
    nothing_happens();
    CHECK_INT((long)health().repeats, 4);
    CHECK_INT((long)health().errors, 2);
}

static void silence_has_the_newest_sent_again_until_time_is_out(void)
{
    int i;
    settings.attempts = 3;
    begin();
    move(1, 0, 1, -1);
    move(2, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80#\xD7\xAA\x2A\x81\x81");
    for (i = 0; i < 5; ++i) {
        now += 999;
        nothing_happens();
        SAYS("");
        now += 1;
        nothing_happens();
        SAYS("#\xD7\xAA\x21\x81\x82\x80\x80\x80");
        HEARS("=!\x81\x80\x80\x80\x80"); /* a sign of life: it is on its way */
        CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    }
    for (i = 0; i < 2; ++i) {
        now += 1000;
        nothing_happens();
        SAYS("#\xD7\xAA\x21\x81\x82\x80\x80\x80");
    }
    now += 1000;
    move(3, 0, 1, -1);
    CHECK(ends(GX_HOST_TIMED_OUT, 0));
    CHECK(ends(GX_HOST_TIMED_OUT, 0));
    CHECK(ends(GX_HOST_DROPPED, 0));
    nothing_happens();
    CHECK_INT(gx_host_unfinished(&host), 0);
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
    /* The next move begins a new session, with other numbers. */
    HEARS("#\xD7\xAA\n");
    move(4, 0, 1, -1);
    nothing_happens();
    SAYS("\x1B#\xAA\xD5~\x80\x80"); /* 10922 */
    for (i = 0; i < 2; ++i) {
        now += 250;
        nothing_happens();
        SAYS("\x1B#\xAA\xD5~\x80\x80");
    }
    now += 250;
    CHECK(ends(GX_HOST_TIMED_OUT, 0));
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
}

/* The second answer has to have the first before it, or the motion side may not keep numbers in order. */
static void without_the_first_number_before_the_second_none_begins(void)
{
    begin();
    move(1, 0, 1, -1);
    nothing_happens();
    SAYS("\x1B#\x80\x80~\x80\x80");
    HEARS("#\x80\x80\n");
    nothing_happens();
    SAYS("\x1B#\xD5\xAA~\x80\x80");
    /* Another number between them, and neither counts. */
    HEARS("#\x80\x80#\x81\x80#\xD5\xAA\n");
    nothing_happens();
    SAYS("\x1B#\xAA\xD5~\x80\x80"); /* 10922 */
    HEARS("#\x80\x80#\xD5\xAA#\xAA\xD5\n");
    nothing_happens();
    /* Reports are requested: by what is sent anyway, as no other command may come between. */
    CHECK_INT(gx_host_report(&host, 1000), GX_RC_SUCCESS);
    SAYS("\x1B#\xFF\xFF~\xE8\x87"); /* 16383 */
    CHECK_INT(gx_host_report(&host, 0), GX_RC_SUCCESS);
    SAYS("\x1B#\xFF\xFF~\x80\x80");
    HEARS("#\xAA\xD5#\xFF\xFF\n");
    CHECK_INT(kind_of_event(), GX_HOST_BEGUN);
    nothing_happens();
    SAYS("#\x80\x80\x21\x81\x81\x80\x80\x80");
}

/* A motion side that sends numbers back and nothing more: it is not sent any moves. */
static void with_a_mere_echo_no_session_begins(void)
{
    int asked = 0, i;
    begin();
    move(1, 0, 1, -1);
    for (i = 0; i < 100; ++i) {
        unsigned char out[64];
        struct gx_commands reader;
        struct gx_item item;
        int length, rc = gx_host_poll(&host, now, &event);
        if (rc == GX_RC_SUCCESS)
            break;
        length = gx_host_output(&host, out, sizeof out, now);
        if (!CHECK(length > 0))
            return;
        ++asked;
        gx_commands_init(&reader);
        CHECK_INT(gx_commands_receive(&reader, out, length, &item), length);
        CHECK_INT(item.kind, GX_REPORTING);
        length = gx_write_completed(&item.number, out, sizeof out);
        hears(out, length);
        HEARS("\n");
    }
    CHECK_INT(asked, 16); /* twice for each of 8 attempts */
    CHECK_INT(event.kind, GX_HOST_ENDED);
    CHECK_INT(event.outcome, GX_HOST_TIMED_OUT);
    nothing_happens();
    CHECK_INT(gx_host_next_deadline(&host, now), 50); /* the gap */
    now += 50;
    nothing_happens();
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
}

static void a_move_that_lasts_too_long_times_out(void)
{
    settings.move_ms = 500;
    begin();
    move(1, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80");
    now += 499;
    nothing_happens();
    now += 1;
    CHECK(ends(GX_HOST_TIMED_OUT, 0));
}

static void refused_for_good(void)
{
    begin();
    move(1, 0, 1, -1);
    move(2, 0, 1, -1);
    move(3, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80#\xD7\xAA\x2A\x81\x81#\xD8\xAA\x2A\x81\x81");
    HEARS("#\xD7\xAA?\x93");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    nothing_happens(); /* ends are told in order, and the first is under way */
    move(4, 0, 1, -1);
    nothing_happens();
    SAYS(""); /* a new session would silence it */
    HEARS("#\xD6\xAA\n");
    CHECK(ends(GX_HOST_FINISHED, 0));
    CHECK(ends(GX_HOST_REFUSED, GX_FAULT_AXIS));
    CHECK(ends(GX_HOST_DROPPED, GX_FAULT_AXIS));
    nothing_happens();
    SAYS("\x1B#\xAA\xD5~\x80\x80");
    CHECK_INT(gx_host_unfinished(&host), 1);
}

static void no_room_and_then_room(void)
{
    begin();
    move(1, 0, 1, -1);
    move(2, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80#\xD7\xAA\x2A\x81\x81");
    HEARS("#\xD7\xAA?\x89");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    nothing_happens();
    move(3, 0, 1, -1);
    SAYS("");
    HEARS("#\xD6\xAA\n"); /* now there is */
    CHECK(ends(GX_HOST_FINISHED, 0));
    SAYS("#\xD7\xAA\x21\x81\x82\x80\x80\x80#\xD8\xAA\x2A\x81\x81");
    HEARS("#\xD7\xAA?\x89");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    now += 250;
    nothing_happens();
    SAYS("#\xD7\xAA\x21\x81\x82\x80\x80\x80#\xD8\xAA\x21\x81\x83\x80\x80\x80");
}

static void the_machine_stops(void)
{
    begin();
    move(1, 0, 1, -1);
    move(2, 0, 1, -1);
    move(3, 0, 1, -1);
    open_session();
    gx_host_output(&host, (unsigned char[128]){0}, 128, now);
    HEARS("#\xD7\xAA?\xC0"); /* 64, one of the firmware's own */
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK(ends(GX_HOST_FINISHED, 0)); /* or it would not have come to the next */
    CHECK(ends(GX_HOST_FAILED, 64));
    CHECK(ends(GX_HOST_DROPPED, 64));
    nothing_happens();
    begin();
    move(1, 0, 1, -1);
    open_session();
    gx_host_output(&host, (unsigned char[128]){0}, 128, now);
    HEARS("#\xD6\xAA?\x91");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    CHECK(ends(GX_HOST_LOST, GX_FAULT_CLOSED));
}

static void strays_change_nothing(void)
{
    begin();
    move(1, 0, 1, -1);
    open_session();
    SAYS("#\xD6\xAA\x21\x81\x81\x80\x80\x80");
    HEARS("#\xD5\xAA\n#\xD7\xAA\n#\x80\x80\n");
    nothing_happens();
    CHECK_INT((long)health().strays, 3);
    HEARS("#\xD6\xAA\x90"); /* an error notice that has lost its '?' is no completion */
    nothing_happens();
    now += 50;
    nothing_happens();
    HEARS("#\xD7\xAA?\x93");
    CHECK_INT(kind_of_event(), GX_HOST_ERROR);
    nothing_happens();
    CHECK_INT(gx_host_unfinished(&host), 1);
}

static void what_is_not_fetched_stops_the_line(void)
{
    begin();
    CHECK_INT(gx_host_receive(&host, "=x1\n=x2\n", 8, now), 4);
    CHECK_INT(gx_host_receive(&host, "=x2\n", 4, now), 0);
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    CHECK_INT(event.position.axes[0], 1);
    CHECK_INT(gx_host_receive(&host, "=x2\n", 4, now), 4);
    CHECK_INT(kind_of_event(), GX_HOST_REPORT);
    CHECK_INT(event.position.axes[0], 2);
}

static void all_zero_is_a_session(void)
{
    memset(&host, 0, sizeof host);
    now = 0;
    CHECK_INT(gx_host_next_deadline(&host, now), -1);
    move(1, 0, 1, -1);
    CHECK_INT(gx_host_next_deadline(&host, now), 0);
    nothing_happens();
    SAYS("\x1B#\x80\x80~\x80\x80");
    CHECK_INT(gx_host_next_deadline(&host, now), 250);
}

int main(void)
{
    all_zero_is_a_session();
    if (GX_WINDOW_MAX >= 6)
        moves_take_the_shortest_form();
    if (GX_WINDOW_MAX >= 2) {
        in_ascii();
        reports_are_compared_with_the_plan();
        a_mere_echo_is_driven_if_that_is_set();
    }
    every_so_manieth_move_is_absolute();
    if (GX_WINDOW_MAX >= 4) {
        confirmations_are_compared_with_the_plan();
        hosts_ask_past_the_queue();
        errors_have_all_sent_again_in_long_form();
        silence_has_the_newest_sent_again_until_time_is_out();
        refused_for_good();
        no_room_and_then_room();
        the_machine_stops();
    }
    without_the_first_number_before_the_second_none_begins();
    with_a_mere_echo_no_session_begins();
    a_move_that_lasts_too_long_times_out();
    strays_change_nothing();
    what_is_not_fetched_stops_the_line();
    return check_summary("gx_host");
}
