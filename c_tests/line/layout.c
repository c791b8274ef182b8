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

AT(olp_assembly, used, 0);
AT(olp_assembly, overlong, INT);
SAME(sizeof(struct olp_assembly), 2 * INT);
AT(olp_receiver, assembly, 0);
AT(olp_receiver, line, 2 * INT);
SAME(sizeof(struct olp_receiver), 2 * INT + UP(OLP_LINE_MAX + 1, int));

/* --- line_host.h --- */

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

SAME(sizeof(struct olp_device_answer), UP(LONG + INT + 2 + OLP_REPLY_MAX, long));
SAME(sizeof(struct olp_device_answers), UP(OLP_WINDOW_MAX * sizeof(struct olp_device_answer) + 2, long));
SAME(sizeof(struct olp_device_link), UP(sizeof(struct olp_device_answers) + 7 * LONG + INT + 4, long));
SAME(sizeof(struct olp_device_input), UP(2 * INT + 1 + OLP_COMMAND_MAX, int));
SAME(sizeof(struct olp_device), UP(UP(sizeof(struct olp_device_link), void *) + 2 * POINTER + INT +
                                       sizeof(struct olp_device_input) + 5,
                                   struct olp_device));

int main(void)
{
    /* What the assertions above say of this compiler, the library was built with. */
    struct olp_receiver receiver;
    memset(&receiver, 0xFF, sizeof receiver);
    CHECK_INT(olp_receiver_init(&receiver), OLP_RC_SUCCESS);
    CHECK_INT(receiver.assembly.used, 0);
    CHECK_INT(receiver.assembly.overlong, 0);
    return check_summary("line_layout");
}
