/* host.h, the rest: status requests, messages, health, the limits of its buffers, bad arguments. */
#include "host_steps.h"

#include <limits.h>

#if HOST_WORKS

static void status_is_requested(void)
{
    int i;
    begin();
    CHECK_INT(dp_host_status(&host), DP_RC_SUCCESS);
    CHECK_INT(dp_host_status(&host), DP_RC_BUSY);
    CHECK(sends("S"));
    pass(7);
    comes_report(DP_STATUS_ERROR, -1);
    CHECK(tells(DP_HOST_ENDED, 'S', DP_HOST_FINISHED));
    CHECK_INT(healthy()->rtt_count, 1);
    CHECK_INT(health.rtt_last, 7);

    dp_host_status(&host);
    for (i = 0; i < 4; ++i) {
        CHECK(sends("S"));
        pass(250);
    }
    CHECK(tells(DP_HOST_ENDED, 'S', DP_HOST_TIMED_OUT));
}

static void reports_messages_and_health(void)
{
    struct dp_host_settings settings;

    begin();
    memset(&settings, 0, sizeof settings);
    settings.messages = 1;
    CHECK_INT(dp_host_init(&host, &settings), DP_RC_SUCCESS);
    CHECK_INT(dp_host_receive(&host, "xx$A\1H\xE9:", 8, now), 8);
    CHECK_INT(dp_host_receive(&host, "$M\3" "123\0:", 8, now), 8);
    CHECK(tells_nothing());
    CHECK_INT(healthy()->checksum_failures, 2);
    comes('A', "H", 1);
    comes('M', "123", 3);
    CHECK_INT(dp_host_receive(&host, "$M", 2, now), 2);
    CHECK(tells(DP_HOST_MESSAGE, 0, 0));
    CHECK_INT(event.msg.opcode, 'A');
    CHECK_INT(event.msg.data_s, 1);
    CHECK_INT(event.msg.data[0], 'H');
    CHECK_INT(event.msg.checksum_ok, 1);
    CHECK(tells(DP_HOST_MESSAGE, 0, 0));
    CHECK_INT(event.msg.data_s, 3);
    CHECK_BYTES(event.msg.data, "123", 3);
    CHECK(tells_nothing());
    CHECK_INT(healthy()->frames, 2);
    CHECK_INT(health.garbage_bytes, 16);
    CHECK_INT(health.checksum_failures, 2);
    CHECK_INT(health.malformed, 1);
    CHECK_INT(health.strays, 1);
    CHECK_INT(health.timeouts, 0);
    CHECK_INT(health.retransmissions, 0);
    CHECK_INT(health.rtt_count, 0);
    /* The beginning of a frame is waited for until the line was quiet for long enough. */
    CHECK_INT(dp_host_next_deadline(&host, now), 50);
    pass(50);
    CHECK(tells_nothing());
    CHECK_INT(healthy()->garbage_bytes, 18);
    CHECK_INT(dp_host_next_deadline(&host, now), -1);
}

static void takes_what_fits(void)
{
    unsigned char bytes[2 * DP_DATA_MAX_SIZE + 64];
    int taken, i;

    memset(bytes, 'x', sizeof bytes);
    memcpy(bytes + sizeof bytes - 5, "$h\0\xC6:", 5);
    begin();
    dp_host_home(&host);
    CHECK(sends("H"));
    /* A frame fits at any time, but not all of that. */
    taken = dp_host_receive(&host, bytes, (int)sizeof bytes, now);
    CHECK(taken >= DP_DATA_MAX_SIZE + 5 && taken < (int)sizeof bytes - 5);
    CHECK_INT(dp_host_receive(&host, bytes + taken, (int)sizeof bytes - taken, now), 0);
    /* While there are bytes that it could not take, no time is over. */
    pass(250);
    CHECK(tells_nothing());
    CHECK_INT(dp_host_output(&host, bytes, 17, now), 0);
    for (i = 0; i < 100 && taken < (int)sizeof bytes; ++i) {
        taken += dp_host_receive(&host, bytes + taken, (int)sizeof bytes - taken, now);
        CHECK(tells_nothing());
    }
    CHECK_INT(healthy()->frames, 1);
    CHECK_INT(health.garbage_bytes, sizeof bytes - 5);
    CHECK(sends("H"));
    CHECK_INT(healthy()->timeouts, 1);
    CHECK_INT(health.retransmissions, 1);

    /* Output goes out in whole frames. */
    begin();
    dp_host_move(&host, &TARGET);
    dp_host_status(&host);
    CHECK(tells_nothing());
    CHECK_INT(dp_host_output(&host, bytes, 4, now), 0);
    CHECK_INT(dp_host_output(&host, bytes, 16, now), 5);
    CHECK_INT(dp_host_output(&host, bytes, 16, now), 0);
    CHECK_INT(dp_host_output(&host, bytes, 17, now), 17);
    CHECK_BYTES(bytes, "$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD6:", 17);
}

static void zero_is_a_session(void)
{
    memset(&host, 0, sizeof host);
    now = 0;
    CHECK(tells_nothing());
    CHECK_INT(dp_host_next_deadline(&host, now), -1);
    dp_host_home(&host);
    CHECK(sends("H"));
    CHECK_INT(dp_host_next_deadline(&host, now), 250);
}

static void bad_arguments_are_refused(void)
{
    struct protocol_msg_position bad = {0, 0, 0};
    static const unsigned char NOT_FINITE[][4] = {{1, 0, 0x80, 0x7F}, {0, 0, 0x80, 0xFF}, {0xFF, 0xFF, 0xFF, 0xFF}};
    unsigned i;

    begin();
    for (i = 0; i < 3; ++i) {
        memcpy(&bad.DB, NOT_FINITE[i], 4);
        CHECK_INT(dp_host_move(&host, &bad), DP_RC_ERROR_GENERIC);
    }
    CHECK_INT(dp_host_move(&host, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_busy(&host), 0);
    CHECK_INT(dp_host_receive(&host, NULL, 1, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_receive(&host, "x", INT_MIN, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_receive(&host, NULL, 0, now), 0);
    CHECK_INT(dp_host_poll(&host, now, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_output(&host, NULL, 1, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_output(&host, &bad, -1, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_output(&host, NULL, 0, now), 0);
    CHECK_INT(dp_host_init(NULL, NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_home(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_move(NULL, &TARGET), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_cancel(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_status(NULL), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_receive(NULL, "x", 1, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_poll(NULL, now, &event), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_output(NULL, &bad, 5, now), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_next_deadline(NULL, now), -1);
    CHECK_INT(dp_host_busy(NULL), 0);
    CHECK_INT(dp_host_get_health(NULL, &health), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_host_get_health(&host, NULL), DP_RC_ERROR_GENERIC);
}

/* Any memory at all, and a clock that jumps anywhere: nothing is touched that should not be, and nothing hangs. */
static void any_memory(void)
{
    static const char LIKELY[] = "$$$$ANHSMChsme\0\0\1\x0C\x10:::";
    unsigned long seed = 11;
    int round, step, i;

    for (round = 0; round < 1000; ++round) {
        wire_any_memory(&seed, &host, sizeof host);
        for (step = 0; step < 30; ++step) {
            unsigned char bytes[64];
            int count = (int)(wire_random(&seed) % sizeof bytes), done;

            for (i = 0; i < count; ++i)
                bytes[i] = (unsigned char)LIKELY[wire_random(&seed) % (sizeof LIKELY - 1)];
            if (count >= WIRE_OVERHEAD && step % 2)
                wire_frame(bytes, DP_PROTO_ALL_OPCODES[step / 2 % 10], "", 0);
            done = dp_host_receive(&host, bytes, count, now);
            CHECK(done >= 0 && done <= count);
            for (i = 0; i < DP_BUFSIZE && dp_host_poll(&host, now, &event) == DP_RC_SUCCESS; ++i)
                CHECK(event.kind >= DP_HOST_MESSAGE && event.kind <= DP_HOST_ENDED);
            CHECK(i < DP_BUFSIZE);
            if (step % 5 == 0)
                dp_host_home(&host);
            if (step % 5 == 2)
                dp_host_move(&host, &TARGET);
            if (step % 7 == 0)
                dp_host_cancel(&host);
            if (step % 7 == 3)
                dp_host_status(&host);
            count = (int)(wire_random(&seed) % sizeof bytes);
            done = dp_host_output(&host, bytes, count, now);
            CHECK(done >= 0 && done <= count && done <= DP_HOST_OUTPUT_MAX);
            CHECK(dp_host_next_deadline(&host, now) >= -1);
            CHECK(dp_host_busy(&host) == 0 || dp_host_busy(&host) == 1);
            healthy();
            pass(step % 4 ? wire_random(&seed) % 1000 : (unsigned long)wire_random(&seed) << 4);
        }
    }
    begin();
    CHECK_INT(dp_host_home(&host), DP_RC_SUCCESS);
    CHECK(sends("H"));
}

int main(void)
{
    any_memory();
    status_is_requested();
    reports_messages_and_health();
    takes_what_fits();
    zero_is_a_session();
    bad_arguments_are_refused();
    return check_summary("host_link");
}

#else

/* A session can't do anything, and does not. */
int main(void)
{
    static struct dp_host host;
    CHECK_INT(dp_host_home(&host), DP_RC_SUCCESS);
    return check_summary("host_link");
}

#endif
