/**
 * @file
 * libdeltarobot/kinematics.h: the platform's geometry. libdeltarobot/deltarobot.h has it for C++.
 *
 * Three legs of variable length stand on the joints A1, A2 and A3 of the base. Legs 1 and 3 and the platform's edge
 * lie in one plane, which turns about the line A1A3; leg 2 ends off that plane, on the side of A2. The pose is the
 * place of the edge's middle. docs/kinematics.md has the formulas.
 *
 *     struct dp_robot_configuration configuration = {
 *         { 0.12f, 0.0f, 0.10f }, { 0.38f, 0.0f, 0.25f }, { 0.12f, 0.0f, 0.40f }, 0.15f, 0.08f
 *     };
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/kinematics.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_KINEMATICS_H
#define LIBDELTAROBOT_KINEMATICS_H

#include "abi.h"
#include "protocol.h"

LIBDELTAROBOT_NOT_PACKED(kinematics);

#ifdef __cplusplus
extern "C" {
#endif

/** There is no such pose. */
#define DP_RC_NO_POSE 14

/** The robot's measures: any unit of length, any frame. */
struct dp_robot_configuration {
  /** Where leg 1 is joined to the base: x, y, z. */
  float A1[3];
  /** Where leg 2 is, the one that stands off the plane of the others. */
  float A2[3];
  /** Where leg 3 is. */
  float A3[3];
  /** The length of the platform's edge from leg 1 to leg 3. */
  float d_B1B3;
  /** The distance of leg 2's end from the plane of the others. */
  float d_e;
};

/**
 * Inverse kinematics: how long the three legs are when the middle of the platform's edge is at pose.
 *
 * Returns `DP_RC_SUCCESS` and the lengths; `DP_RC_NO_POSE` where the platform's direction is not defined, on the line
 * A1A3 or where leg 2 is perpendicular to the plane of the others; or `DP_RC_ERROR_GENERIC` when a pointer is NULL, a
 * number is not finite or too large, or A1 and A3 are one point. On an error, lengths is left as it was.
 *
 *     float pose[3] = { 0.25f, 0.4f, 0.25f }, lengths[3];
 *     if (dp_kinematics_inverse(&configuration, pose, lengths) == DP_RC_SUCCESS)
 *         printf("%f %f %f\n", lengths[0], lengths[1], lengths[2]);
 */
int dp_kinematics_inverse(const struct dp_robot_configuration *configuration, const float *pose, float *lengths);

/**
 * Forward kinematics: where the middle of the platform's edge is when the three legs have these lengths.
 *
 * The pose is on the side of the plane A1A2A3 that (A3 - A1) x (A2 - A1) points to; its mirror image has the same
 * lengths. Where more poses have them, as happens close to the base, it is nearly always the farthest from there.
 *
 * Returns `DP_RC_SUCCESS` and the pose, at which the lengths differ by at most a hundred-thousandth of their sum;
 * `DP_RC_NO_POSE` when no pose has these lengths, or A1, A2 and A3 are in line; or `DP_RC_ERROR_GENERIC` as
 * `dp_kinematics_inverse` does. On an error, pose is left as it was.
 *
 *     float lengths[3] = { 0.43f, 0.38f, 0.43f }, pose[3];
 *     if (dp_kinematics_forward(&configuration, lengths, pose) == DP_RC_SUCCESS)
 *         printf("%f %f %f\n", pose[0], pose[1], pose[2]);
 */
int dp_kinematics_forward(const struct dp_robot_configuration *configuration, const float *lengths, float *pose);

#ifdef __cplusplus
}
#endif

#endif
