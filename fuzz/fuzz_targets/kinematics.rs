//! The platform's kinematics, of any geometry: what is returned is a number, and a pose has the lengths that were asked for.
#![no_main]
#![allow(non_snake_case, reason = "the names of the C ABI")]

use deltarobot::kinematics::*;
use deltarobot_fuzz::input::Input;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    let raw = input.byte();
    // Any bits at all, or numbers as robots have them.
    let mut number = || match raw {
        0 => f32::from_le_bytes(input.bytes()),
        _ => f32::from(i16::from_le_bytes(input.bytes())) / 16384.0,
    };
    let mut triple = || [(); 3].map(|()| number());
    let [A1, A2, A3, pose, lengths, [d_B1B3, d_e, _]] = [(); 6].map(|()| triple());
    let robot = RobotConfiguration { A1, A2, A3, d_B1B3, d_e };
    if let Some(lengths) = inverse(&robot, pose) {
        check_forward(&robot, lengths);
    }
    check_forward(&robot, lengths.map(f32::abs));
});

type Function = unsafe extern "C" fn(*const RobotConfiguration, *const f32, *mut f32) -> i32;

fn answer(function: Function, robot: &RobotConfiguration, given: [f32; 3]) -> Option<[f32; 3]> {
    let mut found = Box::new([f32::NAN; 3]);
    let code = unsafe { function(robot, given.as_ptr(), found.as_mut_ptr()) };
    match code {
        0 => assert!(found.iter().all(|number| number.is_finite()), "{found:?}"),
        1 | DP_RC_NO_POSE => assert!(found.iter().all(|number| number.is_nan()), "{found:?}"),
        code => panic!("{code}"),
    }
    (code == 0).then_some(*found)
}

fn inverse(robot: &RobotConfiguration, pose: [f32; 3]) -> Option<[f32; 3]> {
    let lengths = answer(dp_kinematics_inverse, robot, pose)?;
    assert!(lengths.iter().all(|length| *length >= 0.0), "{lengths:?}");
    Some(lengths)
}

fn check_forward(robot: &RobotConfiguration, lengths: [f32; 3]) {
    let Some(pose) = answer(dp_kinematics_forward, robot, lengths) else { return };
    let met = inverse(robot, pose).expect("there is a pose");
    let sum = |numbers: [f64; 3]| numbers.iter().sum::<f64>();
    let off = sum([0, 1, 2].map(|leg| (f64::from(met[leg]) - f64::from(lengths[leg])).abs()));
    assert!(off <= 1.001e-5 * sum(lengths.map(f64::from)), "{pose:?} has {met:?}, not {lengths:?}");
}
