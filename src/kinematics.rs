//! `libdeltarobot/kinematics.h`: the platform's geometry. libdeltarobot/deltarobot.h has it for C++.
//!
//! Three legs of variable length stand on the joints A1, A2 and A3 of the base. Legs 1 and 3 and the platform's edge
//! lie in one plane, which turns about the line A1A3; leg 2 ends off that plane, on the side of A2. The pose is the
//! place of the edge's middle. docs/kinematics.md has the formulas.
//!
//! ```c
//! struct dp_robot_configuration configuration = {
//!     { 0.12f, 0.0f, 0.10f }, { 0.38f, 0.0f, 0.25f }, { 0.12f, 0.0f, 0.40f }, 0.15f, 0.08f
//! };
//! ```

use core::ffi::{c_float, c_int};

use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS};
use deltarobot_export::export;
use deltarobot_protocols::kinematics::{Error, Geometry, forward, inverse};

/// There is no such pose.
pub const DP_RC_NO_POSE: c_int = 14;

/// What is computed with: where there is no system, wider numbers would cost much, and avr-gcc has none.
#[cfg(target_os = "none")]
type Real = f32;
#[cfg(not(target_os = "none"))]
type Real = f64;

/// The robot's measures: any unit of length, any frame.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
#[expect(non_snake_case, reason = "the original's names")]
pub struct RobotConfiguration {
    /// Where leg 1 is joined to the base: x, y, z.
    pub A1: [c_float; 3],
    /// Where leg 2 is, the one that stands off the plane of the others.
    pub A2: [c_float; 3],
    /// Where leg 3 is.
    pub A3: [c_float; 3],
    /// The length of the platform's edge from leg 1 to leg 3.
    pub d_B1B3: c_float,
    /// The distance of leg 2's end from the plane of the others.
    pub d_e: c_float,
}

/// Inverse kinematics: how long the three legs are when the middle of the platform's edge is at pose.
///
/// Returns `DP_RC_SUCCESS` and the lengths; `DP_RC_NO_POSE` where the platform's direction is not defined, on the line
/// A1A3 or where leg 2 is perpendicular to the plane of the others; or `DP_RC_ERROR_GENERIC` when a pointer is NULL, a
/// number is not finite or too large, or A1 and A3 are one point. On an error, lengths is left as it was.
///
/// ```c
/// float pose[3] = { 0.25f, 0.4f, 0.25f }, lengths[3];
/// if (dp_kinematics_inverse(&configuration, pose, lengths) == DP_RC_SUCCESS)
///     printf("%f %f %f\n", lengths[0], lengths[1], lengths[2]);
/// ```
#[export]
pub unsafe extern "C" fn dp_kinematics_inverse(
    configuration: *const RobotConfiguration,
    pose: *const c_float,
    lengths: *mut c_float,
) -> c_int {
    // SAFETY: each is NULL or an object of its type by the rules of this crate.
    unsafe { answer(configuration, pose, lengths, inverse::<Real>) }
}

/// Forward kinematics: where the middle of the platform's edge is when the three legs have these lengths.
///
/// The pose is on the side of the plane A1A2A3 that (A3 - A1) x (A2 - A1) points to; its mirror image has the same
/// lengths. Where more poses have them, as happens close to the base, it is nearly always the farthest from there.
///
/// Returns `DP_RC_SUCCESS` and the pose, at which the lengths differ by at most a hundred-thousandth of their sum;
/// `DP_RC_NO_POSE` when no pose has these lengths, or A1, A2 and A3 are in line; or `DP_RC_ERROR_GENERIC` as
/// `dp_kinematics_inverse` does. On an error, pose is left as it was.
///
/// ```c
/// float lengths[3] = { 0.43f, 0.38f, 0.43f }, pose[3];
/// if (dp_kinematics_forward(&configuration, lengths, pose) == DP_RC_SUCCESS)
///     printf("%f %f %f\n", pose[0], pose[1], pose[2]);
/// ```
#[export]
pub unsafe extern "C" fn dp_kinematics_forward(
    configuration: *const RobotConfiguration,
    lengths: *const c_float,
    pose: *mut c_float,
) -> c_int {
    // SAFETY: each is NULL or an object of its type by the rules of this crate.
    unsafe { answer(configuration, lengths, pose, forward::<Real>) }
}

/// # Safety
///
/// Each pointer is NULL or points to an object: a configuration, and arrays of three.
unsafe fn answer(
    configuration: *const RobotConfiguration,
    given: *const c_float,
    out: *mut c_float,
    solve: fn(&Geometry, [f32; 3]) -> Result<[f32; 3], Error>,
) -> c_int {
    // SAFETY: NULL or whole by this function's contract.
    let given = unsafe { (configuration.as_ref(), given.cast::<[c_float; 3]>().as_ref()) };
    let ((Some(&RobotConfiguration { A1, A2, A3, d_B1B3, d_e }), Some(given)), false) = (given, out.is_null()) else {
        return DP_RC_ERROR_GENERIC;
    };
    let geometry = Geometry { joints: [A1, A2, A3], edge: d_B1B3, offset: d_e };
    match solve(&geometry, *given) {
        Ok(found) => {
            // SAFETY: as above.
            unsafe { out.cast::<[c_float; 3]>().write(found) };
            DP_RC_SUCCESS
        }
        Err(Error::Input) => DP_RC_ERROR_GENERIC,
        Err(Error::NoPose) => DP_RC_NO_POSE,
    }
}
