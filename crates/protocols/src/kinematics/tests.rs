use super::{Error, Geometry, Real, forward, inverse};
use proptest::{prelude::Rng, test_runner::TestRunner};

/// That of the graphical host program.
const UPRIGHT: Geometry =
    Geometry { joints: [[0.12, 0.0, 0.10], [0.38, 0.0, 0.25], [0.12, 0.0, 0.40]], edge: 0.15, offset: 0.08 };
const FLAT: Geometry =
    Geometry { joints: [[-0.2, 0.0, 0.0], [0.0, 0.3, 0.05], [0.2, 0.0, 0.0]], edge: 0.12, offset: 0.06 };

/// Poses and the lengths of their legs, computed apart from this library.
const TABLE: [(Geometry, [f32; 3], [f32; 3]); 9] = [
    (UPRIGHT, [0.25, 0.4, 0.25], [0.427_229_4, 0.379_126_6, 0.427_229_4]),
    (UPRIGHT, [0.2, 0.3, 0.2], [0.296_586_5, 0.301_835_4, 0.349_293_9]),
    (UPRIGHT, [0.13, 0.4, 0.1], [0.379_937_9, 0.458_053_5, 0.484_816_4]),
    (UPRIGHT, [0.3, 0.5, 0.3], [0.554_208_6, 0.475_561_9, 0.523_628]),
    (UPRIGHT, [0.25, 0.4, 0.35], [0.476_274_4, 0.392_093_1, 0.400_048_6]),
    (FLAT, [0.0, 0.0, 0.5], [0.519_230_2, 0.51, 0.519_230_2]),
    (FLAT, [0.1, 0.05, 0.4], [0.486_166, 0.404_502_4, 0.387_396]),
    (FLAT, [-0.15, -0.1, 0.6], [0.593_968_1, 0.672_386_4, 0.687_603_1]),
    (FLAT, [0.0, 0.2, 0.45], [0.511_957, 0.378_338, 0.511_957]),
];

fn distance(one: [f32; 3], other: [f32; 3]) -> f32 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f32::max)
}

/// The same poses each time, all over a work space whose sides are 1.
fn poses(count: usize) -> impl Iterator<Item = [f32; 3]> {
    TestRunner::deterministic().new_rng().random_iter().take(count)
}

fn is_exact<R: Real>(table_tolerance: f32, tolerance: f32) {
    for (geometry, pose, lengths) in TABLE {
        assert!(distance(inverse::<R>(&geometry, pose).unwrap(), lengths) < 2e-7, "lengths at {pose:?}");
        assert!(distance(forward::<R>(&geometry, lengths).unwrap(), pose) < table_tolerance, "pose of {lengths:?}");
    }
    for [x, y, z] in poses(5_000) {
        for (geometry, pose) in
            [(UPRIGHT, [x * 0.5, 0.2 + y * 0.6, z * 0.5]), (FLAT, [x * 0.6 - 0.3, y * 0.6 - 0.3, 0.3 + z * 0.5])]
        {
            let lengths = inverse::<R>(&geometry, pose).unwrap();
            let found = forward::<R>(&geometry, lengths).unwrap();
            assert!(distance(found, pose) < tolerance, "{pose:?}: {found:?}");
        }
    }
}

#[test]
fn either_width_is_exact() {
    is_exact::<f64>(3e-7, 3e-7);
    is_exact::<f32>(3e-6, 5e-6);
}

/// Close to the base, where several poses have the same lengths, it is one of them, wherever there is one at all.
#[test]
fn close_to_the_base_lengths_are_met() {
    let mut lost = 0;
    for [x, y, z] in poses(20_000) {
        let pose = [x * 0.5, 0.001 + y * 0.2, z * 0.5];
        let lengths = inverse::<f64>(&UPRIGHT, pose).unwrap();
        match forward::<f64>(&UPRIGHT, lengths) {
            Ok(found) => assert!(distance(inverse::<f64>(&UPRIGHT, found).unwrap(), lengths) < 2e-5, "{pose:?}"),
            Err(error) => {
                assert_eq!(error, Error::NoPose);
                lost += 1;
            }
        }
    }
    assert!(lost < 40, "{lost} of 20000 poses not found");
}

#[test]
fn mirrored_poses_have_the_same_lengths() {
    let lengths = inverse::<f64>(&UPRIGHT, [0.2, -0.3, 0.2]).unwrap();
    assert_eq!(Ok(lengths), inverse::<f64>(&UPRIGHT, [0.2, 0.3, 0.2]));
    assert!(distance(forward::<f64>(&UPRIGHT, lengths).unwrap(), [0.2, 0.3, 0.2]) < 3e-7);
    // The legs numbered from the other end: the other side.
    let [a1, a2, a3] = UPRIGHT.joints;
    let [q1, q2, q3] = lengths;
    let turned = Geometry { joints: [a3, a2, a1], ..UPRIGHT };
    assert!(distance(forward::<f64>(&turned, [q3, q2, q1]).unwrap(), [0.2, -0.3, 0.2]) < 3e-7);
}

/// The original gives a NaN for poses in the plane of the joints.
#[test]
fn poses_in_the_plane_of_the_joints() {
    let lengths = inverse::<f64>(&UPRIGHT, [0.6, 0.0, 0.25]).unwrap();
    assert!(distance(lengths, [0.485_824_04, 0.234_094, 0.485_824_04]) < 2e-7, "{lengths:?}");
    let lengths = inverse::<f64>(&UPRIGHT, [-0.2, 0.0, 0.3]).unwrap();
    assert!(distance(forward::<f64>(&UPRIGHT, lengths).unwrap(), [-0.2, 0.0, 0.3]) < 3e-6);
}

#[test]
fn an_edge_at_ninety_degrees() {
    // E straight above A2' along a: u is against w, whichever way E lies.
    let (q1, q2, q3) = (0.449_694_34, 0.17, 0.185);
    assert!(distance(inverse::<f64>(&UPRIGHT, [0.38, 0.0, 0.4]).unwrap(), [q1, q2, q3]) < 2e-7);
    assert!(distance(inverse::<f64>(&UPRIGHT, [0.38, 0.0, 0.1]).unwrap(), [0.335, q2, 0.352_455_67]) < 2e-7);
}

#[test]
fn no_pose() {
    let refused = |pose| inverse::<f64>(&UPRIGHT, pose) == Err(Error::NoPose);
    // On the line A1A3, beyond its ends too, and at a float's rounding from it.
    for pose in [[0.12, 0.0, 0.25], [0.12, 0.0, 0.1], [0.12, 0.0, -3.0], [0.120_000_01, 0.0, 0.25]] {
        assert!(refused(pose), "{pose:?}");
    }
    // Leg 2 perpendicular to the plane.
    assert!(refused([0.25, 0.13, 0.25]) && refused([0.38, 0.0, 0.25]));
    for lengths in [[0.3, 1.2, 0.3], [0.0; 3], [1.0, 0.4, 0.1], [-0.427_229_4, 0.379_126_6, 0.427_229_4]] {
        assert_eq!(forward::<f64>(&UPRIGHT, lengths), Err(Error::NoPose), "{lengths:?}");
        assert_eq!(forward::<f32>(&UPRIGHT, lengths), Err(Error::NoPose), "{lengths:?}");
    }
    // Joints in a line, about which the platform turns: the lengths of a pose, but not the pose of lengths.
    let [a1, _, a3] = UPRIGHT.joints;
    let line = Geometry { joints: [a1, [0.12, 0.0, 0.3], a3], ..UPRIGHT };
    let lengths = inverse::<f64>(&line, [0.25, 0.4, 0.25]).unwrap();
    assert_eq!(forward::<f64>(&line, lengths), Err(Error::NoPose));
}

#[test]
fn unfit_input() {
    let nothing = Geometry { joints: [[0.0; 3]; 3], edge: 0.0, offset: 0.0 };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (place, numbers) in [[bad, 0.4, 0.4], [0.4, bad, 0.4], [0.4, 0.4, bad]].into_iter().enumerate() {
            assert_eq!(inverse::<f64>(&UPRIGHT, numbers), Err(Error::Input));
            assert_eq!(forward::<f64>(&UPRIGHT, numbers), Err(Error::Input));
            let mut geometry = UPRIGHT;
            geometry.joints[place] = numbers;
            assert_eq!(inverse::<f64>(&geometry, [0.25, 0.4, 0.25]), Err(Error::Input));
        }
        for geometry in [Geometry { edge: bad, ..UPRIGHT }, Geometry { offset: bad, ..UPRIGHT }, nothing] {
            assert_eq!(inverse::<f64>(&geometry, [0.25, 0.4, 0.25]), Err(Error::Input));
            assert_eq!(forward::<f64>(&geometry, [0.4; 3]), Err(Error::Input));
        }
    }
}

/// Any unit of length, and numbers whose squares are no floats.
#[test]
fn scaled() {
    let [_, (_, pose, lengths), ..] = TABLE;
    for factor in [1e-15, 1000.0, 1e15, 1e30] {
        let scaled = |numbers: [f32; 3]| numbers.map(|number| number * factor);
        let geometry = Geometry { joints: UPRIGHT.joints.map(scaled), edge: 0.15 * factor, offset: 0.08 * factor };
        let near = |found: [f32; 3], wanted| distance(found.map(|number| number / factor), wanted) < 1e-6;
        assert!(near(inverse::<f64>(&geometry, scaled(pose)).unwrap(), lengths), "{factor}");
        assert!(near(forward::<f64>(&geometry, scaled(lengths)).unwrap(), pose), "{factor}");
    }
    let huge = Geometry { joints: UPRIGHT.joints.map(|joint| joint.map(|number| number * 1e30)), ..UPRIGHT };
    assert_eq!(inverse::<f32>(&huge, [1e30; 3]), Err(Error::Input));
    assert!(forward::<f32>(&huge, [1e30; 3]).is_err());
    assert_eq!(inverse::<f64>(&UPRIGHT, [f32::MAX; 3]), Err(Error::Input));
}
