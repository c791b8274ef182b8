/**
 * @file
 * libdeltarobot/deltarobot.h: the platform's geometry for C++ programs (C++98 and later) that use Eigen 3.
 *
 * Source-compatible with the original's header of this name; all of it stands on kinematics.h.
 */
#ifndef LIBDELTAROBOT_DELTAROBOT_H
#define LIBDELTAROBOT_DELTAROBOT_H

#include <limits>

/* Where Debian has it, or where -I says. */
#ifdef __has_include
#if __has_include("eigen3/Eigen/Dense")
#include "eigen3/Eigen/Dense"
#else
#include <Eigen/Dense>
#endif
#else
#include "eigen3/Eigen/Dense"
#endif

#include "kinematics.h"

namespace deltarobot {

typedef Eigen::Vector2f vec2;
typedef Eigen::Vector3f vec3;
typedef Eigen::Vector4f vec4;
typedef Eigen::Quaternionf quat;

/** The robot's measures, as `struct dp_robot_configuration` has them; all zero at first, which is no robot yet. */
struct robot_configuration {
    vec3 A1;
    vec3 A2;
    vec3 A3;
    float d_B1B3;
    float d_e;

    robot_configuration() : A1(vec3::Zero()), A2(vec3::Zero()), A3(vec3::Zero()), d_B1B3(0.0f), d_e(0.0f) {}
};

/** Displacements of the arms; all zero at first, with a configuration too. Nothing here depends on them. */
struct robot_state {
    float da;
    float db;
    float dc;

    robot_state() : da(0.0f), db(0.0f), dc(0.0f) {}
    robot_state(const robot_configuration &) : da(0.0f), db(0.0f), dc(0.0f) {}
};

/**
 * A robot. It refers to its configuration, which has to live as long and may change at any time.
 *
 *     deltarobot::robot_configuration configuration;
 *     deltarobot::robot robot(configuration, deltarobot::robot_state(configuration));
 *     configuration.A1 << 0.12f, 0.0f, 0.10f;
 *     configuration.A2 << 0.38f, 0.0f, 0.25f;
 *     configuration.A3 << 0.12f, 0.0f, 0.40f;
 *     configuration.d_B1B3 = 0.15f;
 *     configuration.d_e = 0.08f;
 *     float q1, q2, q3;
 *     robot.calculate_ik(0.25f, 0.4f, 0.25f, q1, q2, q3);
 */
class robot {
public:
    robot(const robot_configuration &configuration, robot_state state) : configuration_(configuration), state_(state) {}

    /** The lengths of the legs at a pose: what `dp_kinematics_inverse` says, NaN where it says an error. */
    void calculate_ik(float xe, float ye, float ze, float &q1, float &q2, float &q3)
    {
        calculate(dp_kinematics_inverse, xe, ye, ze, q1, q2, q3);
    }

    /** The pose of lengths: what `dp_kinematics_forward` says, NaN where it says an error. */
    void calculate_fk(float q1, float q2, float q3, float &xe, float &ye, float &ze)
    {
        calculate(dp_kinematics_forward, q1, q2, q3, xe, ye, ze);
    }

private:
    const robot_configuration &configuration_;
    robot_state state_;

    typedef int (*function)(const dp_robot_configuration *, const float *, float *);

    void calculate(function solve, float in1, float in2, float in3, float &out1, float &out2, float &out3) const
    {
        const float in[3] = { in1, in2, in3 };
        float out[3];
        dp_robot_configuration measures;
        for (int axis = 0; axis < 3; ++axis) {
            out[axis] = std::numeric_limits<float>::quiet_NaN();
            measures.A1[axis] = configuration_.A1[axis];
            measures.A2[axis] = configuration_.A2[axis];
            measures.A3[axis] = configuration_.A3[axis];
        }
        measures.d_B1B3 = configuration_.d_B1B3;
        measures.d_e = configuration_.d_e;
        solve(&measures, in, out); /* leaves the NaN where it fails */
        out1 = out[0];
        out2 = out[1];
        out3 = out[2];
    }
};

} /* namespace deltarobot */

#endif
