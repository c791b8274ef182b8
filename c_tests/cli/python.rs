//! The Python package, which drives simulated robots.

use super::*;

#[test]
fn the_python_package_is_installed_and_drives_robots() {
    if !has_tool("python3", "--version") {
        return;
    }
    let script = root().join("c_tests/packaging/python.sh");
    // Without a limit: packages come from elsewhere.
    let work = Path::new(env!("CARGO_TARGET_TMPDIR")).join("python");
    let output = Command::new(script).arg(program()).arg(work).output().unwrap();
    if output.status.code() == Some(77) {
        is_missing(&text(&output));
        return;
    }
    assert!(output.status.success(), "{}", text(&output));
}
