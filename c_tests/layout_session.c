/* C11: the layouts of the structs in host.h and controller.h, as src/ffi asserts them. */
#include "libdeltarobot/controller.h"
#include "libdeltarobot/host.h"

#include "check.h"

#include <stddef.h>

#define UP(value, type) (((value) + _Alignof(type) - 1) / _Alignof(type) * _Alignof(type))
#define SAME(a, b) _Static_assert((a) == (b), #a " is not " #b)
#define AT(type, field, place) SAME(offsetof(struct type, field), place)

#define LONG sizeof(unsigned long)
#define INT sizeof(int)
#define POINTER sizeof(void *)

AT(dp_host_settings, ack_ms, 0);
AT(dp_host_settings, guard_ms, LONG);
AT(dp_host_settings, settle_ms, 2 * LONG);
AT(dp_host_settings, poll_ms, 3 * LONG);
AT(dp_host_settings, silence_ms, 4 * LONG);
AT(dp_host_settings, operation_ms, 5 * LONG);
AT(dp_host_settings, gap_ms, 6 * LONG);
AT(dp_host_settings, tolerance, 7 * LONG);
AT(dp_host_settings, attempts, 7 * LONG + 4);
AT(dp_host_settings, layout, 7 * LONG + 4 + INT);
AT(dp_host_settings, messages, 7 * LONG + 4 + 2 * INT);
AT(dp_host_settings, doubles, 7 * LONG + 4 + 3 * INT);
SAME(sizeof(struct dp_host_settings), UP(7 * LONG + 4 + 4 * INT, unsigned long));

AT(dp_host_health, frames, 0);
AT(dp_host_health, malformed, LONG);
AT(dp_host_health, strays, 2 * LONG);
AT(dp_host_health, garbage_bytes, 3 * LONG);
AT(dp_host_health, checksum_failures, 4 * LONG);
AT(dp_host_health, overflows, 5 * LONG);
AT(dp_host_health, timeouts, 6 * LONG);
AT(dp_host_health, repeats, 7 * LONG);
AT(dp_host_health, rtt_count, 8 * LONG);
AT(dp_host_health, rtt_last, 9 * LONG);
AT(dp_host_health, rtt_min, 10 * LONG);
AT(dp_host_health, rtt_max, 11 * LONG);
AT(dp_host_health, rtt_sum, 12 * LONG);
SAME(sizeof(struct dp_host_health), 13 * LONG);

SAME(sizeof(struct dp_host_request), UP(2 * LONG + 5, unsigned long));
SAME(sizeof(struct dp_host_link), UP(UP(sizeof(struct protocol_data), unsigned long) + LONG + 3, unsigned long));
AT(dp_host, settings, 0);
AT(dp_host, health, sizeof(struct dp_host_settings));
AT(dp_host, link, sizeof(struct dp_host_settings) + sizeof(struct dp_host_health));
SAME(sizeof(struct dp_host),
     UP(offsetof(struct dp_host, link) + sizeof(struct dp_host_link) + 3 * sizeof(struct dp_host_request) + 4 * LONG +
            4 * INT + 7 + 2 * 12,
        unsigned long));

AT(dp_host_event, kind, 0);
AT(dp_host_event, opcode, INT);
AT(dp_host_event, outcome, INT + UP(1, int));
AT(dp_host_event, state, offsetof(struct dp_host_event, outcome) + INT);
AT(dp_host_event, report, UP(offsetof(struct dp_host_event, state) + INT, float));
AT(dp_host_event, msg, UP(offsetof(struct dp_host_event, report) + sizeof(struct protocol_msg_status_report), int));
SAME(sizeof(struct dp_host_event), offsetof(struct dp_host_event, msg) + sizeof(struct protocol_msg));

AT(dp_controller_calls, home, 0);
AT(dp_controller_calls, move, POINTER);
AT(dp_controller_calls, cancel, 2 * POINTER);
AT(dp_controller_calls, read, 3 * POINTER);
AT(dp_controller_calls, send, 4 * POINTER);
SAME(sizeof(struct dp_controller_calls), 5 * POINTER);
SAME(sizeof(struct dp_dispatcher), sizeof(struct protocol_data) + UP(INT + 13, int));
AT(dp_controller, dispatcher, 0);
AT(dp_controller, calls, UP(sizeof(struct dp_dispatcher), void *));
AT(dp_controller, usr, offsetof(struct dp_controller, calls) + POINTER);
AT(dp_controller, layout, offsetof(struct dp_controller, calls) + 2 * POINTER);
AT(dp_controller, flags, offsetof(struct dp_controller, calls) + 2 * POINTER + INT);
SAME(sizeof(struct dp_controller), UP(offsetof(struct dp_controller, flags) + INT, void *));

#if DP_BUFSIZE == 128 && DP_DATA_MAX_SIZE == 32 && defined(__x86_64__) && defined(__LP64__)
SAME(sizeof(struct dp_host), 488);
SAME(sizeof(struct dp_controller), 184);
#endif

/* All of the messages have texts of that length at most, whatever the sizes. */
SAME(DP_MSG_TEXT_MAX, 96);
SAME(DP_HOST_OUTPUT_MAX, 5 + 17 + 5);

int main(void)
{
    CHECK(DP_HOST_FINISHED != DP_HOST_TIMED_OUT);
    return check_summary("layout_session");
}
