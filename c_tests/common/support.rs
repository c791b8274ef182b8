//! The driver of the C tests: builds the library as it is shipped, compiles programs against it and runs them.

use std::collections::HashSet;
use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A program that takes longer hangs.
const TIME_LIMIT: Duration = Duration::from_secs(300);

/// The protocols: each has sizes of its own, and programs that only these concern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Deltarobot,
    Line,
    Gx,
    /// No sizes mean anything to it.
    Serial,
}

/// The sizes a library is built for, as `src/sizes.mk` lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Sizes {
    pub(crate) bufsize: usize,
    pub(crate) data_max: usize,
    olp: [usize; 4],
    gx: [usize; 2],
}

pub(crate) const DEFAULT: Sizes = Sizes::new(128, 32);

/// All as small as they can be.
pub(crate) const SMALLEST: Sizes = Sizes::new(6, 1).olp([63, 1, 64, 1]).gx([1, 1]);

/// All that have an upper limit at that, and the others large: of DP_BUFSIZE, what the original once had.
pub(crate) const LARGEST: Sizes = Sizes::new(512, 255).olp([1000, 64, 255, 255]).gx([255, 255]);

/// The sizes of the original's earlier revisions, and what lies at the edges: besides those above, a ring that holds
/// one maximal frame and no more, and sizes that need padding behind them.
pub(crate) const OTHERS: [Sizes; 5] = [Sizes::new(256, 32), Sizes::new(37, 32), SMALLEST, LARGEST, Sizes::new(101, 17)];

impl Sizes {
    /// Those of the other protocols are the default ones.
    pub(crate) const fn new(bufsize: usize, data_max: usize) -> Self {
        Self { bufsize, data_max, olp: [255, 8, 128, 16], gx: [16, 16] }
    }

    /// Those of the line protocol: longest line, window, longest reply, devices.
    pub(crate) const fn olp(self, olp: [usize; 4]) -> Self {
        Self { olp, ..self }
    }

    /// Those of GX: queue, window.
    pub(crate) const fn gx(self, gx: [usize; 2]) -> Self {
        Self { gx, ..self }
    }

    /// All of them, with their names.
    pub(crate) fn all(self) -> [(&'static str, usize); 8] {
        let Self { bufsize, data_max, olp: [line, commands, reply, devices], gx: [queue, moves] } = self;
        [
            ("DP_BUFSIZE", bufsize),
            ("DP_DATA_MAX_SIZE", data_max),
            ("OLP_LINE_MAX", line),
            ("OLP_WINDOW_MAX", commands),
            ("OLP_REPLY_MAX", reply),
            ("OLP_DEVICES_MAX", devices),
            ("GX_QUEUE_MAX", queue),
            ("GX_WINDOW_MAX", moves),
        ]
    }

    /// Whether a protocol has other sizes than by default.
    pub(crate) fn are_others_for(self, family: Family) -> bool {
        match family {
            Family::Deltarobot => (self.bufsize, self.data_max) != (DEFAULT.bufsize, DEFAULT.data_max),
            Family::Line => self.olp != DEFAULT.olp,
            Family::Gx => self.gx != DEFAULT.gx,
            Family::Serial => false,
        }
    }
}

/// As part of a file's name.
impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.bufsize, self.data_max)?;
        for (name, sizes, default) in [("olp", &self.olp[..], &DEFAULT.olp[..]), ("gx", &self.gx, &DEFAULT.gx)] {
            if sizes != default {
                write!(f, "-{name}")?;
                sizes.iter().try_for_each(|size| write!(f, "-{size}"))?;
            }
        }
        Ok(())
    }
}

/// How a program is linked and run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Static,
    Shared,
    Sanitized,
    /// As under the sanitizers, with a library that sums, copies and searches as it does where flash is scarce.
    SmallLeaves,
    Valgrind,
}

/// The language standard a program is compiled as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    C99,
    C11,
    Cpp98,
}

impl Language {
    pub(crate) fn is_cpp(self) -> bool {
        self == Self::Cpp98
    }

    fn flag(self) -> &'static str {
        match self {
            Self::C99 => "-std=c99",
            Self::C11 => "-std=c11",
            Self::Cpp98 => "-std=c++98",
        }
    }
}

/// The model of the original.
pub(crate) const MODEL: &str = "deltarobot/model/model.c";

/// A program of this directory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) sources: &'static [&'static str],
    pub(crate) language: Language,
    pub(crate) flags: &'static [&'static str],
    pub(crate) family: Family,
    /// What it is given where it runs many times as slowly.
    slowly: &'static [&'static str],
    /// What it is given with `DP_FULL_LENGTH=1`, where it is quickest: its figures are those of docs/.
    fully: &'static [&'static str],
    needs_eigen: bool,
}

impl Program {
    /// In the oldest standard that programs are written for: C99, or C++98 when the first source is `.cpp`.
    pub(crate) const fn of(name: &'static str, sources: &'static [&'static str]) -> Self {
        let language =
            if sources[0].as_bytes()[sources[0].len() - 1] == b'p' { Language::Cpp98 } else { Language::C99 };
        Self {
            name,
            sources,
            language,
            flags: &[],
            family: Family::Deltarobot,
            slowly: &[],
            fully: &[],
            needs_eigen: false,
        }
    }

    pub(crate) const fn language(self, language: Language) -> Self {
        Self { language, ..self }
    }

    pub(crate) const fn flags(self, flags: &'static [&'static str]) -> Self {
        Self { flags, ..self }
    }

    /// The protocol whose sizes it depends on.
    pub(crate) const fn family(self, family: Family) -> Self {
        Self { family, ..self }
    }

    pub(crate) const fn slowly(self, slowly: &'static [&'static str]) -> Self {
        Self { slowly, ..self }
    }

    pub(crate) const fn fully(self, fully: &'static [&'static str]) -> Self {
        Self { fully, ..self }
    }

    pub(crate) const fn needs_eigen(self) -> Self {
        Self { needs_eigen: true, ..self }
    }

    /// What it is given: less to do under valgrind and emulators, and where a library that isn't optimized counts what is run.
    pub(crate) fn args(&self, mode: Mode) -> &'static [&'static str] {
        if mode == Mode::Valgrind || coverage().is_some() || cross().is_some() {
            self.slowly
        } else if mode == Mode::Static && env::var_os("DP_FULL_LENGTH").is_some() {
            self.fully
        } else {
            &[]
        }
    }

    /// The other sizes that mean anything to it.
    pub(crate) fn other_sizes(&self) -> impl Iterator<Item = Sizes> + use<> {
        let family = self.family;
        OTHERS.into_iter().filter(move |sizes| sizes.are_others_for(family))
    }
}

/// The root of the package.
pub(crate) fn root() -> &'static Path {
    let mut dirs = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    dirs.find(|dir| dir.join("c_tests").is_dir()).expect("the package is below the root")
}

/// This directory.
pub(crate) fn c_tests() -> PathBuf {
    root().join("c_tests")
}

/// Another kind of machine, whose programs run here: `hosts.sh` says how.
struct Cross {
    /// Where the library was built for it.
    library: PathBuf,
    /// In front of the names of its compilers.
    prefix: String,
    /// What runs its programs.
    runner: Vec<String>,
}

fn cross() -> Option<&'static Cross> {
    static CROSS: LazyLock<Option<Cross>> = LazyLock::new(|| {
        let library = env::var_os("DP_CROSS_LIBRARY")?.into();
        let [prefix, runner] = ["DP_CROSS_PREFIX", "DP_CROSS_RUNNER"].map(|name| env::var(name).unwrap());
        Some(Cross { library, prefix, runner: runner.split_whitespace().map(Into::into).collect() })
    });
    CROSS.as_ref()
}

/// Where libraries and programs are built.
pub(crate) fn out_dir() -> PathBuf {
    let mut dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_tests");
    if let Some(cross) = cross() {
        dir.push(&cross.prefix);
    }
    fs::create_dir_all(&dir).unwrap();
    dir
}

/// The sizes built in this run. Locked while building, as all sizes share cargo's directory.
static BUILT: LazyLock<Mutex<HashSet<PathBuf>>> = LazyLock::new(Mutex::default);

/// A library as `make` ships it.
#[derive(Clone, Debug)]
pub(crate) struct Library {
    pub(crate) dir: PathBuf,
    pub(crate) sizes: Sizes,
    has_small_leaves: bool,
}

impl Library {
    /// The library for these sizes, built at the first call of this run.
    pub(crate) fn of(sizes: Sizes) -> Self {
        if let Some(cross) = cross() {
            assert_eq!(sizes, DEFAULT, "not built for other machines");
            return Self { dir: cross.library.clone(), sizes, has_small_leaves: false };
        }
        Self::built(Self { dir: out_dir().join(sizes.to_string()), sizes, has_small_leaves: false })
    }

    /// The library that a mode takes.
    pub(crate) fn in_mode(sizes: Sizes, mode: Mode) -> Self {
        if mode != Mode::SmallLeaves || cross().is_some() {
            return Self::of(sizes);
        }
        Self::built(Self { dir: out_dir().join(format!("small-leaves-{sizes}")), sizes, has_small_leaves: true })
    }

    fn built(self) -> Self {
        let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
        if !built.contains(&self.dir) {
            let output = self.make();
            assert!(output.status.success(), "make lib for {}:\n{}", self.sizes, text(&output));
            built.insert(self.dir.clone());
        }
        self
    }

    /// Tries to build for sizes that can't be: what was said.
    pub(crate) fn refusal(sizes: Sizes) -> String {
        let _built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
        let library = Self { dir: out_dir().join("refused"), sizes, has_small_leaves: false };
        let output = library.make();
        assert!(!output.status.success(), "{sizes} was built");
        text(&output)
    }

    fn make(&self) -> Output {
        let mut make = Command::new("make");
        if self.has_small_leaves {
            make.env("RUSTFLAGS", "--cfg small_leaves");
        }
        let cargo_dir = out_dir().join(if self.has_small_leaves { "cargo-small-leaves" } else { "cargo" });
        make.args(["lib", &format!("OUT={}", self.dir.display())])
            .arg(format!("CARGO_DIR={}", cargo_dir.display()))
            .args(self.sizes.all().map(|(name, value)| format!("{name}={value}")))
            .current_dir(root())
            // What an outer `make test` was given is not for this build.
            .env_remove("MAKEFLAGS")
            .env_remove("MFLAGS")
            .env_remove("MAKELEVEL")
            .env_remove("CARGO_MAKEFLAGS")
            .env_remove("DP_TARGET")
            .env_remove("SHARED")
            .output()
            .expect("make does not run")
    }

    pub(crate) fn include(&self) -> PathBuf {
        self.dir.join("include")
    }

    /// The static library; one that counts what is run, when coverage is measured.
    pub(crate) fn archive(&self) -> PathBuf {
        match coverage() {
            Some(dir) => dir.join("libdeltarobot.a"),
            None => self.dir.join("libdeltarobot.a"),
        }
    }
}

/// Where `coverage.sh` has put a library of the default sizes, with all of Rust's standard library in it.
fn coverage() -> Option<PathBuf> {
    env::var_os("DP_COVERAGE").map(PathBuf::from)
}

/// What makes every warning an error.
pub(crate) const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// The compiler that the `cc` crate finds (`CC`, `CXX` and their flags count), with every warning an error.
pub(crate) fn compiler(cpp: bool) -> Command {
    static HOST: LazyLock<String> = LazyLock::new(|| {
        let output = Command::new(env::var_os("RUSTC").unwrap_or("rustc".into())).arg("-vV").output().unwrap();
        let told = String::from_utf8(output.stdout).unwrap();
        told.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc tells its host").to_owned()
    });
    if let Some(cross) = cross() {
        let mut command = Command::new(format!("{}{}", cross.prefix, if cpp { "g++" } else { "gcc" }));
        // Statically, so that a runner needs no other files.
        command.args(["-O1", "-g", "-static"]).args(STRICT);
        return command;
    }
    let mut command = cc::Build::new()
        .cargo_metadata(false)
        .cpp(cpp)
        .target(&HOST)
        .host(&HOST)
        .opt_level(1)
        .debug(true)
        .get_compiler()
        .to_command();
    command.args(STRICT);
    command
}

/// Programs built so far.
static BUILDS: AtomicUsize = AtomicUsize::new(0);

/// Compiles and links a program against a library. In modes that can't be had here: none, after saying so.
pub(crate) fn build(program: &Program, library: &Library, mode: Mode) -> Option<PathBuf> {
    if mode == Mode::Valgrind && !has_tool("valgrind", "--version") || program.needs_eigen && !has_eigen() {
        return None;
    }
    let executable = out_dir().join(format!("{}-{}-{mode:?}", program.name, library.sizes).to_lowercase());
    let executable = if cross().is_some() { executable.with_extension("exe") } else { executable };
    // Another test may be running the same program: it is replaced, never written to.
    let new = executable.with_extension(BUILDS.fetch_add(1, Ordering::Relaxed).to_string());
    let mut command = compiler(program.language.is_cpp());
    command
        .current_dir(c_tests())
        .args([program.language.flag(), "-pthread", "-Icommon"])
        .arg("-I")
        .arg(library.include())
        .args(program.flags)
        .args(program.sources)
        .arg("-o")
        .arg(&new);
    if program.sources.contains(&MODEL) {
        // It does not include the library's header, so nothing else tells it the sizes.
        command.arg(format!("-DDP_BUFSIZE={}", library.sizes.bufsize));
        command.arg(format!("-DDP_DATA_MAX_SIZE={}", library.sizes.data_max));
    }
    if matches!(mode, Mode::Sanitized | Mode::SmallLeaves) {
        command.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
    }
    if mode == Mode::Shared {
        command.arg("-L").arg(&library.dir).arg("-ldeltarobot");
    } else {
        command.arg(library.archive());
        if coverage().is_some() {
            // The symbol brings in what writes the counters when the program ends.
            command.args(["-Wl,-u,__llvm_profile_runtime", "-lgcc_s", "-lm"]);
        }
    }
    let output = run(&mut command);
    assert!(output.status.success(), "{} does not compile: {:?}\n{}", program.name, command.get_args(), text(&output));
    fs::rename(new, &executable).unwrap();
    Some(executable)
}

/// The command that runs a program which was built in this mode.
pub(crate) fn command(executable: &Path, library: &Library, mode: Mode) -> Command {
    let mut command = if mode == Mode::Valgrind {
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["--error-exitcode=99", "--leak-check=full", "-q"]).arg(executable);
        valgrind
    } else if let Some(cross) = cross() {
        let mut runner = Command::new(&cross.runner[0]);
        runner.args(&cross.runner[1..]).arg(executable);
        runner
    } else {
        Command::new(executable)
    };
    if mode == Mode::Shared {
        command.env("LD_LIBRARY_PATH", &library.dir);
    }
    command.current_dir(c_tests());
    command
}

/// Builds a program, runs it and asserts that it succeeds.
pub(crate) fn check<A: AsRef<OsStr>>(program: &Program, sizes: Sizes, mode: Mode, args: &[A]) {
    let library = Library::in_mode(sizes, mode);
    let Some(executable) = build(program, &library, mode) else {
        return;
    };
    let output = run(command(&executable, &library, mode).args(args));
    assert!(output.status.success(), "{} for {sizes}, {mode:?}: {}\n{}", program.name, output.status, text(&output));
    print!("{}", String::from_utf8_lossy(&output.stdout));
}

/// Runs a command to its end, or kills it when that does not come.
pub(crate) fn run(command: &mut Command) -> Output {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let stdout = drain(child.stdout.take());
    let stderr = drain(child.stderr.take());
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > TIME_LIMIT {
            let _ = child.kill();
            let _ = child.wait();
            panic!("{command:?}: still running after {TIME_LIMIT:?}");
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    Output { status, stdout: stdout.join().unwrap(), stderr: stderr.join().unwrap() }
}

fn drain(pipe: Option<impl std::io::Read + Send + 'static>) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// What a program printed, in a message.
pub(crate) fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Whether a tool is here. Where it has to be (`DP_REQUIRE_TOOLS=1`, as CI sets it) its absence is a failure.
pub(crate) fn has_tool(name: &str, harmless_argument: &str) -> bool {
    let runs = Command::new(name).arg(harmless_argument).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    runs || is_missing(name)
}

/// Whether C++ programs find Eigen.
pub(crate) fn has_eigen() -> bool {
    static FOUND: LazyLock<bool> = LazyLock::new(|| {
        let mut command = compiler(true);
        command.args(["-fsyntax-only", "-include", "eigen3/Eigen/Dense", "-xc++", "/dev/null"]);
        run(&mut command).status.success() || is_missing("Eigen 3")
    });
    *FOUND
}

/// False, after saying so; where all tools are demanded, a failure.
pub(crate) fn is_missing(name: &str) -> bool {
    assert!(env::var("DP_REQUIRE_TOOLS").as_deref() != Ok("1"), "{name} is not installed");
    // Not println: that is captured when a test passes.
    let _ = writeln!(std::io::stderr(), "skipped: {name} is not installed");
    false
}
