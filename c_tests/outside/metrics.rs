//! `/metrics`, as scrapers read it.

use std::collections::{BTreeMap, BTreeSet};

use super::*;

#[test]
fn every_line_is_one_of_the_format() {
    let directory = empty("metrics");
    let server = Server::start(&format!("[record]\ndirectory = \"{}\"\n", utf8(&directory)));
    found("frames have come", || (server.metric("deltarobot_frames_total{robot=\"sim1\"}") > 0).then_some(()));
    found("records are written", || (server.metric("deltarobot_record_bytes_total") > 0).then_some(()));
    let page = server.get("/metrics");
    let (mut kinds, mut helps, mut seen) = (BTreeMap::new(), BTreeSet::new(), BTreeSet::new());
    for line in page.lines() {
        if let Some(comment) = line.strip_prefix("# ") {
            let words: Vec<_> = comment.splitn(3, ' ').collect();
            let is_new = match words[0] {
                "HELP" => helps.insert(words[1]),
                "TYPE" => kinds.insert(words[1], words[2]).is_none(),
                _ => panic!("{line}"),
            };
            assert!(is_new && !words[2].is_empty(), "{line}");
            continue;
        }
        let (series, value) = line.rsplit_once(' ').unwrap();
        let name = series.split('{').next().unwrap();
        assert!(name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_'), "{line}");
        assert!(value.parse::<f64>().unwrap() >= 0.0, "{line}");
        assert!(helps.contains(name) && ["counter", "gauge"].contains(&kinds[name]), "{line}");
        assert_eq!(kinds[name] == "counter", name.ends_with("_total"), "{line}");
        assert!(seen.insert(series), "twice: {line}");
    }
    for name in ["link_up{robot=\"sim1\"} 1", "watchers{robot=\"sim1\"} 0", "dropped_total 0", "record_up 1"] {
        assert!(page.contains(&format!("deltarobot_{name}\n")), "{name}:\n{page}");
    }
}
