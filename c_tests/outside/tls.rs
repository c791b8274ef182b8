//! TLS with authorities of one's own.

use super::broker::Broker;
use super::*;
use crate::support::{has_tool, run, text};

/// Makes an authority, and what it vouches for, in a directory.
fn certificates(directory: &Path) {
    let openssl = |arguments: &[&str]| {
        let output = run(Command::new("openssl").args(arguments).current_dir(directory));
        assert!(output.status.success(), "{}", text(&output));
    };
    fs::write(directory.join("names"), "subjectAltName=DNS:localhost\n").unwrap();
    let new = ["req", "-newkey", "rsa:2048", "-nodes", "-subj"];
    openssl(&[&new[..], &["/CN=Authority", "-x509", "-days", "2", "-keyout", "ca.key", "-out", "ca.pem"]].concat());
    openssl(&[&new[..], &["/CN=localhost", "-keyout", "broker.key", "-out", "broker.csr"]].concat());
    let sign =
        ["x509", "-req", "-in", "broker.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2"];
    openssl(&[&sign[..], &["-extfile", "names", "-out", "broker.pem"]].concat());
}

#[test]
fn whom_the_authority_vouches_for_is_trusted_and_nobody_else() {
    if !has_tool("openssl", "version") {
        return;
    }
    let directory = empty("tls");
    certificates(&directory);
    let path = |name: &str| utf8(&directory.join(name)).to_owned();
    let lines = format!(
        "cafile {}\ncertfile {}\nkeyfile {}\nallow_anonymous true\n",
        path("ca.pem"),
        path("broker.pem"),
        path("broker.key")
    );
    let Some(broker) = Broker::with(&lines) else { return };
    let settings = |more: &str| format!("[mqtt]\nurl = \"mqtts://localhost:{}\"\n{more}\n", broker.port);
    let trusting = Server::start(&settings(&format!("ca_file = \"{}\"", path("ca.pem"))));
    found("it is connected", || (trusting.metric("deltarobot_mqtt_up") > 0).then_some(()));

    let other = empty("tls-other");
    certificates(&other);
    let doubting = Server::start(&settings(&format!("ca_file = \"{}\"", utf8(&other.join("ca.pem")))));
    found("it is said", || doubting.said().contains("certificate").then_some(()));
    assert_eq!(doubting.metric("deltarobot_mqtt_connections_total"), 0);
    // And of another name than the certificate's.
    let misled =
        Server::start(&settings(&format!("ca_file = \"{}\"", path("ca.pem"))).replace("localhost", "127.0.0.1"));
    found("it is said", || misled.said().contains("certificate").then_some(()));
}
