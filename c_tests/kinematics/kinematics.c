/*
 * kinematics.h: known poses, forward of inverse all over the work space, and what has no answer. The first argument is
 * how many random poses.
 */
#include "libdeltarobot/kinematics.h"

#include "check.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

/* That of the graphical host program, and one that lies flat. */
static const struct dp_robot_configuration robots[2] = {
    { { 0.12f, 0.0f, 0.10f }, { 0.38f, 0.0f, 0.25f }, { 0.12f, 0.0f, 0.40f }, 0.15f, 0.08f },
    { { -0.2f, 0.0f, 0.0f }, { 0.0f, 0.3f, 0.05f }, { 0.2f, 0.0f, 0.0f }, 0.12f, 0.06f }
};

/* Computed apart from this library. */
static const struct {
    int robot;
    float pose[3];
    float lengths[3];
} known[] = {
    { 0, { 0.25f, 0.4f, 0.25f }, { 0.4272294f, 0.3791266f, 0.4272294f } },
    { 0, { 0.2f, 0.3f, 0.2f }, { 0.2965865f, 0.3018354f, 0.3492939f } },
    { 0, { 0.13f, 0.4f, 0.1f }, { 0.3799379f, 0.4580535f, 0.4848164f } },
    { 0, { 0.3f, 0.5f, 0.3f }, { 0.5542086f, 0.4755619f, 0.5236280f } },
    { 0, { 0.25f, 0.4f, 0.35f }, { 0.4762744f, 0.3920931f, 0.4000486f } },
    { 1, { 0.0f, 0.0f, 0.5f }, { 0.5192302f, 0.5100000f, 0.5192302f } },
    { 1, { 0.1f, 0.05f, 0.4f }, { 0.4861660f, 0.4045024f, 0.3873960f } },
    { 1, { -0.15f, -0.1f, 0.6f }, { 0.5939681f, 0.6723864f, 0.6876031f } },
    { 1, { 0.0f, 0.2f, 0.45f }, { 0.5119570f, 0.3783380f, 0.5119570f } }
};

static float farthest(const float *one, const float *other)
{
    float most = 0.0f;
    int i;
    for (i = 0; i < 3; ++i)
        if (!(fabsf(one[i] - other[i]) <= most))
            most = fabsf(one[i] - other[i]);
    return most;
}

static void known_poses(void)
{
    size_t i;
    for (i = 0; i < sizeof known / sizeof *known; ++i) {
        float found[3];
        CHECK_INT(dp_kinematics_inverse(&robots[known[i].robot], known[i].pose, found), DP_RC_SUCCESS);
        CHECK(farthest(found, known[i].lengths) < 2e-7f);
        CHECK_INT(dp_kinematics_forward(&robots[known[i].robot], known[i].lengths, found), DP_RC_SUCCESS);
        CHECK(farthest(found, known[i].pose) < 5e-7f);
    }
}

static unsigned long random_state = 1;

static float random_between(float low, float high)
{
    random_state = (random_state * 1103515245ul + 12345ul) & 0x7FFFFFFFul;
    return low + (high - low) * (float)(random_state >> 8) / 8388608.0f;
}

static void forward_of_inverse(long poses)
{
    float worst = 0.0f;
    long i;
    for (i = 0; i < 2 * poses; ++i) {
        const struct dp_robot_configuration *robot = &robots[i & 1];
        float pose[3], lengths[3], found[3];
        if (i & 1) {
            pose[0] = random_between(-0.3f, 0.3f);
            pose[1] = random_between(-0.3f, 0.3f);
            pose[2] = random_between(0.3f, 0.8f);
        } else {
            pose[0] = random_between(0.0f, 0.5f);
            pose[1] = random_between(0.2f, 0.8f);
            pose[2] = random_between(0.0f, 0.5f);
        }
        CHECK_INT(dp_kinematics_inverse(robot, pose, lengths), DP_RC_SUCCESS);
        CHECK_INT(dp_kinematics_forward(robot, lengths, found), DP_RC_SUCCESS);
        if (!(farthest(found, pose) <= worst))
            worst = farthest(found, pose);
    }
    printf("%ld poses of each robot, worst error %.1e\n", poses, (double)worst);
    CHECK(worst < 5e-7f);
}

typedef int (*function)(const struct dp_robot_configuration *, const float *, float *);

static void refused(function solve, const struct dp_robot_configuration *robot, float x, float y, float z, int why)
{
    const float given[3] = { x, y, z };
    float found[3] = { 1.0f, 2.0f, 3.0f };
    static const float untouched[3] = { 1.0f, 2.0f, 3.0f };
    CHECK_INT(solve(robot, given, found), why);
    CHECK_BYTES(found, untouched, sizeof found);
}

static void no_answer(void)
{
    const float bad[3] = { NAN, INFINITY, -INFINITY };
    const function solves[2] = { dp_kinematics_inverse, dp_kinematics_forward };
    struct dp_robot_configuration robot = robots[0];
    size_t i, field;
    int which;

    /* On the line A1A3, and leg 2 perpendicular to the plane of the others. */
    refused(dp_kinematics_inverse, &robot, 0.12f, 0.0f, 0.25f, DP_RC_NO_POSE);
    refused(dp_kinematics_inverse, &robot, 0.12f, 0.0f, -9.0f, DP_RC_NO_POSE);
    refused(dp_kinematics_inverse, &robot, 0.25f, 0.13f, 0.25f, DP_RC_NO_POSE);
    /* Too far apart, too short, and less than nothing. */
    refused(dp_kinematics_forward, &robot, 0.3f, 1.2f, 0.3f, DP_RC_NO_POSE);
    refused(dp_kinematics_forward, &robot, 1.0f, 0.4f, 0.1f, DP_RC_NO_POSE);
    refused(dp_kinematics_forward, &robot, 0.01f, 0.01f, 0.01f, DP_RC_NO_POSE);
    refused(dp_kinematics_forward, &robot, 0.0f, 0.0f, 0.0f, DP_RC_NO_POSE);
    refused(dp_kinematics_forward, &robot, -0.4f, 0.4f, 0.4f, DP_RC_NO_POSE);

    for (which = 0; which < 2; ++which) {
        float numbers[3] = { 0.4f, 0.4f, 0.4f };
        CHECK_INT(solves[which](NULL, numbers, numbers), DP_RC_ERROR_GENERIC);
        CHECK_INT(solves[which](&robot, NULL, numbers), DP_RC_ERROR_GENERIC);
        CHECK_INT(solves[which](&robot, numbers, NULL), DP_RC_ERROR_GENERIC);
        for (i = 0; i < 3; ++i) {
            refused(solves[which], &robot, bad[i], 0.4f, 0.4f, DP_RC_ERROR_GENERIC);
            refused(solves[which], &robot, 0.4f, bad[i], 0.4f, DP_RC_ERROR_GENERIC);
            refused(solves[which], &robot, 0.4f, 0.4f, bad[i], DP_RC_ERROR_GENERIC);
            for (field = 0; field < sizeof robot / sizeof(float); ++field) {
                struct dp_robot_configuration other = robot;
                memcpy((char *)&other + field * sizeof(float), &bad[i], sizeof(float));
                refused(solves[which], &other, 0.4f, 0.4f, 0.4f, DP_RC_ERROR_GENERIC);
            }
        }
        memset(&robot, 0, sizeof robot);
        refused(solves[which], &robot, 0.4f, 0.4f, 0.4f, DP_RC_ERROR_GENERIC);
        robot = robots[0];
    }

    /* All joints in line: lengths, but no side. */
    robot.A2[0] = 0.12f;
    refused(dp_kinematics_forward, &robot, 0.4f, 0.4f, 0.4f, DP_RC_NO_POSE);
    robot.A2[0] = 0.38f;
    robot.A2[1] = FLT_MAX;
    refused(dp_kinematics_inverse, &robot, 0.25f, 0.4f, 0.25f, DP_RC_ERROR_GENERIC);
}

int main(int argc, char **argv)
{
    CHECK_INT(sizeof(struct dp_robot_configuration), 44);
    CHECK_INT(offsetof(struct dp_robot_configuration, d_B1B3), 36);
    CHECK_INT(DP_RC_NO_POSE, 14);
    known_poses();
    forward_of_inverse(argc > 1 ? atol(argv[1]) : 100000);
    no_answer();
    return check_summary("kinematics");
}
