//! Whatever comes from outside is read or refused, and nothing else happens.

use deltarobot_cli::path::Machine;
use proptest::prelude::*;

use crate::api::{self, compute, motion, path};
use crate::mqtt::commands;
use crate::{config, watch};

/// Bytes that are nearly what is wanted, so that they get somewhere.
fn nearly(words: &'static [&'static str]) -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        8 => proptest::sample::select(words).prop_map(|word| word.as_bytes().to_vec()),
        1 => proptest::collection::vec(any::<u8>(), 0..4),
        1 => any::<f64>().prop_map(|number| number.to_string().into_bytes()),
    ];
    proptest::collection::vec(word, 0..24).prop_map(|words| words.concat())
}

const JSON: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"displacements\":",
    "\"position\":",
    "\"relative\":true",
    "\"wait\":",
    "[1,2,3]",
    "1e39",
    "null",
    "\"seconds\":",
    "\"geometry\":",
    "\"joints\":",
    "\"edge\":1",
    "\"offset\":0",
    "\"arms\":",
    " ",
    "\"expires\":",
    "\"2026-11-28T20:41:15Z\"",
    "\"+262142-12-31T23:59:59Z\"",
    "\"type\":\"lease\"",
    "\"robot\":\"lab\"",
    "\"force\":true",
    "\"points\":",
    "\"tolerance\":1",
    "\"file\":\"0,0,0\"",
    "\"format\":\"csv\"",
    "\"plane\":",
];
const GEOMETRY: &str = include_str!("../../../examples/geometry.toml");
const TOML: &[&str] = &[
    "[robots.a]",
    "\n",
    "port=\"x\"\n",
    "listen=",
    "\"127.0.0.1:1\"",
    "baud=",
    "9600",
    "[tokens]\n",
    "geometry=",
    "{",
    "}",
    "[",
    "]",
    "=",
    "\"",
    "'",
    "#",
    "layout=\"spec\"\n",
    "raw=\"[::1]:1\"\n",
    "\u{fc}",
];
const RECORDING: &[&str] = &[
    "# deltarobot recording 1\n",
    "0.1 > 24 53 00 B1 3A\n",
    "0.2 < ",
    "24 73 0D",
    "\n",
    "# started ",
    "2026-11-28T20:41:15Z",
    "# gap ",
    "1e308",
    "nan",
    " FF",
    "9999999999 < 24\n",
];

proptest! {
    #[test]
    fn requests(bytes in nearly(JSON)) {
        let _ = api::parse::<motion::HomeRequest>(&bytes);
        let _ = api::parse::<motion::LeaseRequest>(&bytes);
        if let Ok(request) = api::parse::<motion::MoveRequest>(&bytes) {
            let _ = request.goal();
        }
        if let Ok(request) = api::parse::<compute::ForwardRequest>(&bytes) {
            let _ = request.poses();
        }
        if let (Ok(request), Ok(machine)) = (api::parse::<path::PathRequest>(&bytes), Machine::read(GEOMETRY)) {
            let _ = request.prepare(&machine);
        }
        let _ = api::parse::<Machine>(&bytes);
        let _ = api::parse::<watch::Asked>(&bytes);
        for word in ["home", "move", "cancel", ""] {
            let _ = commands::read(word, &bytes);
        }
    }

    #[test]
    fn configurations(bytes in nearly(TOML)) {
        if let Ok(file) = config::parse(&String::from_utf8_lossy(&bytes)) {
            let _ = file.check(false);
        }
    }

    #[test]
    fn recordings(bytes in nearly(RECORDING)) {
        let _ = compute::decode(&[b"# deltarobot recording 1\n", bytes.as_slice()].concat());
    }

    #[test]
    fn poses_of_any_measures(joints: [[f32; 3]; 3], edge: f32, offset: f32, at: [f32; 3]) {
        let text = serde_json::json!({ "joints": joints, "edge": edge, "offset": offset }).to_string();
        if let Ok(geometry) = api::parse::<Machine>(text.as_bytes()) {
            let pose = geometry.pose(at);
            prop_assert!(pose.is_none_or(|pose| pose.iter().all(|number| number.is_finite())));
            let legs = geometry.displacements(at.map(f64::from)).ok();
            prop_assert!(legs.is_none_or(|legs| legs.iter().all(|number| number.is_finite())));
        }
    }
}
