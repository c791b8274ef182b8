/* The layouts of the structs in gx.h, gx_host.h, gx_motion.h and ContouringProtocol.h. */
#include "ContouringProtocol.h"
#include "libdeltarobot/gx.h"
#include "libdeltarobot/gx_host.h"
#include "libdeltarobot/gx_motion.h"

#include "check.h"
#include "layout.h"

SAME(sizeof(struct gx_vector), 28);
AT(gx_vector, velocity, 0);
AT(gx_vector, mask, 2);
AT(gx_vector, axes, 4);
SAME(sizeof(struct gx_number), 4);
AT(gx_number, format, 2);
SAME(sizeof(struct gx_item), 40);
AT(gx_item, kind, 0);
AT(gx_item, number, 4);
AT(gx_item, format, 8);
AT(gx_item, code, 9);
AT(gx_item, period, 10);
AT(gx_item, vector, 12);
SAME(sizeof(struct gx_commands), 48);
SAME(sizeof(struct gx_notices), 48);
SAME(sizeof(struct gx_contour), 64);

/* --- gx_host.h --- */

AT(gx_host_settings, answer_ms, 0);
AT(gx_host_settings, probe_ms, LONG);
AT(gx_host_settings, move_ms, 2 * LONG);
AT(gx_host_settings, gap_ms, 3 * LONG);
AT(gx_host_settings, attempts, 4 * LONG);
AT(gx_host_settings, window, 4 * LONG + INT);
AT(gx_host_settings, ascii, 4 * LONG + 2 * INT);
AT(gx_host_settings, first_number, 4 * LONG + 3 * INT);
SAME(sizeof(struct gx_host_settings), UP(4 * LONG + 4 * INT, unsigned long));
AT(gx_host_health, moves, 0);
AT(gx_host_health, repeats, LONG);
AT(gx_host_health, completions, 2 * LONG);
AT(gx_host_health, errors, 3 * LONG);
AT(gx_host_health, strays, 4 * LONG);
AT(gx_host_health, reports, 5 * LONG);
AT(gx_host_health, malformed, 6 * LONG);
AT(gx_host_health, timeouts, 7 * LONG);
AT(gx_host_health, sessions, 8 * LONG);
SAME(sizeof(struct gx_host_health), 9 * LONG);
AT(gx_host_event, kind, 0);
AT(gx_host_event, outcome, INT);
AT(gx_host_event, code, 2 * INT);
AT(gx_host_event, number, 3 * INT);
AT(gx_host_event, position, 4 * INT);
SAME(sizeof(struct gx_host_event), 4 * INT + sizeof(struct gx_vector));
SAME(sizeof(struct gx_host), UP(240 + 32 * GX_WINDOW_MAX, unsigned long));

/* --- gx_motion.h --- */

AT(gx_motion_settings, gap_ms, 0);
AT(gx_motion_settings, axes, LONG);
AT(gx_motion_settings, only_in_order, LONG + INT);
SAME(sizeof(struct gx_motion_settings), UP(LONG + 2 * INT, unsigned long));
AT(gx_motion_health, moves, 0);
AT(gx_motion_health, repeats, LONG);
AT(gx_motion_health, refused, 2 * LONG);
AT(gx_motion_health, malformed, 3 * LONG);
AT(gx_motion_health, reports, 4 * LONG);
SAME(sizeof(struct gx_motion_health), 5 * LONG);
AT(gx_motion_event, kind, 0);
AT(gx_motion_event, number, INT);
AT(gx_motion_event, code, 2 * INT);
AT(gx_motion_event, period, 3 * INT);
SAME(sizeof(struct gx_motion_event), 4 * INT);
SAME(sizeof(struct gx_motion), UP(184 + 32 * GX_QUEUE_MAX, unsigned long));

/* --- ContouringProtocol.h, as posted --- */

SAME(sizeof(CPPacked7), 1);
SAME(sizeof(CPPacked14), 2);
SAME(sizeof(CPPacked28), 4);
SAME(sizeof(CPVectorCommand), 28);
SAME(offsetof(CPVectorCommand, targetVelocity), 0);
SAME(offsetof(CPVectorCommand, axisMask), 2);
SAME(offsetof(CPVectorCommand, axisPosition), 4);
SAME(sizeof(((CPVectorCommand *)0)->targetVelocity), 2);
SAME(sizeof(((CPVectorCommand *)0)->axisMask), 1);
SAME(sizeof(((CPVectorCommand *)0)->axisPosition), 24);
SAME(sizeof(CPPackedVectorCommandBuffer), 29);
SAME(offsetof(CPPackedVectorCommandBuffer, length), 0);
SAME(offsetof(CPPackedVectorCommandBuffer, bytes), 1);
SAME(CPAxis_x + CPAxis_y + CPAxis_z + CPAxis_a + CPAxis_b + CPAxis_c, 15);
SAME(1 << CPAxis_x, CPMask_x);
SAME(1 << CPAxis_y, CPMask_y);
SAME(1 << CPAxis_z, CPMask_z);
SAME(1 << CPAxis_a, CPMask_a);
SAME(1 << CPAxis_b, CPMask_b);
SAME(1 << CPAxis_c, CPMask_c);
SAME(CPMask_velocity, 64);

int main(void)
{
    struct gx_commands reader;
    CHECK_INT(gx_commands_init(&reader), GX_RC_SUCCESS);
    return check_summary("gx_layout");
}
