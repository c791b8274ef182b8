// deltarobot.h, used as the graphical host program uses it: a robot is built on a configuration that is filled in
// afterwards, moves go out as messages, and answers are shown as text.
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_pc_utils.h"
#include "libdeltarobot/deltarobot.h"

#include "check.h"

#include <string>

using deltarobot::robot;
using deltarobot::robot_configuration;
using deltarobot::robot_state;
using deltarobot::vec3;

static protocol_data ring;

static int loop_back(void *buf, int bytes, void *)
{
    return dp_process(&ring, buf, bytes);
}

class host {
public:
    host() : robot_(configuration_, robot_state()), q_(vec3::Zero()) {}

    void set_up()
    {
        configuration_.A1 = vec3(0.12f, 0.0f, 0.10f);
        configuration_.A2 = vec3(0.38f, 0.0f, 0.25f);
        configuration_.A3 = vec3(0.12f, 0.0f, 0.40f);
        configuration_.d_B1B3 = 0.15f;
        configuration_.d_e = 0.08f;
    }

    void move_base(const vec3 &by)
    {
        configuration_.A1 += by;
        configuration_.A2 += by;
        configuration_.A3 += by;
    }

    const vec3 &lengths_at(const vec3 &e)
    {
        robot_.calculate_ik(e.x(), e.y(), e.z(), q_[0], q_[1], q_[2]);
        return q_;
    }

    vec3 pose_of(const vec3 &q)
    {
        vec3 e;
        robot_.calculate_fk(q[0], q[1], q[2], e[0], e[1], e[2]);
        return e;
    }

    // The message that moves the legs there, as text, once it has gone over the line.
    std::string move_to(const vec3 &e)
    {
        const vec3 &q = lengths_at(e);
        protocol_msg_position position;
        position.DA = q[0];
        position.DB = q[1];
        position.DC = q[2];
        protocol_msg msg;
        msg.opcode = DP_OPCODE_MOVE;
        msg.data_s = sizeof position;
        memcpy(msg.data, &position, sizeof position);
        dp_send(&msg, loop_back, 0);
        return dp_recv(&ring, &msg) == DP_RC_SUCCESS ? deltarobot::protocol_msg_to_str(&msg) : std::string();
    }

private:
    robot_configuration configuration_;
    robot robot_;
    vec3 q_;
};

static bool is_nan(const vec3 &v)
{
    return v[0] != v[0] && v[1] != v[1] && v[2] != v[2];
}

int main()
{
    CHECK_INT(sizeof(robot_configuration), 44);
    CHECK_INT(sizeof(robot_state), 12);
    CHECK_INT(sizeof(robot), 2 * sizeof(void *) + 8);

    const robot_configuration nothing;
    CHECK(nothing.A1.isZero() && nothing.A2.isZero() && nothing.A3.isZero());
    CHECK(nothing.d_B1B3 == 0.0f && nothing.d_e == 0.0f);
    const robot_state state(nothing), other_state;
    CHECK(state.da == 0.0f && state.db == 0.0f && state.dc == 0.0f && other_state.da == 0.0f);
    const deltarobot::vec2 two(1.0f, 2.0f);
    const deltarobot::vec4 four(1.0f, 2.0f, 3.0f, 4.0f);
    CHECK(two.sum() == 3.0f && four.sum() == 10.0f && deltarobot::quat::Identity().w() == 1.0f);

    // No robot yet.
    host host;
    CHECK(is_nan(host.lengths_at(vec3(0.25f, 0.4f, 0.25f))) && is_nan(host.pose_of(vec3(0.4f, 0.4f, 0.4f))));

    host.set_up();
    const vec3 e(0.2f, 0.3f, 0.2f), q(0.2965865f, 0.3018354f, 0.3492939f);
    CHECK((host.lengths_at(e) - q).norm() < 3e-7f);
    CHECK((host.pose_of(q) - e).norm() < 5e-7f);
    CHECK(host.move_to(e) == "MOVE!:  DA=0.296587  DB=0.301835  DC=0.349294");

    // The original had a NaN for poses in the plane of the joints. Here there is one where there is no answer.
    CHECK(!is_nan(host.lengths_at(vec3(0.25f, 0.0f, 0.25f))));
    CHECK(is_nan(host.lengths_at(vec3(0.12f, 0.0f, 0.25f))));
    CHECK(is_nan(host.pose_of(vec3(0.3f, 1.2f, 0.3f))));

    // The robot sees what has changed since.
    const vec3 by(1.0f, -0.5f, 0.25f);
    host.move_base(by);
    CHECK((host.lengths_at(e + by) - q).norm() < 1e-6f);
    return check_summary("robot");
}
