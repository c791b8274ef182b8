/*
 * Paths as commands: whatever the path, decoding gives it back, and no command could be shorter. And what a circle of
 * short moves costs.
 */
#include "libdeltarobot/gx.h"

#include "check.h"
#include "wire.h"

enum { AXES = 6, SEGMENTS_MAX = 700 };

static unsigned long seed = 28;

static int any(int count)
{
    return (int)(wire_random(&seed) % (unsigned)count);
}

/* What was decoded so far. */
static struct gx_commands commands;
static struct gx_vector position;

/* Decodes what is one command. */
static struct gx_item decode(const unsigned char *bytes, int length)
{
    struct gx_item item;
    CHECK_INT(gx_commands_receive(&commands, bytes, length, &item), length);
    CHECK(item.kind == GX_MOVE || item.kind == GX_STEP);
    CHECK_INT(gx_follow(&position, &item), GX_RC_SUCCESS);
    return item;
}

/* Bytes of the shortest command from one position to another, by the sizes of the two forms. */
static int shortest(const int32_t *from, const int32_t *to, int mask, int known, int has_velocity)
{
    int axis, changed = 0, is_short = 1;
    for (axis = 0; axis < AXES; ++axis) {
        if (!(mask >> axis & 1) || (known && from[axis] == to[axis]))
            continue;
        ++changed;
        if (!known || to[axis] - from[axis] > GX_DELTA_MAX || to[axis] - from[axis] < -GX_DELTA_MAX)
            is_short = 0;
    }
    return 2 + 2 * has_velocity + (changed == 0 ? 1 : is_short ? changed : 4 * changed);
}

static int32_t next_value(int32_t value, int jumps)
{
    static const int32_t edges[] = {GX_POSITION_MAX, GX_POSITION_MIN, 0, -1, 2097151, 2097152, -2097152};
    static const int32_t steps[] = {0, 1, -1, 62, 63, 64, -62, -63, -64, -65, 127, 128};
    int32_t next;
    if (any(10) < jumps)
        return any(3) ? (int32_t)(wire_random(&seed) & 0xFFFFFFFul) - 134217728 : edges[any(7)];
    next = value + (any(3) ? steps[any(12)] : any(127) - 63);
    return next > GX_POSITION_MAX || next < GX_POSITION_MIN ? value : next;
}

static void any_path(void)
{
    int mask = 1 + any(63), known = any(2), jumps = any(3) ? any(3) : 10, velocity = -1, told = -1, i, axis;
    int32_t at[AXES], next[AXES];
    struct gx_contour contour;
    struct gx_vector start;

    memset(&contour, 0x5A, sizeof contour);
    memset(&commands, 0, sizeof commands);
    memset(&position, 0, sizeof position);
    for (axis = 0; axis < AXES; ++axis)
        at[axis] = next_value(0, 5);
    CHECK_INT(gx_contour_init(&contour, (unsigned char)mask), GX_RC_SUCCESS);
    if (known) {
        memcpy(start.axes, at, sizeof at);
        start.mask = (unsigned char)mask;
        start.velocity = 0xFFFF;
        CHECK_INT(gx_contour_start(&contour, &start), GX_RC_SUCCESS);
        position = start;
    }
    for (i = 0; i < 60; ++i) {
        unsigned char bytes[GX_ENCODED_MAX];
        struct gx_contour before = contour;
        struct gx_item item;
        int wanted = any(4) ? -1 : any(5) ? any(16384) : velocity, changes, length, want;

        if (any(40) == 0) {
            /* An error notice came: nothing is known any more, at either end. */
            CHECK_INT(gx_contour_start(&contour, NULL), GX_RC_SUCCESS);
            position.mask = 0;
            known = 0;
            told = -1;
            before = contour;
        }
        if (wanted >= 0)
            velocity = wanted;
        changes = velocity != told;
        for (axis = 0; axis < AXES; ++axis)
            next[axis] = next_value(at[axis], jumps);
        want = shortest(at, next, mask, known, changes);
        /* One byte too little first: then nothing has happened. */
        CHECK_INT(gx_contour_segment(&contour, NULL, next, wanted, bytes, want - 1), -GX_RC_OVERFLOW);
        length = gx_contour_segment(&before, NULL, next, wanted, bytes, sizeof bytes);
        CHECK_INT(length, want);
        CHECK_INT(gx_contour_segment(&contour, NULL, next, wanted, bytes, want), want);
        if (length <= 0)
            return;
        item = decode(bytes, length);
        CHECK_INT((item.vector.mask & GX_MASK_VELOCITY) != 0, changes);
        if (changes)
            CHECK_INT(item.vector.velocity, velocity);
        told = velocity;
        CHECK((item.vector.mask & ~mask & GX_MASK_AXES) == 0 && (item.vector.mask & GX_MASK_AXES) != 0);
        known = 1;
        for (axis = 0; axis < AXES; ++axis) {
            if (mask >> axis & 1) {
                CHECK_INT(position.axes[axis], next[axis]);
                at[axis] = next[axis];
            }
        }
    }
}

static void what_is_refused(void)
{
    struct gx_contour contour;
    unsigned char bytes[GX_ENCODED_MAX];
    struct gx_number number = {5, GX_ASCII};
    int32_t here[AXES] = {1, 2, 3, 4, 5, 6}, beyond[AXES] = {1, GX_POSITION_MAX + 1, 3, 4, 5, 6};

    CHECK_INT(gx_contour_init(NULL, 1), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_init(&contour, 0), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_segment(&contour, NULL, here, -1, bytes, sizeof bytes), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_init(&contour, 0xC0), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_init(&contour, 3), GX_RC_SUCCESS);
    CHECK_INT(gx_contour_start(NULL, NULL), GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_segment(NULL, NULL, here, -1, bytes, sizeof bytes), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_segment(&contour, NULL, NULL, -1, bytes, sizeof bytes), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_segment(&contour, NULL, here, -1, NULL, sizeof bytes), -GX_RC_ERROR_GENERIC);
    CHECK_INT(gx_contour_segment(&contour, NULL, beyond, -1, bytes, sizeof bytes), -GX_RC_RANGE);
    CHECK_INT(gx_contour_segment(&contour, NULL, here, 16384, bytes, sizeof bytes), -GX_RC_RANGE);
    CHECK_INT(gx_contour_segment(&contour, NULL, here, 32767, bytes, sizeof bytes), -GX_RC_RANGE);
    /* None of that counted. */
    CHECK_INT(gx_contour_segment(&contour, &number, here, 0, bytes, sizeof bytes), 14);
    CHECK_BYTES(bytes, "#5!\xC3\x80\x80\x81\x80\x80\x80\x82\x80\x80\x80", 14);
    CHECK_INT(gx_contour_segment(&contour, NULL, here, 0, bytes, sizeof bytes), 3);
    CHECK_BYTES(bytes, "*\x81\x80", 3);
    /* The other axes are nobody's business. */
    beyond[1] = 2;
    beyond[2] = 2147483647;
    CHECK_INT(gx_contour_segment(&contour, NULL, beyond, -1, bytes, sizeof bytes), 3);
}

/* A circle of a radius of 4000 steps in 628 moves of some 40 steps, turned by a rotation rather than by libm. */
static int circle(int32_t path[][AXES])
{
    const int count = 628;
    double x = 4000, y = 0;
    const double c = 0.99994995, s = 0.010005; /* of a turn of 1/628 */
    int i;
    memset(path, 0, sizeof path[0] * (size_t)(count + 1));
    for (i = 0; i <= count; ++i) {
        double turned = x * c - y * s;
        path[i][0] = (int32_t)(x < 0 ? x - 0.5 : x + 0.5);
        path[i][1] = (int32_t)(y < 0 ? y - 0.5 : y + 0.5);
        y = x * s + y * c;
        x = turned;
    }
    return count;
}

static void what_a_circle_costs(void)
{
    static int32_t path[SEGMENTS_MAX][AXES];
    const int count = circle(path);
    struct gx_contour contour;
    struct gx_vector start, target;
    unsigned char bytes[GX_ENCODED_MAX];
    long by_contour = 0, by_long = 0, by_ascii = 0;
    int i, length;

    memset(&start, 0, sizeof start);
    start.mask = 3;
    memcpy(start.axes, path[0], sizeof start.axes);
    memset(&commands, 0, sizeof commands);
    position = start;
    gx_contour_init(&contour, 3);
    gx_contour_start(&contour, &start);
    for (i = 1; i <= count; ++i) {
        length = gx_contour_segment(&contour, NULL, path[i], 1000, bytes, sizeof bytes);
        CHECK(length > 0 && length <= (i == 1 ? 6 : 4));
        by_contour += length;
        decode(bytes, length);
        CHECK_BYTES(position.axes, path[i], sizeof path[i]);

        target = start;
        memcpy(target.axes, path[i], sizeof target.axes);
        if (i == 1) {
            target.mask |= GX_MASK_VELOCITY;
            target.velocity = 1000;
        }
        by_long += gx_write_move(GX_BINARY, NULL, &target, bytes, sizeof bytes);
        by_ascii += gx_write_move(GX_ASCII, NULL, &target, bytes, sizeof bytes);
    }
    printf("gx_contour: a circle of %d moves: %.2f bytes a move, in the long form %.2f, in ASCII %.2f\n", count,
           (double)by_contour / count, (double)by_long / count, (double)by_ascii / count);
    CHECK(by_contour * 5 <= by_long * 2 + 100);
    CHECK(by_contour * 2 < by_ascii);
}

int main(void)
{
    int i;
    for (i = 0; i < 2000; ++i)
        any_path();
    what_is_refused();
    what_a_circle_costs();
    return check_summary("gx_contour");
}
