/* C11: the layouts of the structs in line_host.h, as src/ffi asserts them. */
#include "libdeltarobot/line_host.h"

#include "check.h"

#include <stddef.h>

#define UP(value, type) (((value) + _Alignof(type) - 1) / _Alignof(type) * _Alignof(type))
#define SAME(a, b) _Static_assert((a) == (b), #a " is not " #b)
#define AT(type, field, place) SAME(offsetof(struct type, field), place)

#define LONG sizeof(unsigned long)
#define INT sizeof(int)
#define SHORT sizeof(unsigned short)

AT(olp_host_settings, timeout_ms, 0);
AT(olp_host_settings, answer_ms, LONG);
AT(olp_host_settings, repeat_ms, 2 * LONG);
AT(olp_host_settings, repeats, 3 * LONG);
AT(olp_host_settings, recognises, 3 * LONG + INT);
SAME(sizeof(struct olp_host_settings), UP(3 * LONG + 2 * INT, unsigned long));

AT(olp_host_link, ack, 0);
AT(olp_host_link, checksum, INT);
AT(olp_host_link, windowsize, 2 * INT);
SAME(sizeof(struct olp_host_link), 3 * INT);

AT(olp_host_health, lines, 0);
AT(olp_host_health, strays, LONG);
AT(olp_host_health, malformed, 2 * LONG);
AT(olp_host_health, overlong, 3 * LONG);
AT(olp_host_health, lost, 4 * LONG);
AT(olp_host_health, errors, 5 * LONG);
AT(olp_host_health, restarts, 6 * LONG);
AT(olp_host_health, overflows, 7 * LONG);
AT(olp_host_health, timeouts, 8 * LONG);
AT(olp_host_health, repeats, 9 * LONG);
AT(olp_host_health, rtt_count, 10 * LONG);
AT(olp_host_health, rtt_last, 11 * LONG);
AT(olp_host_health, rtt_min, 12 * LONG);
AT(olp_host_health, rtt_max, 13 * LONG);
AT(olp_host_health, rtt_sum, 14 * LONG);
SAME(sizeof(struct olp_host_health), 15 * LONG);

AT(olp_host_device, id, 0);
AT(olp_host_device, type, 16);
AT(olp_host_device, name, 16 + 48);
AT(olp_host_device, version, 16 + 48 + 32);
AT(olp_host_device, pos, 16 + 48 + 32 + 16);
AT(olp_host_device, cut, 16 + 48 + 32 + 16 + INT);
SAME(sizeof(struct olp_host_device), 16 + 48 + 32 + 16 + 2 * INT);
SAME(sizeof(struct olp_host_devices), UP(OLP_DEVICES_MAX * (sizeof(struct olp_host_device) + 1), int) + INT);

SAME(sizeof(struct olp_host_recent), SHORT + 2);
SAME(sizeof(struct olp_host_counter), 64 * (SHORT + 2) + INT + 4);
SAME(sizeof(struct olp_host_slot), UP(2 * LONG + 5 * INT + SHORT + 8 + 54, unsigned long));
AT(olp_host, receiver, 0);
AT(olp_host, session, UP(sizeof(struct olp_receiver), unsigned long));
SAME(sizeof(struct olp_host), UP(offsetof(struct olp_host, session) + sizeof(struct olp_host_session), unsigned long));

AT(olp_host_event, kind, 0);
AT(olp_host_event, handle, INT);
AT(olp_host_event, outcome, 2 * INT);
AT(olp_host_event, device, 3 * INT);
AT(olp_host_event, error, 4 * INT);
AT(olp_host_event, lost, 5 * INT);
AT(olp_host_event, link, 6 * INT);
AT(olp_host_event, message, UP(6 * INT + sizeof(struct olp_host_link), void *));
SAME(sizeof(struct olp_host_event), offsetof(struct olp_host_event, message) + sizeof(struct olp_message));

int main(void)
{
    CHECK(OLP_HOST_ANSWERED != OLP_HOST_NOT_SENT);
    return check_summary("line_host_layout");
}
