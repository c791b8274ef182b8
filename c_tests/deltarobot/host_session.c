/* host.h, operations: what is sent when, what each answer means, how they end. The times are the defaults'. */
#include "host_steps.h"

#if HOST_WORKS

/* A move that was sent and accepted. */
static void move_accepted(void)
{
    begin();
    CHECK_INT(dp_host_move(&host, &TARGET), DP_RC_SUCCESS);
    CHECK(sends("M"));
    pass(5);
    comes('A', "M", 1);
    CHECK(tells(DP_HOST_ACCEPTED, 'M', 0));
    CHECK(tells_nothing());
}

static void finishes_as_specified(void)
{
    begin();
    CHECK_INT(dp_host_home(&host), DP_RC_SUCCESS);
    CHECK_INT(dp_host_busy(&host), 1);
    CHECK_INT(dp_host_home(&host), DP_RC_BUSY);
    CHECK_INT(dp_host_move(&host, &TARGET), DP_RC_BUSY);
    CHECK(sends("H"));
    comes('m', "", 0); /* of something else, and too early */
    comes('h', "", 0);
    CHECK(tells_nothing());
    comes('A', "H", 1);
    CHECK(tells(DP_HOST_ACCEPTED, 'H', 0));
    comes('m', "", 0);
    CHECK(tells_nothing());
    comes('h', "", 0);
    CHECK_INT(dp_host_busy(&host), 1);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_FINISHED));
    CHECK_INT(dp_host_busy(&host), 0);
    comes('h', "", 0);
    comes_report(DP_STATUS_IDLE, 0);
    CHECK(tells_nothing());
    CHECK(sends(""));
    CHECK_INT(dp_host_next_deadline(&host, now), -1);
}

static void finishes_like_shipped_firmware(void)
{
    move_accepted();
    comes_report(DP_STATUS_IDLE, 0); /* right behind the ack: does not run yet */
    CHECK(tells_nothing());
    comes_report(DP_STATUS_MOVING, 0.5f);
    CHECK_INT(dp_host_poll(&host, now, &event), DP_RC_SUCCESS);
    CHECK_INT(event.kind, DP_HOST_STATUS);
    CHECK_INT(event.state, DP_STATUS_MOVING);
    CHECK_INT(event.report.STAT, DP_STATUS_MOVING);
    CHECK(event.report.DC == -1.75f);
    CHECK_INT(dp_host_poll(&host, now, &event), DP_RC_SUCCESS);
    CHECK_INT(event.kind, DP_HOST_STATE);
    CHECK_INT(event.state, DP_STATUS_MOVING);
    CHECK(tells_nothing());
    comes_report(DP_STATUS_IDLE, 1.01f);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));
    comes_report(DP_STATUS_IDLE, 1);
    comes('m', "", 0);
    CHECK(tells_nothing());
}

/* It is over before anybody saw it run: believed when the motors had time enough to begin. */
static void finishes_unseen(void)
{
    move_accepted();
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells_nothing());
    pass(199);
    CHECK(tells_nothing());
    CHECK_INT(dp_host_next_deadline(&host, now), 1);
    CHECK(sends(""));
    pass(1);
    CHECK(sends("S"));
    pass(299);
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells_nothing());
    pass(1);
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));
}

static void fails(void)
{
    move_accepted(); /* stands elsewhere */
    comes_report(DP_STATUS_MOVING, 0.5f);
    comes_report(DP_STATUS_IDLE, 0.5f);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FAILED));
    move_accepted(); /* was reset */
    comes_report(DP_STATUS_MOVING, 0.5f);
    comes_report(DP_STATUS_IDLE, -1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FAILED));
    move_accepted();
    comes_report(DP_STATUS_ERROR, 0.5f);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FAILED));
    move_accepted();
    comes('e', "", 0);
    CHECK(tells(DP_HOST_ERROR, 0, 0));
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FAILED));
    CHECK(tells_nothing());

    begin(); /* an error instead of an answer: not repeated */
    dp_host_home(&host);
    CHECK(sends("H"));
    comes('e', "", 0);
    CHECK(tells(DP_HOST_ERROR, 0, 0));
    pass(250);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_FAILED));
    CHECK(sends(""));
}

static void is_refused(void)
{
    begin();
    dp_host_move(&host, &TARGET);
    CHECK(sends("M"));
    comes('N', "H", 1); /* of another opcode */
    comes('A', "C", 1);
    CHECK(tells_nothing());
    comes('N', "M", 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_REFUSED));
    CHECK(tells_nothing());
    CHECK_INT(healthy()->strays, 2);
}

static void is_repeated_and_times_out(void)
{
    int i;
    begin();
    dp_host_move(&host, &TARGET);
    for (i = 0; i < 4; ++i) {
        CHECK(sends("M"));
        CHECK_INT(dp_host_next_deadline(&host, now), 250);
        pass(249);
        CHECK(tells_nothing());
        CHECK(sends(""));
        pass(1);
    }
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));
    CHECK(sends(""));
    CHECK_INT(healthy()->timeouts, 4);
    CHECK_INT(health.retransmissions, 3);

    /* A late ack is nobody's, and the next request waits until none can come any more. */
    dp_host_home(&host);
    comes('A', "M", 1);
    CHECK(tells_nothing());
    CHECK(sends(""));
    CHECK_INT(dp_host_next_deadline(&host, now), 250);
    pass(250);
    CHECK(sends("H"));
}

/* As often as the settings say: 1 to 255 times, and once when they say less. */
static void is_sent_as_often_as_the_settings_say(void)
{
    static const int ATTEMPTS[][2] = {{-1, 1}, {1, 1}, {2, 2}, {255, 255}, {1000, 255}};
    size_t i;
    int sent;
    for (i = 0; i < sizeof ATTEMPTS / sizeof ATTEMPTS[0]; ++i) {
        struct dp_host_settings settings;
        memset(&settings, 0, sizeof settings);
        settings.attempts = ATTEMPTS[i][0];
        begin();
        dp_host_init(&host, &settings);
        dp_host_home(&host);
        for (sent = 0; sent < ATTEMPTS[i][1]; ++sent) {
            CHECK(tells_nothing());
            CHECK(sends("H"));
            pass(250);
        }
        CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_TIMED_OUT));
    }
}

/* The ack of the first sending comes after the second. */
static void late_ack_accepts_once(void)
{
    begin();
    dp_host_home(&host);
    CHECK(sends("H"));
    pass(250);
    CHECK(sends("H"));
    pass(10);
    comes('A', "H", 1);
    CHECK(tells(DP_HOST_ACCEPTED, 'H', 0));
    comes('A', "H", 1);
    CHECK(tells_nothing());
    /* The repeat may start it once more: nothing is over before that is ruled out. */
    comes('h', "", 0);
    comes_report(DP_STATUS_HOMING, 0);
    comes_report(DP_STATUS_IDLE, 0);
    CHECK(tells_nothing());
    pass(490);
    comes_report(DP_STATUS_IDLE, 0);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_FINISHED));
    CHECK_INT(healthy()->rtt_count, 0);
}

static void a_repeat_is_refused(void)
{
    begin();
    dp_host_home(&host);
    CHECK(sends("H"));
    pass(250);
    CHECK(sends("H"));
    comes('N', "H", 1);
    CHECK(sends("S"));
    comes_report(DP_STATUS_IDLE, -1); /* was sent before the repeat arrived, perhaps */
    CHECK(tells_nothing());
    pass(500);
}

/* A controller that refuses what it is doing: the first ack was lost. */
static void refusal_of_a_repeat_is_doubted(void)
{
    a_repeat_is_refused();
    comes_report(DP_STATUS_HOMING, -1);
    CHECK(tells(DP_HOST_ACCEPTED, 'H', 0));
    comes_report(DP_STATUS_IDLE, 0);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_FINISHED));

    a_repeat_is_refused();
    comes_report(DP_STATUS_ERROR, -1);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_REFUSED));
}

/* No ack comes, so a move is sent four times; each time this report comes, and that one behind the last. */
static void unanswered_but_for(int state, float at, float at_last)
{
    int i;
    begin();
    dp_host_move(&host, &TARGET);
    for (i = 0; i < 4; ++i) {
        CHECK(sends("M"));
        pass(250);
        comes_report(state, i < 3 ? at : at_last);
    }
}

/* A controller all of whose acks are lost. */
static void reports_show_that_it_goes_on(void)
{
    unanswered_but_for(DP_STATUS_MOVING, 0.5f, 0.5f);
    CHECK(tells(DP_HOST_ACCEPTED, 'M', 0));
    pass(500);
    comes('m', "", 0); /* not believed: of which move? */
    CHECK(tells_nothing());
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));

    unanswered_but_for(DP_STATUS_IDLE, 0, 1); /* stood elsewhere, and at the target now */
    CHECK(tells(DP_HOST_ACCEPTED, 'M', 0));
    pass(500);
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));
}

/* What was sent before the request arrived says nothing about it: a move before may be meant. */
static void early_reports_show_nothing(void)
{
    int i;
    begin();
    dp_host_move(&host, &TARGET);
    CHECK(sends("M"));
    pass(249);
    comes_report(DP_STATUS_MOVING, 0.5f);
    CHECK(sends(""));
    pass(1);
    for (i = 0; i < 3; ++i) {
        CHECK(sends("M"));
        pass(250);
    }
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));
}

/* A controller that no request reaches. */
static void standing_elsewhere_shows_nothing(void)
{
    unanswered_but_for(DP_STATUS_IDLE, 0, 0);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));
}

static void is_cancelled(void)
{
    begin(); /* before it was sent */
    dp_host_home(&host);
    CHECK_INT(dp_host_cancel(&host), DP_RC_SUCCESS);
    CHECK_INT(dp_host_cancel(&host), DP_RC_BUSY);
    CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_CANCELLED));
    CHECK(sends("C"));
    comes('A', "C", 1);
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_FINISHED));

    move_accepted();
    comes_report(DP_STATUS_MOVING, 0.5f);
    dp_host_cancel(&host);
    CHECK(sends("C"));
    comes_report(DP_STATUS_IDLE, 0.6f); /* before the answer: why, that will tell */
    CHECK(tells_nothing());
    comes('A', "C", 1);
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_FINISHED));
    comes_report(DP_STATUS_MOVING, 0.6f);
    comes('m', "", 0);
    CHECK(tells_nothing());
    comes_report(DP_STATUS_IDLE, 0.7f);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_CANCELLED));
    CHECK(tells_nothing());

    move_accepted(); /* it ends before the controller has the request */
    dp_host_cancel(&host);
    CHECK(sends("C"));
    comes('m', "", 0);
    comes('A', "C", 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_FINISHED));

    move_accepted(); /* which the controller refuses */
    dp_host_cancel(&host);
    CHECK(sends("C"));
    comes('N', "C", 1);
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_REFUSED));
    comes_report(DP_STATUS_MOVING, 1);
    comes_report(DP_STATUS_IDLE, 1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_FINISHED));
}

/* Nothing restarts what the user wanted to stop. */
static void is_not_repeated_behind_its_cancelling(void)
{
    int i;
    begin();
    dp_host_move(&host, &TARGET);
    CHECK(sends("M"));
    pass(100);
    dp_host_cancel(&host);
    for (i = 0; i < 4; ++i) {
        CHECK(sends("C"));
        pass(250);
    }
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_TIMED_OUT));
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));
    CHECK(sends(""));
}

/* Nor is it sent at all when it has not left yet. */
static void is_taken_back(void)
{
    begin();
    dp_host_move(&host, &TARGET);
    CHECK(tells_nothing());
    dp_host_cancel(&host);
    CHECK(sends("C"));
    comes('A', "C", 1);
    CHECK(tells(DP_HOST_ENDED, 'C', DP_HOST_FINISHED));
    comes_report(DP_STATUS_IDLE, 0);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_CANCELLED));
}

/* Where frames may come twice, a request may be carried out twice. */
static void next_one_waits_where_frames_double(void)
{
    struct dp_host_settings settings;
    int duplicates;

    for (duplicates = 0; duplicates < 2; ++duplicates) {
        begin();
        memset(&settings, 0, sizeof settings);
        settings.duplicates = duplicates;
        dp_host_init(&host, &settings);
        dp_host_home(&host);
        CHECK(sends("H"));
        comes('A', "H", 1);
        CHECK(tells(DP_HOST_ACCEPTED, 'H', 0));
        pass(100);
        comes('h', "", 0);
        CHECK(tells(DP_HOST_ENDED, 'H', DP_HOST_FINISHED));
        dp_host_home(&host);
        CHECK(sends(duplicates ? "" : "H"));
        pass(400);
        CHECK(sends("H"));
    }
}

static void goes_silent(void)
{
    unsigned long began;
    int i;
    move_accepted();
    for (i = 0; i < 14; ++i) {
        pass(200);
        CHECK(sends("S"));
    }
    pass(200);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));

    move_accepted(); /* talks, but never ends */
    began = now;
    for (i = 0; i < 1199; ++i) {
        pass(100);
        comes_report(DP_STATUS_MOVING, 0.5f);
        CHECK(sends(""));
    }
    now = began;
    pass(120000 - 5 - 1); /* of two minutes, 5 ms went by before it was accepted */
    CHECK(tells_nothing());
    pass(1);
    CHECK(tells(DP_HOST_ENDED, 'M', DP_HOST_TIMED_OUT));
}

int main(void)
{
    finishes_as_specified();
    finishes_like_shipped_firmware();
    finishes_unseen();
    fails();
    is_refused();
    is_repeated_and_times_out();
    is_sent_as_often_as_the_settings_say();
    late_ack_accepts_once();
    refusal_of_a_repeat_is_doubted();
    reports_show_that_it_goes_on();
    early_reports_show_nothing();
    standing_elsewhere_shows_nothing();
    is_cancelled();
    is_not_repeated_behind_its_cancelling();
    is_taken_back();
    next_one_waits_where_frames_double();
    goes_silent();
    return check_summary("host_session");
}

#else

/* A session can't do anything, and does not. */
int main(void)
{
    static struct dp_host host;
    CHECK_INT(dp_host_home(&host), DP_RC_SUCCESS);
    return check_summary("host_session");
}

#endif
