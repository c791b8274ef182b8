/* gx_motion.h alone, by hand-written bytes: what is taken and refused, what is told, and what garbage does. */
#include "libdeltarobot/gx_motion.h"

#include "check.h"

static struct gx_motion motion;
static unsigned long now;

#define FEED(bytes) feed(bytes, (int)sizeof(bytes) - 1)
#define SAYS(bytes) CHECK(says(bytes, (int)sizeof(bytes) - 1))

static void begin(int axes, int only_in_order)
{
    struct gx_motion_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.axes = axes;
    settings.only_in_order = only_in_order;
    memset(&motion, 0xA5, sizeof motion);
    CHECK_INT(gx_motion_init(&motion, &settings), GX_RC_SUCCESS);
}

/* All bytes, byte by byte: gives the last event's kind, and the event. */
static struct gx_motion_event event;

static int feed(const void *bytes, int count)
{
    int i, kind = 0;
    for (i = 0; i < count; ++i) {
        struct gx_motion_event next;
        while (gx_motion_receive(&motion, (const char *)bytes + i, 1, now) == 0)
            if (!CHECK(gx_motion_poll(&motion, now, &next) == GX_RC_SUCCESS))
                return -1;
        while (gx_motion_poll(&motion, now, &next) == GX_RC_SUCCESS) {
            event = next;
            kind = event.kind;
        }
        CHECK_INT(next.kind, 0);
    }
    return kind;
}

static struct gx_motion_health health(void)
{
    struct gx_motion_health copy;
    memset(&copy, 0xA5, sizeof copy);
    CHECK_INT(gx_motion_get_health(&motion, &copy), GX_RC_SUCCESS);
    return copy;
}

static int says(const char *expected, int count)
{
    unsigned char out[256];
    int got = gx_motion_output(&motion, out, sizeof out, now);
    if (got == count && memcmp(out, expected, (size_t)count) == 0)
        return 1;
    check_dump("said", out, got < 0 ? 0 : (size_t)got);
    return 0;
}

/* What a move of a session is confirmed by: of the axes named in the session, these two are not 0. */
static char expected[128];
static int expected_size;

static void confirmed(int number, int format, int named, int velocity, long x, long y)
{
    struct gx_vector target;
    struct gx_number its_number;
    memset(&target, 0, sizeof target);
    target.mask = (unsigned char)named;
    target.velocity = (uint16_t)velocity;
    target.axes[0] = (int32_t)x;
    target.axes[1] = (int32_t)y;
    its_number.value = (uint16_t)number;
    its_number.format = (unsigned char)format;
    expected_size += gx_write_confirmed(&its_number, gx_check(&target, number), expected + expected_size,
                                        (int)sizeof expected - expected_size);
}

static int says_expected(const char *behind)
{
    strcpy(expected + expected_size, behind);
    expected_size = 0;
    return says(expected, (int)strlen(expected));
}

/* Where packed bytes have no zeros, and text neither. */
#define CONFIRMS(number, format, named, velocity, x, y)                                                                \
    do {                                                                                                               \
        confirmed(number, format, named, velocity, x, y);                                                              \
        CHECK(says_expected(""));                                                                                      \
    } while (0)

/* As a host that begins a session does, from number 10923: 0 lies 5461 behind it, so the first move is 1. */
static void open_session(void)
{
    CHECK_INT(FEED("#10923R0\n"), GX_MOTION_REPORTING);
    SAYS("#10923\n");
    CHECK_INT(FEED("#0R0\n"), GX_MOTION_BEGUN);
    CHECK_INT(event.number, 0);
    SAYS("#10923\n#0\n");
}

static int goes(int mask, int number, long x, long y)
{
    struct gx_vector move;
    int its_number;
    memset(&move, 0x77, sizeof move);
    if (!CHECK_INT(gx_motion_next(&motion, &move, &its_number), GX_RC_SUCCESS))
        return 0;
    return CHECK_INT(move.mask, mask) & CHECK_INT(its_number, number) & CHECK_INT(move.axes[0], x) &
           CHECK_INT(move.axes[1], y);
}

static void done(void)
{
    CHECK_INT(gx_motion_done(&motion), GX_RC_SUCCESS);
}

static int carries_out(int mask, int number, long x, long y)
{
    return goes(mask, number, x, y) && CHECK_INT(gx_motion_done(&motion), GX_RC_SUCCESS);
}

/* The proposal's own moves, without numbers. */
static void moves_add_up_and_velocity_sticks(void)
{
    struct gx_vector move;
    begin(0, 0);
    CHECK_INT(FEED("\x21\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF"), GX_MOTION_QUEUED);
    CHECK_INT(event.number, -1);
    CHECK_INT(FEED("\x2A\x83\x81\xFF"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("V1000x400y300\n"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("\x2A\x82\x81"), GX_MOTION_QUEUED);
    CHECK_INT(gx_motion_unfinished(&motion), 4);
    CHECK_INT(gx_motion_done(&motion), GX_RC_NO_EVENT); /* none was fetched */
    CHECK(goes(0x03, -1, 1000, -1000));
    CHECK(goes(0x03, -1, 1001, -1001));
    CHECK(goes(0x43, -1, 400, 300));
    CHECK_INT(gx_motion_next(&motion, &move, NULL), GX_RC_SUCCESS);
    CHECK_INT(move.mask, 0x42); /* y alone; x stays, and so does the velocity */
    CHECK_INT(move.axes[0], 400);
    CHECK_INT(move.axes[1], 301);
    CHECK_INT(move.velocity, 1000);
    CHECK_INT(gx_motion_next(&motion, &move, NULL), GX_RC_NO_EVENT);
    done();
    done();
    done();
    done();
    CHECK_INT(gx_motion_done(&motion), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_unfinished(&motion), 0);
    SAYS(""); /* nobody asked for the ends */
    CHECK_INT(gx_motion_next_deadline(&motion, now + 5000), 0); /* the gap is over */
    CHECK_INT(gx_motion_poll(&motion, now + 5000, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_next_deadline(&motion, now + 5000), -1);
}

static void a_step_from_nowhere_or_out_of_range_is_refused(void)
{
    int32_t at[GX_AXES] = {0, 0, 0, 0, 0, 0};
    begin(0, 0);
    CHECK_INT(FEED("\x2A\x81\x81"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_LIMIT);
    SAYS("\n?\x88");
    at[0] = 5;
    CHECK_INT(gx_motion_set_position(&motion, at), GX_RC_SUCCESS);
    CHECK_INT(FEED("\x2A\x81\x81"), GX_MOTION_QUEUED);
    CHECK(goes(0x01, -1, 6, 0));
    /* What the firmware says is no longer what deltas are added to. */
    at[0] = 1000;
    CHECK_INT(gx_motion_set_position(&motion, at), GX_RC_SUCCESS);
    CHECK_INT(FEED("\x2A\x81\x81"), GX_MOTION_QUEUED);
    CHECK(goes(0x01, -1, 7, 0));
    CHECK_INT(FEED("x134217727y-134217728\n"), GX_MOTION_QUEUED);
    CHECK(goes(0x03, -1, GX_POSITION_MAX, GX_POSITION_MIN));
    CHECK_INT(FEED("\x2A\x83\x81\x81"), GX_MOTION_REFUSED);
    SAYS("\n?\x88");
    CHECK_INT(FEED("\x2A\x83\xFF\xFF"), GX_MOTION_REFUSED);
    SAYS("\n?\x88");
    CHECK_INT(FEED("\x2A\x83\xFF\x81"), GX_MOTION_QUEUED); /* neither has moved anything */
    CHECK(goes(0x03, -1, GX_POSITION_MAX - 1, GX_POSITION_MIN + 1));
    at[5] = GX_POSITION_MAX + 1;
    CHECK_INT(gx_motion_set_position(&motion, at), GX_RC_ERROR_GENERIC);
    at[5] = GX_POSITION_MIN - 1;
    CHECK_INT(gx_motion_set_position(&motion, at), GX_RC_ERROR_GENERIC);
}

static void numbers_count_in_a_session(int only_in_order)
{
    begin(0, only_in_order);
    if (only_in_order) {
        CHECK_INT(FEED("#\x81\x80\x21\x81\x85\x80\x80\x80"), GX_MOTION_REFUSED);
        CHECK_INT(event.code, GX_FAULT_CLOSED);
        CHECK_INT(event.number, 1);
        SAYS("#\x81\x80?\x91");
        CHECK_INT(FEED("x1\n"), GX_MOTION_REFUSED);
        SAYS("\n?18\n");
    } else {
        CHECK_INT(FEED("#\xAA\xD5~\x80\x80"), GX_MOTION_REPORTING); /* 10922 */
        CHECK_INT(event.number, -1);
        SAYS("#\xAA\xD5");
    }
    CHECK_INT(FEED("#\xFF\xFF~\x80\x80"), GX_MOTION_BEGUN); /* 16383: the next is 0 */
    CHECK_INT(event.number, 16383);
    if (only_in_order)
        SAYS("#\xFF\xFF");
    else
        SAYS("#\xAA\xD5#\xFF\xFF");
    CHECK_INT(FEED("#\x80\x80\x21\x81\x85\x80\x80\x80"), GX_MOTION_QUEUED);
    /* 1 is lost: 2 is refused, 3 goes with it without a word, and so does what has no number. */
    CHECK_INT(FEED("#\x82\x80\x2A\x81\x81"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_ORDER);
    SAYS("#\x82\x80?\x90");
    CHECK_INT(FEED("#\x83\x80\x2A\x81\x81"), GX_MOTION_REFUSED);
    SAYS("");
    CHECK_INT(FEED("\x2A\x81\x81"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_NUMBERLESS);
    SAYS("\n?\x92");
    /* The host goes back, and 1 is lost again. */
    CHECK_INT(FEED("#\x82\x80\x21\x81\x87\x80\x80\x80"), GX_MOTION_REFUSED);
    SAYS("#\x82\x80?\x90");
    CHECK_INT(FEED("#\x81\x80\x21\x81\x86\x80\x80\x80"), GX_MOTION_QUEUED);
    /* It goes on, and 2 is lost. */
    CHECK_INT(FEED("#\x83\x80\x2A\x81\x81"), GX_MOTION_REFUSED);
    SAYS("#\x83\x80?\x90");
    CHECK_INT(FEED("#\x82\x80\x2A\x81\x81"), GX_MOTION_QUEUED);
    CHECK(goes(0x01, 0, 5, 0));
    CHECK(goes(0x01, 1, 6, 0));
    CHECK(carries_out(0x01, 2, 7, 0));
    CONFIRMS(0, GX_BINARY, 1, 0, 5, 0);
    /* Again what is done, and what is not. */
    CHECK_INT(FEED("#\x80\x80\x21\x81\x85\x80\x80\x80"), GX_MOTION_REPEATED);
    SAYS("#\x80\x80");
    CHECK_INT(FEED("#\x82\x80\x2A\x81\x81"), GX_MOTION_REPEATED);
    SAYS("=!\xBF\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80");
    done();
    done();
    confirmed(1, GX_BINARY, 1, 0, 6, 0);
    CONFIRMS(2, GX_BINARY, 1, 0, 7, 0);
    /* The newest one again: with its check. */
    CHECK_INT(FEED("#\x82\x80\x21\x81\x87\x80\x80\x80"), GX_MOTION_REPEATED);
    CONFIRMS(2, GX_BINARY, 1, 0, 7, 0);
    CHECK_INT(gx_motion_next(&motion, &(struct gx_vector){0, 0, {0}}, NULL), GX_RC_NO_EVENT);
    CHECK_INT((long)health().moves, 3);
    CHECK_INT((long)health().repeats, 3);
    CHECK_INT((long)health().refused, only_in_order ? 7 : 5);
    /* ESC clears what has come; twice, it ends the session. */
    CHECK_INT(FEED("#\x83\x80\x1B#\x83\x80\x2A\x81\x81"), GX_MOTION_QUEUED);
    if (only_in_order) {
        CHECK_INT(FEED("\x1B\x1B#\x84\x80\x2A\x81\x81"), GX_MOTION_REFUSED);
        CHECK_INT(event.code, GX_FAULT_CLOSED);
    } else {
        CHECK_INT(FEED("\x1B\x1B#\x90\x80\x2A\x81\x81"), GX_MOTION_QUEUED);
        CHECK_INT(FEED("x0\n"), GX_MOTION_QUEUED);
    }
}

/* What begins a session is two requests with numbers 5461 apart, and nothing else. */
static void nothing_else_begins_a_session(void)
{
    static const char *const NO_OPENINGS[] = {
        "#1R0\n", "#1R0\n#1R0\n", "#1R0\n#5461R0\n#5463R0\n", "#5462R0\n#1R0\n", "#1R0\nx0\n#5462R0\n",
        "#1R0\n#2x0\n#5462R0\n", "#1R0\nR0\n#5462R0\n", "#1R0\n#7R0\n#5462R0\n", "#1R0\n\x1B\x1B#5462R0\n",
        "#1x0\n#5462x0\n", "#1R0\nR0\n#5462x0\n", "R0\n#5461R0\n"
    };
    unsigned i;
    for (i = 0; i < sizeof NO_OPENINGS / sizeof *NO_OPENINGS; ++i) {
        unsigned char out[64];
        begin(0, 0);
        feed(NO_OPENINGS[i], (int)strlen(NO_OPENINGS[i]));
        gx_motion_output(&motion, out, sizeof out, now);
        if (!CHECK_INT(FEED("#9000x1\n"), GX_MOTION_QUEUED))
            fprintf(stderr, "    %s", NO_OPENINGS[i]);
    }
    /* What waits to be told is nobody's any more. */
    begin(0, 0);
    CHECK_INT(FEED("#1R0\n#1R0\n#5462R0\n"), GX_MOTION_BEGUN);
    SAYS("#1\n#5462\n");
    /* What gets lost on the way there and back is sent again. */
    begin(0, 0);
    FEED("#1R0\n#1R0\n");
    SAYS("#1\n#1\n");
    FEED("#546\n");
    SAYS("#546?5\n");
    CHECK_INT(FEED("#5462R0\n"), GX_MOTION_BEGUN);
    SAYS("#1\n#5462\n");
    CHECK_INT(FEED("#5462R0\n"), GX_MOTION_BEGUN);
    SAYS("#1\n#5462\n");
    CHECK_INT(FEED("#5463x0\n"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("#9000x0\n"), GX_MOTION_REFUSED);
    SAYS("#9000?16\n");
    /* Behind moves, a session begins by one. */
    CHECK_INT(FEED("#8999R0\n"), GX_MOTION_BEGUN);
    SAYS("#8999\n");
    CHECK_INT(FEED("#9000x0\n"), GX_MOTION_QUEUED);
}

static void ascii_is_answered_in_ascii(void)
{
    begin(3, 1);
    CHECK_INT(FEED("#12 R0\n"), GX_MOTION_BEGUN);
    SAYS("#12\n");
    CHECK_INT(FEED("#13 V1000x400y300\r\n"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("#15x1\n"), GX_MOTION_REFUSED);
    SAYS("#15?16\n");
    CHECK_INT(FEED("x1\n"), GX_MOTION_REFUSED);
    SAYS("\n?18\n");
    CHECK_INT(FEED("#14 z1\n"), GX_MOTION_REFUSED);
    SAYS("#14?19\n");
    CHECK_INT(FEED("#14 x1q\n"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_SYNTAX);
    SAYS("#14?4\n");
    CHECK(carries_out(0x43, 13, 400, 300));
    CONFIRMS(13, GX_ASCII, 0x43, 1000, 400, 300);
    /* The number's format is the notice's, whatever the command's. */
    CHECK_INT(FEED("#14 \x2A\x81\x81"), GX_MOTION_QUEUED);
    CHECK(carries_out(0x41, 14, 401, 300));
    CONFIRMS(14, GX_ASCII, 0x43, 1000, 401, 300);
}

static void a_velocity_alone_ends_in_its_turn(void)
{
    begin(0, 0);
    open_session();
    CHECK_INT(FEED("#1 V7\n"), GX_MOTION_QUEUED);
    CONFIRMS(1, GX_ASCII, 0x40, 7, 0, 0); /* nothing to wait for */
    CHECK_INT(FEED("#2 x1\n#3 V8\n#4 x2\n"), GX_MOTION_QUEUED);
    SAYS("");
    CHECK(goes(0x41, 2, 1, 0));
    CHECK(carries_out(0x41, 4, 2, 0));
    confirmed(2, GX_ASCII, 0x41, 7, 1, 0);
    CONFIRMS(3, GX_ASCII, 0x41, 8, 1, 0);
    done();
    CONFIRMS(4, GX_ASCII, 0x41, 8, 2, 0);
    CHECK_INT(gx_motion_unfinished(&motion), 0);
}

static void a_full_queue_refuses(void)
{
    char text[32];
    int i;
    begin(0, 0);
    open_session();
    for (i = 1; i <= GX_QUEUE_MAX; ++i)
        CHECK_INT(feed(text, sprintf(text, "#%d x%d\n", i, i)), GX_MOTION_QUEUED);
    CHECK_INT(feed(text, sprintf(text, "#%d x%d\n", i, i)), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_BUSY);
    CHECK(says(text, sprintf(text, "#%d?9\n", i)));
    CHECK(carries_out(0x01, 1, 1, 0));
    CONFIRMS(1, GX_ASCII, 1, 0, 1, 0);
    CHECK_INT(feed(text, sprintf(text, "#%d x%d\n", i, i)), GX_MOTION_QUEUED);
    for (i = 2; i <= GX_QUEUE_MAX + 1; ++i) {
        CHECK(carries_out(0x01, i, i, 0));
        CONFIRMS(i, GX_ASCII, 1, 0, i, 0);
    }
}

static void a_stop_drops_everything(void)
{
    begin(0, 0);
    open_session();
    FEED("#1 x1y1\n#2 x2\n#3 x3\n");
    CHECK(goes(0x03, 1, 1, 1));
    CHECK(carries_out(0x01, 2, 2, 1));
    CHECK_INT(gx_motion_stop(&motion, 63), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_stop(&motion, 128), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_stop(&motion, -1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_motion_stop(&motion, 64), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS); /* nothing more to tell */
    confirmed(1, GX_ASCII, 3, 0, 1, 1);
    CHECK(says_expected("#2?64\n"));
    CHECK_INT(gx_motion_unfinished(&motion), 0);
    CHECK_INT(gx_motion_done(&motion), GX_RC_NO_EVENT);
    /* What the host has sent before it heard of that. */
    CHECK_INT(FEED("#3 x3\n"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_CLOSED);
    CHECK_INT(FEED("#4 x3\n"), GX_MOTION_REFUSED);
    CHECK_INT(FEED("x3\n"), GX_MOTION_REFUSED);
    SAYS("#3?17\n#4?17\n\n?18\n");
    CHECK_INT(FEED("#3R0\n"), GX_MOTION_BEGUN);
    CHECK_INT(FEED("#4 \x2A\x81\x81"), GX_MOTION_REFUSED); /* where it stands is not known */
    SAYS("#3\n#4?\x88");
    CHECK_INT(FEED("#4 x3\n"), GX_MOTION_QUEUED);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    SAYS("#4?20\n");
    /* Another host, without sessions. */
    CHECK_INT(FEED("\x1B\x1Bx9\n"), GX_MOTION_QUEUED);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    SAYS(""); /* it had no number */
    CHECK_INT(FEED("#9x9\n"), GX_MOTION_QUEUED);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    SAYS("#9?20\n");
    CHECK_INT(FEED("x9\n"), GX_MOTION_QUEUED);
}

static void a_host_holds_resumes_and_stops(void)
{
    static const int32_t AT[GX_AXES] = {33, 1, 0, 0, 0, 0};
    struct gx_vector move;
    begin(3, 0);
    open_session();
    FEED("#1 V500x100y1\n#2 x200\n#3 V900x300\n");
    CHECK(goes(0x43, 1, 100, 1));
    CHECK_INT(FEED("%\xFF\x80"), 0); /* a query alone */
    CHECK(says("%\x8D\x80", 3) || GX_QUEUE_MAX != 16);
    CHECK_INT(FEED("%254\n"), GX_MOTION_HOLD);
    CHECK_INT(gx_motion_next(&motion, &move, NULL), GX_RC_NO_EVENT);
    CHECK(says("%269\n", 5) || GX_QUEUE_MAX != 16); /* 256 and 13 */
    CHECK_INT(gx_motion_next_deadline(&motion, now + 5000), 0); /* the gap alone */
    done(); /* it came to its end before it stood */
    CHECK_INT(FEED("#4 x400\n"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("#5 %381\n"), GX_MOTION_RESUME);
    confirmed(1, GX_ASCII, 0x43, 500, 100, 1);
    CHECK(says_expected("#5\n%13\n") || GX_QUEUE_MAX != 16);
    CHECK(goes(0x41, 2, 200, 1));
    /* ESC ESC or another session stop nothing, this does. */
    CHECK_INT(FEED("%\xFC\x83"), GX_MOTION_STOP);
    CHECK_INT(event.code, GX_FAULT_STOPPED);
    CHECK_INT(gx_motion_next(&motion, &move, NULL), GX_RC_NO_EVENT);
    SAYS("");
    CHECK_INT(gx_motion_set_position(&motion, AT), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    SAYS("#2?20\n=!\xC3\x84\x87\xA1\x80\x80\x80\x81\x80\x80\x80"); /* 900 holds, as the last that was taken */
    CHECK_INT(gx_motion_unfinished(&motion), 0);
    CHECK_INT(FEED("#5 x3\n"), GX_MOTION_REFUSED);
    SAYS("#5?17\n");
    CHECK_INT(FEED("#6R0\n"), GX_MOTION_BEGUN);
    CHECK_INT(FEED("#7 x3\n"), GX_MOTION_QUEUED);
    CHECK(goes(0x41, 7, 3, 1));
    SAYS("#6\n");
    /* The host has not heard of it, and asks again. */
    CHECK_INT(FEED("%508\n"), GX_MOTION_STOP);
    CHECK_INT(FEED("%254\n%381\n"), GX_MOTION_RESUME);
    CHECK_INT(gx_motion_next(&motion, &move, NULL), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_stop(&motion, 99), GX_RC_SUCCESS);
    SAYS("#7?99\n=V900x33y1\n");
    /* What is not known is refused. */
    CHECK_INT(FEED("#9%3\n"), GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_UNKNOWN);
    SAYS("#9?1\n");
    /* A stop by the firmware alone says nothing of positions. */
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    SAYS("");
}

static void a_silent_host_stops_the_machine(void)
{
    struct gx_motion_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.host_ms = 700;
    settings.gap_ms = 100;
    CHECK_INT(gx_motion_init(&motion, &settings), GX_RC_SUCCESS);
    now = 0xFFFFFFFFul - 300;
    CHECK_INT(FEED("#5 x9\n"), GX_MOTION_QUEUED);
    CHECK_INT(gx_motion_poll(&motion, (now + 100) & 0xFFFFFFFFul, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_next_deadline(&motion, (now + 100) & 0xFFFFFFFFul), 600);
    now = (now + 699) & 0xFFFFFFFFul;
    CHECK_INT(FEED("\n"), 0); /* anything will do */
    now = (now + 699) & 0xFFFFFFFFul;
    CHECK_INT(gx_motion_poll(&motion, now, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_next_deadline(&motion, now), 1);
    now += 1;
    CHECK_INT(gx_motion_poll(&motion, now, &event), GX_RC_SUCCESS);
    CHECK_INT(event.kind, GX_MOTION_STOP);
    CHECK_INT(event.code, GX_FAULT_SILENT);
    CHECK_INT(gx_motion_poll(&motion, now, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_stop(&motion, 0), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_next_deadline(&motion, now), 0);
    SAYS("#5?20\n=!\xFF\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80");
    /* Nothing is left to stop. */
    now += 100000;
    CHECK_INT(gx_motion_poll(&motion, now, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_next_deadline(&motion, now), -1);
    now = 0;
}

static void a_new_session_silences_the_old_one(void)
{
    begin(0, 0);
    open_session();
    FEED("#1 x1\n#2 x2\n");
    CHECK(carries_out(0x01, 1, 1, 0));
    FEED("#5000R0\n");
    SAYS("#5000\n");
    CHECK_INT(FEED("#5001 x3\n"), GX_MOTION_QUEUED);
    CHECK(goes(0x01, -1, 2, 0)); /* carried out all the same */
    CHECK(carries_out(0x01, 5001, 3, 0));
    SAYS("");
    done();
    CONFIRMS(5001, GX_ASCII, 1, 0, 3, 0);
}

/* A host that knows the proposal and nothing more, from power-up on: `settings` NULL. */
static void hosts_number_as_they_like(void)
{
    static const int32_t AT[GX_AXES] = {0, 0, 0, 0, 0, 0};
    memset(&motion, 0xA5, sizeof motion);
    CHECK_INT(gx_motion_init(&motion, NULL), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_set_position(&motion, AT), GX_RC_SUCCESS);
    CHECK_INT(FEED("#12 V1000x400y300\n"), GX_MOTION_QUEUED);
    CHECK_INT(event.number, 12);
    CHECK(goes(0x43, 12, 400, 300));
    SAYS("");
    done();
    SAYS("#12\n");
    /* The same number again, in another form, a higher and a lower one, none; reports by a number. */
    CHECK_INT(FEED("#\x8C\x80\x2A\x83\x81\xFF"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("#12 \x2A\x81\x81"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("\x21\x82\x85\x80\x80\x80"), GX_MOTION_QUEUED);
    CHECK_INT(FEED("#16383R100\n"), GX_MOTION_REPORTING);
    CHECK_INT(event.period, 100);
    SAYS("#16383\n=x0y0z0a0b0c0\n");
    CHECK_INT(FEED("#0x0\n"), GX_MOTION_QUEUED);
    CHECK(carries_out(0x43, 12, 401, 299));
    SAYS("#\x8C\x80");
    /* An error notice is about this command alone. */
    CHECK_INT(FEED("#5 x1x2\n"), GX_MOTION_REFUSED);
    CHECK_INT(FEED("#3 x1q\n"), GX_MOTION_REFUSED);
    SAYS("#5?6\n#3?4\n");
    CHECK_INT(FEED("#4 x2\n"), GX_MOTION_QUEUED);
    CHECK(carries_out(0x41, 12, 402, 299));
    CHECK(carries_out(0x42, -1, 402, 5));
    CHECK(carries_out(0x41, 0, 0, 5));
    CHECK(carries_out(0x41, 4, 2, 5));
    SAYS("#12\n#0\n#4\n");
    CHECK_INT(FEED("#\x80\x80~\x80\x80"), GX_MOTION_REPORTING);
    SAYS("#\x80\x80");
    CHECK_INT(FEED("x7\n"), GX_MOTION_QUEUED);
    CHECK_INT((long)health().refused, 0);
    CHECK_INT((long)health().repeats, 0);
}

static void positions_are_reported_periodically(void)
{
    static const int32_t AT[GX_AXES] = {400, -1, 3, 0, 0, GX_POSITION_MIN};
    begin(3, 0);
    now = 0xFFFFFFFFul - 99;
    CHECK_INT(gx_motion_set_position(&motion, AT), GX_RC_SUCCESS);
    CHECK_INT(FEED("R200\n"), GX_MOTION_REPORTING);
    CHECK_INT(event.period, 200);
    CHECK_INT(gx_motion_next_deadline(&motion, now), 0);
    SAYS("=x400y-1\n");
    SAYS("");
    CHECK_INT(gx_motion_next_deadline(&motion, now), 200);
    now = 100; /* 200 later */
    SAYS("=x400y-1\n");
    now = 299;
    SAYS("");
    CHECK_INT(FEED("~\xE8\x87"), GX_MOTION_REPORTING);
    CHECK_INT(event.period, 1000);
    SAYS("=!\x83\x90\x83\x80\x80\xFF\xFF\xFF\xFF");
    CHECK_INT(FEED("~\x80\x80"), GX_MOTION_REPORTING);
    now = 50000;
    SAYS("");
    CHECK_INT((long)health().reports, 3);
    now = 0;
}

static void what_is_not_fetched_stops_the_line(void)
{
    unsigned char out[64];
    begin(0, 0);
    CHECK_INT(gx_motion_receive(&motion, "x1\nx2\n", 6, 0), 3);
    CHECK_INT(gx_motion_receive(&motion, "x2\n", 3, 0), 0);
    CHECK_INT(gx_motion_poll(&motion, 0, &event), GX_RC_SUCCESS);
    CHECK_INT(gx_motion_receive(&motion, "x2\n", 3, 0), 3);
    CHECK_INT(gx_motion_poll(&motion, 0, &event), GX_RC_SUCCESS);
    FEED("q\nq\nq");
    CHECK_INT(gx_motion_receive(&motion, "x3\n", 3, 0), 0); /* error notices wait */
    CHECK_INT(gx_motion_output(&motion, out, 3, 0), 0);     /* each of which takes four bytes */
    CHECK_INT(gx_motion_output(&motion, out, 5, 0), 4);
    CHECK_INT(gx_motion_output(&motion, out, 64, 0), 8);
    CHECK_INT(gx_motion_receive(&motion, "x3\n", 3, 0), 3);
}

static void half_a_command_is_given_up(void)
{
    begin(0, 0);
    now = 10;
    CHECK_INT(FEED("#\x81\x80\x21\x83\xE8"), 0);
    CHECK_INT(gx_motion_next_deadline(&motion, 20), 990);
    CHECK_INT(gx_motion_poll(&motion, 1009, &event), GX_RC_NO_EVENT);
    CHECK_INT(gx_motion_poll(&motion, 1010, &event), GX_RC_SUCCESS);
    CHECK_INT(event.kind, GX_MOTION_REFUSED);
    CHECK_INT(event.code, GX_FAULT_INTERRUPTED);
    CHECK_INT(event.number, 1);
    SAYS("#\x81\x80?\x83");
    CHECK_INT((long)health().malformed, 1);
    now = 0;
}

static void all_zero_is_a_motion_side(void)
{
    memset(&motion, 0, sizeof motion);
    CHECK_INT(gx_motion_next_deadline(&motion, now), -1);
    CHECK_INT(FEED("#5 x7\n"), GX_MOTION_QUEUED);
    CHECK(carries_out(0x01, 5, 7, 0));
    SAYS("#5\n");
}

int main(void)
{
    all_zero_is_a_motion_side();
    /* What these queue has to fit. */
    if (GX_QUEUE_MAX >= 5) {
        moves_add_up_and_velocity_sticks();
        a_step_from_nowhere_or_out_of_range_is_refused();
        numbers_count_in_a_session(0);
        numbers_count_in_a_session(1);
        nothing_else_begins_a_session();
        a_velocity_alone_ends_in_its_turn();
        a_stop_drops_everything();
        a_host_holds_resumes_and_stops();
        a_new_session_silences_the_old_one();
        hosts_number_as_they_like();
        what_is_not_fetched_stops_the_line();
    }
    ascii_is_answered_in_ascii();
    a_full_queue_refuses();
    positions_are_reported_periodically();
    half_a_command_is_given_up();
    a_silent_host_stops_the_machine();
    return check_summary("gx_motion");
}
