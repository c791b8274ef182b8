//! What packagers and users of the library do with it: `make` with all its variables, `make install`, pkg-config,
//! CMake, and trees in which this directory stands in the place of the original's.

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::support::{STRICT, c_tests, compiler, has_tool, root, run, text};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What the consumer prints when it was built for the default sizes.
const DEFAULT: &str = concat!(env!("CARGO_PKG_VERSION"), " 128 32 8\n");

/// One test at a time, as all of them let cargo work in one directory: compiling the generator of the headers
/// takes most of the time.
static TURN: Mutex<()> = Mutex::new(());

/// An empty directory for a test, whose turn it is now.
struct Sandbox {
    dir: PathBuf,
    _turn: MutexGuard<'static, ()>,
}

impl Sandbox {
    fn new(test: &str) -> Self {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let dir = all_sandboxes().join(test);
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Self { dir, _turn: turn }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }

    /// `make` with these arguments, in the directory of the project.
    #[expect(clippy::unused_self, reason = "reads like the others")]
    fn make(&self, arguments: &[&str]) -> Output {
        run(tool("make").current_dir(root()).arg(format!("OUT={}", out().display())).args(arguments))
    }

    /// Installs below a prefix in here.
    fn install(&self, prefix: &str, arguments: &[&str]) -> PathBuf {
        let prefix = self.path(prefix);
        success(&self.make(&[&["install", &format!("PREFIX={}", prefix.display())], arguments].concat()));
        prefix
    }

    /// A copy of the project as a fresh clone has it.
    fn tree(&self, name: &str) -> PathBuf {
        let tree = self.path(name);
        fs::create_dir(&tree).unwrap();
        for entry in fs::read_dir(root()).unwrap().map(Result::unwrap) {
            if !["target", "build", ".git", "fuzz"].iter().any(|skipped| entry.file_name() == *skipped) {
                success(&run(Command::new("cp").arg("-R").arg(entry.path()).arg(&tree)));
            }
        }
        // What a build in the tree itself has left.
        let _ = fs::remove_file(tree.join("include/libdeltarobot/sizes_in_place.h"));
        tree
    }

    /// Configures and builds the consumer by CMake and runs it: what it prints.
    fn cmake(&self, language: &str, target: &str, arguments: &[&str]) -> String {
        let build = self.path(&format!("build-{language}-{}", target.replace(':', "")));
        let source = c_tests().join("packaging");
        let settings = [format!("-DLANGUAGE={language}"), format!("-DTARGET={target}")];
        success(&run(tool("cmake").arg("-S").arg(source).arg("-B").arg(&build).args(settings).args(arguments)));
        success(&run(tool("cmake").arg("--build").arg(&build)));
        success(&run(&mut Command::new(build.join("consumer"))))
    }
}

fn all_sandboxes() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("packaging")
}

/// Where these tests let `make` build, for all sizes.
fn out() -> PathBuf {
    all_sandboxes().join("out")
}

/// A program without what an outer `make` or a user's environment would tell it.
fn tool(name: &str) -> Command {
    let mut command = Command::new(name);
    for variable in [
        "MAKEFLAGS",
        "MFLAGS",
        "MAKELEVEL",
        "CARGO_MAKEFLAGS",
        "OUT",
        "DP_BUFSIZE",
        "DP_DATA_MAX_SIZE",
        "DP_TARGET",
        "CROSS_COMPILE",
        "SHARED",
        "DESTDIR",
        "PREFIX",
        "LIBDIR",
        "INCLUDEDIR",
        "V",
    ] {
        command.env_remove(variable);
    }
    command.env("CARGO_DIR", all_sandboxes().join("cargo"));
    command
}

fn success(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The files and symbolic links below a directory, by their paths in it.
fn files(dir: &Path) -> BTreeSet<String> {
    fn collect(dir: &Path, base: &Path, found: &mut BTreeSet<String>) {
        for entry in fs::read_dir(dir).into_iter().flatten().map(Result::unwrap) {
            if entry.file_type().unwrap().is_dir() {
                collect(&entry.path(), base, found);
            } else {
                found.insert(entry.path().strip_prefix(base).unwrap().display().to_string());
            }
        }
    }
    let mut found = BTreeSet::new();
    collect(dir, dir, &mut found);
    found
}

/// What `make install` shall put below the prefix.
fn installed(prefix: &str, libdir: &str, includedir: &str) -> BTreeSet<String> {
    let major = VERSION.split('.').next().unwrap();
    let mut expected: BTreeSet<_> =
        files(&root().join("include")).iter().map(|header| format!("{includedir}/{header}")).collect();
    expected.extend([
        format!("{prefix}share/deltarobot/protocol_pc_utils.cpp"),
        format!("{libdir}/libdeltarobot.a"),
        format!("{libdir}/libdeltarobot.so"),
        format!("{libdir}/libdeltarobot.so.{major}"),
        format!("{libdir}/libdeltarobot.so.{VERSION}"),
        format!("{libdir}/pkgconfig/deltarobot.pc"),
        format!("{libdir}/cmake/deltarobot/deltarobot-config.cmake"),
        format!("{libdir}/cmake/deltarobot/deltarobot-config-version.cmake"),
    ]);
    expected
}

#[test]
fn artifacts_export_what_they_should_and_need_nothing() {
    const LARGE: [&str; 4] = ["OLP_LINE_MAX=1000", "OLP_WINDOW_MAX=64", "OLP_REPLY_MAX=255", "GX_QUEUE_MAX=255"];
    let sandbox = Sandbox::new("artifacts");
    // One after the other in the same directory: nothing of the sizes before may be left.
    for (bufsize, data_max, others) in [(128, 32, &[][..]), (512, 255, &LARGE), (6, 1, &[]), (128, 32, &[])] {
        let sizes = [format!("DP_BUFSIZE={bufsize}"), format!("DP_DATA_MAX_SIZE={data_max}")];
        success(&sandbox.make(&[&["check-artifact", &sizes[0], &sizes[1]], others].concat()));
        let header = fs::read_to_string(out().join("include/libdeltarobot/sizes.h")).unwrap();
        assert!(header.contains(&format!("#define DP_BUFSIZE {bufsize}\n")), "the header is not for {bufsize}");
    }
}

#[test]
fn nothing_is_made_again_when_nothing_has_changed() {
    let sandbox = Sandbox::new("again");
    let times = || {
        success(&sandbox.make(&["-j4"]));
        let time = |name| fs::metadata(out().join(name)).unwrap().modified().unwrap();
        ["libdeltarobot.a", "libdeltarobot.so", "include/libdeltarobot/protocol.h", ".stage/serial.o"].map(time)
    };
    assert_eq!(times(), times());
}

#[test]
fn wrong_sizes_are_refused_and_leave_the_library_alone() {
    let sandbox = Sandbox::new("refused");
    for (size, message) in [
        ("DP_BUFSIZE=10", "DP_BUFSIZE is too small: the ring must hold one maximal frame"),
        ("DP_BUFSIZE=3000000000", "DP_BUFSIZE is too large"),
        ("DP_DATA_MAX_SIZE=0", "DP_DATA_MAX_SIZE must be between 1 and 255"),
        ("DP_DATA_MAX_SIZE=256", "DP_DATA_MAX_SIZE must be between 1 and 255"),
        ("DP_DATA_MAX_SIZE=abc", "DP_DATA_MAX_SIZE=abc: not a whole number"),
    ] {
        let output = sandbox.make(&["lib", size, &format!("OUT={}", sandbox.path("new").display())]);
        assert!(!output.status.success(), "{size} was built");
        assert!(text(&output).contains(message), "{size}: {}", text(&output));
        assert_eq!(files(&sandbox.path("new")), BTreeSet::new());
    }
    success(&sandbox.make(&["lib"]));
    assert!(!sandbox.make(&["lib", "DP_BUFSIZE=10"]).status.success());
    let header = fs::read_to_string(out().join("include/libdeltarobot/sizes.h")).unwrap();
    assert!(header.contains("#define DP_BUFSIZE 128\n"));
}

#[test]
fn uninstall_removes_what_install_put_there_and_no_more() {
    let sandbox = Sandbox::new("install");
    let prefix = sandbox.install("with a space", &[]);
    assert_eq!(files(&prefix), installed("", "lib", "include"));
    let link = fs::read_link(prefix.join("lib/libdeltarobot.so")).unwrap();
    assert!(link.to_str().unwrap().starts_with("libdeltarobot.so."), "{link:?}");

    let prefix_argument = format!("PREFIX={}", prefix.display());
    fs::write(prefix.join("include/libdeltarobot/mine.h"), "").unwrap();
    success(&sandbox.make(&["uninstall", &prefix_argument]));
    assert_eq!(files(&prefix), BTreeSet::from(["include/libdeltarobot/mine.h".to_owned()]));

    fs::remove_file(prefix.join("include/libdeltarobot/mine.h")).unwrap();
    success(&sandbox.make(&["uninstall", &prefix_argument]));
    assert!(!prefix.join("include/libdeltarobot").exists() && !prefix.join("lib/cmake/deltarobot").exists());
}

#[test]
fn a_staged_tree_tells_its_final_place() {
    let sandbox = Sandbox::new("destdir");
    let stage = sandbox.path("stage here");
    let arguments = [
        &format!("DESTDIR={}", stage.display()),
        "PREFIX=/opt/robot",
        "LIBDIR=/opt/robot/lib/triplet",
        "INCLUDEDIR=/opt/headers",
    ];
    success(&sandbox.make(&[&["install"], &arguments[..]].concat()));
    assert_eq!(files(&stage), installed("opt/robot/", "opt/robot/lib/triplet", "opt/headers"));
    let pc = fs::read_to_string(stage.join("opt/robot/lib/triplet/pkgconfig/deltarobot.pc")).unwrap();
    for line in ["prefix=/opt/robot\n", "libdir=${prefix}/lib/triplet\n", "includedir=/opt/headers\n"] {
        assert!(pc.contains(line), "{pc}");
    }
    success(&sandbox.make(&[&["uninstall"], &arguments[..]].concat()));
    assert_eq!(files(&stage), BTreeSet::new());
}

#[test]
fn install_without_cargo_takes_what_was_built_for_these_sizes_or_nothing() {
    let sandbox = Sandbox::new("no cargo");
    success(&sandbox.make(&["lib"]));
    let install = |prefix: &str, more: &[&str]| {
        let prefix = format!("PREFIX={}", sandbox.path(prefix).display());
        sandbox.make(&[&["install", "CARGO=no-such-cargo", &prefix], more].concat())
    };
    success(&install("same", &[]));
    assert_eq!(files(&sandbox.path("same")), installed("", "lib", "include"));
    for size in ["DP_BUFSIZE=256", "OLP_LINE_MAX=100", "GX_WINDOW_MAX=1"] {
        let output = install("other", &[size]);
        let because = format!("no library with {size}");
        assert!(!output.status.success() && text(&output).contains(&because), "{}", text(&output));
        assert_eq!(files(&sandbox.path("other")), BTreeSet::new());
    }
}

/// Builds the consumer by what pkg-config says and runs it, from C and from C++, statically and shared.
fn pkg_config_consumers(sandbox: &Sandbox, prefix: &Path, expected: &str) {
    for cpp in [false, true] {
        for shared in [false, true] {
            let mut pkg_config = tool("pkg-config");
            pkg_config.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")).args(["--cflags", "--libs", "deltarobot"]);
            let mut flags = success(&run(pkg_config.args(if shared { None } else { Some("--static") })));
            if !shared {
                flags = flags.replace("-ldeltarobot", "-Wl,-Bstatic -ldeltarobot -Wl,-Bdynamic");
            }
            let executable = sandbox.path(&format!("consumer-{cpp}-{shared}"));
            let source = c_tests().join(if cpp { "packaging/consumer.cpp" } else { "packaging/consumer.c" });
            // By the shell, as Makefiles do it, because directories may have spaces.
            let mut shell = Command::new("sh");
            let compile = compiler(cpp);
            shell.args(["-c", &format!("exec \"$@\" {flags}"), "sh"]).arg(compile.get_program());
            shell.args(compile.get_args()).args(STRICT).arg("-o").arg(&executable).arg(source);
            success(&run(&mut shell));
            let mut consumer = Command::new(executable);
            if shared {
                assert!(!run(&mut consumer).status.success(), "the shared library is not looked for");
                consumer.env("LD_LIBRARY_PATH", prefix.join("lib"));
            }
            assert_eq!(success(&run(&mut consumer)), expected);
        }
    }
}

#[test]
fn pkg_config() {
    if !has_tool("pkg-config", "--version") {
        return;
    }
    let sandbox = Sandbox::new("pkg-config");
    let prefix = sandbox.install("prefix", &[]);
    pkg_config_consumers(&sandbox, &prefix, DEFAULT);
    let prefix = sandbox.install("other sizes", &["DP_BUFSIZE=512", "DP_DATA_MAX_SIZE=255", "OLP_WINDOW_MAX=3"]);
    pkg_config_consumers(&sandbox, &prefix, &format!("{VERSION} 512 255 3\n"));
    let sizes = [("dp_bufsize", "512\n"), ("olp_window_max", "3\n"), ("gx_window_max", "16\n")];
    for (size, value) in sizes {
        let mut pkg_config = tool("pkg-config");
        pkg_config.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
        assert_eq!(success(&run(pkg_config.arg(format!("--variable={size}")).arg("deltarobot"))), value);
    }
}

#[test]
fn find_package() {
    if !has_tool("cmake", "--version") {
        return;
    }
    let sandbox = Sandbox::new("find_package");
    let installed = sandbox.install("installed here", &["DP_BUFSIZE=64", "GX_QUEUE_MAX=5"]);
    // The whole tree can be moved.
    let prefix = sandbox.path("and moved");
    fs::rename(installed, &prefix).unwrap();
    let prefix = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    for language in ["C", "CXX"] {
        for target in ["deltarobot::deltarobot", "deltarobot::shared"] {
            let printed = sandbox.cmake(language, target, &["-DHOW=find_package", "-DWANTED_VERSION=1.0", &prefix]);
            assert_eq!(printed, format!("{VERSION} 64 32 8\n"));
        }
    }
    for version in ["1.0", "2.0", "0.9", "1.999"] {
        let build = sandbox.path(version);
        let source = c_tests().join("packaging");
        let settings = ["-DHOW=find_package", "-DLANGUAGE=C", &prefix, &format!("-DWANTED_VERSION={version}")];
        let output = run(tool("cmake").arg("-S").arg(source).arg("-B").arg(build).args(settings));
        assert_eq!(output.status.success(), version == "1.0", "{VERSION} for {version}: {}", text(&output));
        assert_eq!(text(&output).contains("GX_QUEUE_MAX is 5\n"), version == "1.0", "{}", text(&output));
    }
}

#[test]
fn add_subdirectory() {
    if !has_tool("cmake", "--version") {
        return;
    }
    let sandbox = Sandbox::new("add_subdirectory");
    let tree = format!("-DTREE={}", root().display());
    for (language, target) in [("C", "deltarobot"), ("CXX", "deltarobot::deltarobot")] {
        let how = ["-DHOW=add_subdirectory", &tree];
        assert_eq!(sandbox.cmake(language, target, &how), DEFAULT);
        // In the same build directory: everything that depends on the sizes is built again.
        let how = ["-DHOW=add_subdirectory", &tree, "-DDP_BUFSIZE=300", "-DDP_DATA_MAX_SIZE=255", "-DOLP_WINDOW_MAX=2"];
        assert_eq!(sandbox.cmake(language, target, &how), format!("{VERSION} 300 255 2\n"));
    }
}

#[test]
fn add_subdirectory_with_ninja() {
    if !has_tool("cmake", "--version") || !has_tool("ninja", "--version") {
        return;
    }
    let sandbox = Sandbox::new("ninja");
    let how = ["-GNinja", "-DHOW=add_subdirectory", &format!("-DTREE={}", root().display())];
    assert_eq!(sandbox.cmake("C", "deltarobot", &how), DEFAULT);
    assert_eq!(
        sandbox.cmake("C", "deltarobot", &[&how[..], &["-DDP_BUFSIZE=64"]].concat()),
        format!("{VERSION} 64 32 8\n")
    );
    // Everything is there: nothing but the question to cargo.
    let again = success(&run(tool("cmake").arg("--build").arg(sandbox.path("build-C-deltarobot"))));
    assert!(!again.contains("Linking"), "{again}");
}

/// A tree like the original's, with this directory in the place of its own: symbolic links to it, firmware that names its
/// source file and puts the archive last, a program that includes the source, and a host program built by CMake.
#[test]
fn in_place_of_the_original() {
    if !has_tool("cmake", "--version") {
        return;
    }
    let sandbox = Sandbox::new("in place");
    let tree = sandbox.tree("libdeltarobot-1.0");
    for link in ["libdeltarobot", "libdeltarobot-src"] {
        std::os::unix::fs::symlink("libdeltarobot-1.0", sandbox.path(link)).unwrap();
    }
    for file in ["consumer.c", "textual.c", "firmware.mk", "host"] {
        success(&run(Command::new("cp").arg("-R").arg(c_tests().join("packaging").join(file)).arg(&sandbox.dir)));
    }
    let build = |sizes: &[&str]| {
        success(&run(tool("cmake")
            .current_dir(sandbox.path("libdeltarobot"))
            .args(["-S", ".", "-B", "build"])
            .args(sizes)));
        success(&run(tool("cmake").current_dir(&tree).args(["--build", "build"])));
    };
    let host = || {
        let (source, build) = (sandbox.path("host"), sandbox.path("host/build"));
        success(&run(tool("cmake").arg("-S").arg(source).arg("-B").arg(&build)));
        success(&run(tool("cmake").arg("--build").arg(&build).arg("--clean-first")));
        success(&run(&mut Command::new(build.join("host"))))
    };

    let is_untouched = || {
        let changed = run(Command::new("diff")
            .args(["-rq", "-x", "sizes_in_place.h", "include"])
            .arg(root().join("include"))
            .current_dir(&tree));
        assert_eq!(text(&changed), "");
    };

    build(&[]);
    for built in ["libdeltarobot.a", "cross_comm", "send_opcode"] {
        assert!(tree.join("build").join(built).exists(), "{built} was not built");
    }
    success(&run(&mut Command::new(tree.join("build/cross_comm"))));
    for language in ["C", "CXX"] {
        let how = ["-DHOW=include", &format!("-DTREE={}", tree.display())];
        assert_eq!(sandbox.cmake(language, "deltarobot", &how), DEFAULT);
    }
    success(&run(tool("make").current_dir(&sandbox.dir).args(["-f", "firmware.mk", "firmware", "textual"])));
    for program in ["firmware", "textual"] {
        assert_eq!(success(&run(&mut Command::new(sandbox.path(program)))), DEFAULT);
    }
    assert_eq!(host(), "128 ACK: (MOVE!), ACK MOVING ACK: (MOVE!)\n");

    // For other sizes the headers that lie there fit too, and no file of the tree was touched.
    let sizes_in_place = tree.join("include/libdeltarobot/sizes_in_place.h");
    assert!(!sizes_in_place.exists());
    build(&["-DDP_BUFSIZE=256"]);
    assert_eq!(host(), "256 ACK: (MOVE!), ACK MOVING ACK: (MOVE!)\n");
    assert!(sizes_in_place.exists());
    is_untouched();
    build(&["-DDP_BUFSIZE=128"]);
    assert!(!sizes_in_place.exists());

    // The same by make, for programs that are compiled with no option at all, by the path or another link.
    std::os::unix::fs::symlink("../libdeltarobot/include", sandbox.path("host/include")).unwrap();
    let make = |size: &str| success(&run(tool("make").current_dir(&tree).args(["lib", "SHARED=no", size])));
    let by_path = |option: &[&str]| {
        let source = fs::read_to_string(sandbox.path("host/main.cpp")).unwrap();
        for path in ["../libdeltarobot/include/", "include/"] {
            let program = sandbox.path("host/by_path.cpp");
            fs::write(&program, source.replace("../libdeltarobot/include/", path)).unwrap();
            let cpp = |arguments: &[&str]| {
                success(&run(compiler(true).current_dir(sandbox.path("host")).args(arguments)));
            };
            cpp(&[&["-c", "by_path.cpp", "recorded.cpp"], option].concat());
            cpp(&["-I../libdeltarobot/include", "-c", "../libdeltarobot/src/protocol_pc_utils.cpp"]);
            let objects = ["by_path.o", "recorded.o", "protocol_pc_utils.o"];
            cpp(&[&["-o", "by_path"], &objects[..], &["../libdeltarobot/target/release/libdeltarobot.a"]].concat());
            let printed = success(&run(&mut Command::new(sandbox.path("host/by_path"))));
            assert_eq!(printed, "256 ACK: (MOVE!), ACK MOVING ACK: (MOVE!)\n");
        }
    };
    make("DP_BUFSIZE=256");
    by_path(&[]);
    by_path(&["-DDP_BUFSIZE=256"]);
    is_untouched();
    make("DP_BUFSIZE=128");
    assert!(!sizes_in_place.exists());
}

#[test]
fn cmake_installs_what_make_installs() {
    if !has_tool("cmake", "--version") {
        return;
    }
    let sandbox = Sandbox::new("cmake-install");
    let build = sandbox.path("build");
    let prefix = format!("-DCMAKE_INSTALL_PREFIX={}", sandbox.path("prefix").display());
    success(&run(tool("cmake").arg("-S").arg(root()).arg("-B").arg(&build).arg(prefix)));
    success(&run(tool("cmake").arg("--build").arg(&build).args(["--target", "install"])));
    assert_eq!(files(&sandbox.path("prefix")), installed("", "lib", "include"));
}

/// The package that cargo makes holds the whole tree, so that what resolves here resolves there.
#[test]
fn links_in_the_documentation_lead_somewhere() {
    let pages =
        files(&root().join("docs")).into_iter().filter(|file| Path::new(file).extension().is_some_and(|it| it == "md"));
    let docs = pages.map(|page| format!("docs/{page}"));
    for page in docs.chain(["README.md", "ARCHITECTURE.md", "CHANGELOG.md"].map(String::from)) {
        let path = root().join(page);
        let text = fs::read_to_string(&path).unwrap();
        for link in text.split("](").skip(1).map(|rest| rest.split([')', '#']).next().unwrap()) {
            let there = link.is_empty() || link.contains("://") || path.with_file_name(link).exists();
            assert!(there, "{}: {link}", path.display());
        }
    }
}

/// The protocols alone are a dependency of firmware in Rust. With the compiler that firmware builds use, if there is one.
#[test]
fn rust_firmware_depends_on_the_protocols() {
    let target = "thumbv7em-none-eabi";
    let found = run(Command::new(root().join("firmware/build.sh")).arg(target));
    let said = text(&found);
    if !found.status.success() {
        assert!(std::env::var("DP_REQUIRE_TOOLS").as_deref() != Ok("1"), "{said}");
        return;
    }
    let rustc = said.split_whitespace().nth(1).unwrap();
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root().join("examples/rust")).args(["build", "--release", "--target", target, "--target-dir"]);
    cargo.arg(all_sandboxes().join("rust-firmware")).env("RUSTC", rustc);
    if said.contains("core source") {
        cargo.env("CARGO_UNSTABLE_BUILD_STD", "core").env("RUSTC_BOOTSTRAP", "1");
    }
    success(&run(&mut cargo));
}
