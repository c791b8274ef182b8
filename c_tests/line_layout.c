/* C11: the layouts of the structs in line_protocol.h, as src/ffi asserts them. */
#include "libdeltarobot/line_protocol.h"

#include "check.h"

#include <stddef.h>

#define UP(value, type) (((value) + _Alignof(type) - 1) / _Alignof(type) * _Alignof(type))
#define SAME(a, b) _Static_assert((a) == (b), #a " is not " #b)
#define AT(type, field, place) SAME(offsetof(struct type, field), place)

#define INT sizeof(int)
#define POINTER sizeof(void *)

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
