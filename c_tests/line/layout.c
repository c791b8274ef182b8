/* The layouts of the structs in line_protocol.h, line_host.h and line_device.h. */
#include "libdeltarobot/line_device.h"
#include "libdeltarobot/line_host.h"
#include "libdeltarobot/line_protocol.h"

#include "check.h"
#include "layout.h"

AT(olp_message, line, 0);
AT(olp_message, length, POINTER);
AT(olp_message, count, POINTER + INT);
AT(olp_message, checksum, POINTER + 2 * INT);
AT(olp_message, sum, POINTER + 3 * INT);
SAME(sizeof(struct olp_message), UP(POINTER + 4 * INT, void *));

AT(olp_param, name, 0);
AT(olp_param, name_length, POINTER);
AT(olp_param, value, UP(POINTER + INT, void *));
AT(olp_param, value_length, UP(POINTER + INT, void *) + POINTER);
SAME(sizeof(struct olp_param), 2 * UP(POINTER + INT, void *));

AT(olp_line, kind, 0);
AT(olp_line, text, UP(INT, void *));
AT(olp_line, length, UP(INT, void *) + POINTER);
SAME(sizeof(struct olp_line), UP(offsetof(struct olp_line, length) + INT, void *));

AT(olp_encoder, buf, 0);
AT(olp_encoder, cap, POINTER);
AT(olp_encoder, length, POINTER + INT);
AT(olp_encoder, error, POINTER + 2 * INT);
SAME(sizeof(struct olp_encoder), UP(POINTER + 3 * INT, void *));

/* --- line_host.h --- */

AT(olp_host_settings, timeout_ms, 0);
AT(olp_host_settings, answer_ms, LONG);
AT(olp_host_settings, repeat_ms, 2 * LONG);
AT(olp_host_settings, repeats, 3 * LONG);
AT(olp_host_settings, recognises, 3 * LONG + INT);
AT(olp_host_settings, baud, UP(3 * LONG + 2 * INT, unsigned long));
AT(olp_host_settings, receive_room, UP(3 * LONG + 2 * INT, unsigned long) + LONG);
SAME(sizeof(struct olp_host_settings), UP(offsetof(struct olp_host_settings, receive_room) + INT, unsigned long));

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

AT(olp_host_event, kind, 0);
AT(olp_host_event, handle, INT);
AT(olp_host_event, outcome, 2 * INT);
AT(olp_host_event, device, 3 * INT);
AT(olp_host_event, error, 4 * INT);
AT(olp_host_event, lost, 5 * INT);
AT(olp_host_event, link, 6 * INT);
AT(olp_host_event, message, UP(6 * INT + sizeof(struct olp_host_link), void *));
SAME(sizeof(struct olp_host_event), offsetof(struct olp_host_event, message) + sizeof(struct olp_message));

/* --- line_device.h --- */

AT(olp_device_info, id, 0);
AT(olp_device_info, type, POINTER);
AT(olp_device_info, pos, 2 * POINTER);
AT(olp_device_info, name, UP(2 * POINTER + INT, void *));
AT(olp_device_info, version, UP(2 * POINTER + INT, void *) + POINTER);
SAME(sizeof(struct olp_device_info), UP(2 * POINTER + INT, void *) + 2 * POINTER);

AT(olp_command, id, 0);
AT(olp_command, name, POINTER);
AT(olp_command, run, 2 * POINTER);
SAME(sizeof(struct olp_command), 3 * POINTER);

AT(olp_device_table, devices, 0);
AT(olp_device_table, device_count, POINTER);
AT(olp_device_table, commands, UP(POINTER + INT, void *));
AT(olp_device_table, command_count, UP(POINTER + INT, void *) + POINTER);
AT(olp_device_table, send, 2 * UP(POINTER + INT, void *));
AT(olp_device_table, repeat_ms, UP(2 * UP(POINTER + INT, void *) + POINTER, long));
SAME(sizeof(struct olp_device_table), UP(offsetof(struct olp_device_table, repeat_ms) + LONG, void *));

AT(olp_device_health, commands, 0);
AT(olp_device_health, repeats, LONG);
AT(olp_device_health, checksums, 2 * LONG);
AT(olp_device_health, malformed, 3 * LONG);
AT(olp_device_health, overflows, 4 * LONG);
AT(olp_device_health, refused, 5 * LONG);
SAME(sizeof(struct olp_device_health), 6 * LONG);

/* --- what only the library looks into --- */

SAME(sizeof(struct olp_receiver), OLP_RECEIVER_WORDS * LONG);
SAME(sizeof(struct olp_host), OLP_HOST_WORDS * LONG);
SAME(sizeof(struct olp_device), OLP_DEVICE_WORDS * sizeof(LIBDELTAROBOT_WORD));

int main(void)
{
    /* What the assertions above say of this compiler, the library was built with. */
    struct olp_host_device device;
    struct olp_host host;
    memset(&device, 0xFF, sizeof device);
    memset(&host, 0, sizeof host);
    olp_host_receive(&host, "c=welcome&id=a&type=b&pos=3\n", 28, 0);
    olp_host_next_deadline(&host, 0);
    CHECK_INT(olp_host_get_device(&host, 0, &device), OLP_RC_NOT_FOUND);
    CHECK_INT(device.pos, -1);
    return check_summary("line_layout");
}
