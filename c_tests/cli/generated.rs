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

/// What `make install-cli` puts below a prefix, from a program that was built before, and `uninstall-cli` removes.
#[test]
fn all_of_it_is_installed() {
    let (out, prefix) = (out_dir().join("cli-built"), out_dir().join("cli-installed"));
    let _ = fs::remove_dir_all(&prefix);
    fs::create_dir_all(&out).unwrap();
    fs::copy(env!("CARGO_BIN_EXE_deltarobot"), out.join("deltarobot")).unwrap();
    let make = |goal: &str| {
        let directories = [format!("OUT={}", utf8(&out)), format!("PREFIX={}", utf8(&prefix))];
        let mut make = Command::new("make");
        make.current_dir(root()).env_remove("MAKEFLAGS").env_remove("DESTDIR");
        let output = run(make.args([goal, "CARGO=no-such-cargo"]).args(directories));
        assert!(output.status.success(), "{}", text(&output));
    };
    let files = [
        "bin/deltarobot",
        "share/man/man1/deltarobot.1",
        "share/man/man1/deltarobot-move.1",
        "share/bash-completion/completions/deltarobot",
        "share/zsh/site-functions/_deltarobot",
        "share/fish/vendor_completions.d/deltarobot.fish",
    ];
    make("install-cli");
    for file in files {
        assert!(fs::metadata(prefix.join(file)).is_ok_and(|it| it.len() > 0), "{file} is not installed");
    }
    make("uninstall-cli");
    let left = run(Command::new("find").arg(&prefix).args(["-type", "f"]));
    assert_eq!(String::from_utf8_lossy(&left.stdout), "");
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
