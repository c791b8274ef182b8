#!/bin/sh
# Prints how much of the library's code the tests run through, line by line: coverage.sh WORKDIR [GOAL]. Fails when the
# core (crates/protocols) has less than GOAL per cent. Rust's unit tests of the core and of the C ABI (src) count, and the
# C programs, linked statically.
#
# Needs the tools of the LLVM that rustc was built with: rustup component add llvm-tools, or Debian's llvm-NN.
set -eu
goal=${2:-0}
mkdir -p "$1"
work=$(cd "$1" && pwd)
host=$(rustc -vV | sed -n 's/^host: //p')
version=$(rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')
PATH=$(rustc --print sysroot)/lib/rustlib/$host/bin:/usr/lib/llvm-$version/bin:$PATH
if ! command -v llvm-profdata >/dev/null; then
    echo "coverage: no tools of LLVM $version (rustup component add llvm-tools, or Debian's llvm-$version)" >&2
    exit 1
fi
rm -rf "$work/unit" "$work/c"
instrumented() {
    cargo --config "build.rustflags=['-Cinstrument-coverage']" "$@" --lib --features deltarobot/serial --target "$host" \
        --target-dir "$work"
}

# lines NAME PROGRAM...: for each line of the sources in each program, how often it ran. Unit tests and C programs are
# kept apart, as the same function differs in them; and of several programs at a time, llvm-cov would believe the first.
lines() {
    name=$1; shift
    llvm-profdata merge -sparse -o "$work/$name/profile" "$work/$name"/*.profraw
    for program; do
        llvm-cov export --format=lcov --instr-profile="$work/$name/profile" "$program" 2>/dev/null
    done | awk -F '[:,]' -v root="$PWD/" '/^SF:/ { file = index($2, root) == 1 ? substr($2, length(root) + 1) : "" }
        /^DA:/ && file != "" { print file, $2, $3 }'
}

export LLVM_PROFILE_FILE="$work/unit/%m.profraw"
instrumented test --quiet -p deltarobot -p deltarobot-protocols >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
tests=$(instrumented test -p deltarobot -p deltarobot-protocols --no-run --message-format=json 2>/dev/null | sed -n 's/.*"executable":"\([^"]*\)".*/\1/p')

LLVM_PROFILE_FILE="$work/c/%p.profraw"
instrumented rustc --quiet --crate-type staticlib
cp "$work/$host/debug/libdeltarobot.a" "$work"
# Programs of other runs count nothing, which llvm-cov doesn't like.
touch "$work/begun"
# With the features of `make test`, whose build is used again.
DP_COVERAGE="$work" cargo test --quiet --features serial --test c_tests -- linked_statically --skip traces:: \
    >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
programs=$(find "${CARGO_TARGET_DIR:-target}/tmp/c_tests" -name '*-128-32-static' -newer "$work/begun")

# shellcheck disable=SC2086 # lists of files
{ lines unit $tests; lines c $programs; } | sort -u | awk -v goal="$goal" '
    !(($1, $2) in ran) { ran[$1, $2] = 0; if (!($1 in all)) files[++n] = $1; all[$1]++ }
    $3 > 0 && !ran[$1, $2] { ran[$1, $2] = 1; hit[$1]++ }
    function row(name, lines, run) { printf "%-40s %6d lines %6.1f %%\n", name, lines, lines ? 100 * run / lines : 100 }
    END {
        for (i = 1; i <= n; i++) {
            file = files[i]
            if (file !~ /^(src|crates\/protocols\/src)\//) continue
            row(file, all[file], hit[file])
            part = file ~ /^src\// ? "C ABI and serial port" : "core"
            lines[part] += all[file]; run[part] += hit[file]
        }
        for (part in lines) row(part, lines[part], run[part])
        if (100 * run["core"] < goal * lines["core"]) { print "coverage: the core has less than " goal " %"; exit 1 }
    }'
