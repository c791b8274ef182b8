//! Completions, manual pages, and subcommands that are programs of their own.

use std::os::unix::fs::PermissionsExt;

use super::*;

const SUBCOMMANDS: [&str; 13] = [
    "sim", "home", "move", "status", "cancel", "path", "run", "send", "monitor", "decode", "ports", "record", "replay",
];

#[test]
fn completions_know_all_subcommands() {
    for shell in ["bash", "zsh", "fish"] {
        let script = printed(&["completions", shell], FINISHED);
        for name in SUBCOMMANDS {
            assert!(script.contains(name), "{shell}: {name}");
        }
        let file = fresh(&format!("cli-completions.{shell}"));
        fs::write(&file, script).unwrap();
        if shell == "bash" {
            let output = run(Command::new("bash").arg("-n").arg(&file));
            assert!(output.status.success(), "{}", text(&output));
        }
    }
}

#[test]
fn each_subcommand_has_a_manual_page() {
    let directory = out_dir().join("cli-man");
    let _ = fs::remove_dir_all(&directory);
    printed(&["man", utf8(&directory)], FINISHED);
    for name in SUBCOMMANDS {
        let page = fs::read_to_string(directory.join(format!("deltarobot-{name}.1"))).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(".SH OPTIONS"), "{page}");
    }
    assert!(fs::read_to_string(directory.join("deltarobot.1")).unwrap().contains("Exit status"));
}

#[test]
fn programs_in_the_path_are_subcommands() {
    let directory = out_dir().join("cli-path");
    fs::create_dir_all(&directory).unwrap();
    let program = directory.join("deltarobot-greet");
    fs::write(&program, "#!/bin/sh\necho \"hello $*\"\nexit 7\n").unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let output = run(deltarobot(&["greet", "a", "--b"]).env("PATH", &directory));
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(7), b"hello a --b\n".as_slice()));
    // Only with that name, and only programs.
    fs::set_permissions(&program, fs::Permissions::from_mode(0o644)).unwrap();
    for name in ["greet", "../greet"] {
        let output = run(deltarobot(&[name]).env("PATH", &directory));
        assert_eq!(output.status.code(), Some(USAGE), "{}", text(&output));
    }
}
