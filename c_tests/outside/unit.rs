//! The systemd unit.

use super::*;
use crate::support::{has_tool, root, run, text};

/// Of what systemd does not know it only warns.
#[test]
fn systemd_takes_every_line() {
    if !has_tool("systemd-analyze", "--version") {
        return;
    }
    let unit = empty("unit").join("deltarobot-serve.service");
    let shipped = fs::read_to_string(root().join("packaging/deltarobot-serve.service")).unwrap();
    let installed = "/usr/local/bin/deltarobot-serve";
    assert!(shipped.contains(installed));
    let verified = |shipped: &str| {
        fs::write(&unit, shipped.replace(installed, env!("CARGO_BIN_EXE_deltarobot-serve"))).unwrap();
        let output = run(Command::new("systemd-analyze").arg("verify").arg(&unit));
        // Units of the system that it needs are looked at as well.
        let (status, said) = (output.status.success(), text(&output));
        let said: Vec<_> = said.lines().filter(|line| line.contains("deltarobot-serve.service")).collect();
        (status, said.join("\n"))
    };
    assert_eq!(verified(&shipped), (true, String::new()));
    assert!(verified(&shipped.replace("ProtectHome", "ProtectHouse")).1.contains("ProtectHouse"));
}
