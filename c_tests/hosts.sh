#!/usr/bin/env bash
# Hosts other than this one: builds the library for each that is named, and runs the C tests linked statically to it in
# an emulator; or, for those without one, compiles it. The same for the program `deltarobot`, but not for aarch64 and
# s390x. By default all. windows-serve is `deltarobot ui` and what it serves, TARGET-serve (with clang) the programs
# `deltarobot-serve` and `deltarobot-convert`: each takes minutes to compile.
#
#   c_tests/hosts.sh [i686|aarch64|s390x|windows|windows-serve|TARGET|TARGET-serve]...
#
# Debian's packages: qemu-user, wine64, gcc and g++ of each (gcc-s390x-linux-gnu, gcc-mingw-w64-x86-64-win32...), and
# for a compiler that has no core library for them, but its source, rustc-web and rust-web-src.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    echo "hosts.sh: $*" >&2
    exit 1
}

# use_compiler TARGET: the first one in the PATH that has the target's core library, else one that has its source.
use_compiler() {
    local candidate
    unset RUSTC RUSTC_BOOTSTRAP CARGO_UNSTABLE_BUILD_STD
    for candidate in $(type -ap rustc); do
        if compgen -G "$("$candidate" --print target-libdir --target "$1" 2>/dev/null)/libcore-*.rlib" >/dev/null; then
            export RUSTC="$candidate"
            return
        fi
    done
    for candidate in $(type -ap rustc); do
        if [ -f "$("$candidate" --print sysroot)/lib/rustlib/src/rust/library/core/src/lib.rs" ]; then
            export RUSTC="$candidate" RUSTC_BOOTSTRAP=1 CARGO_UNSTABLE_BUILD_STD=core
            return
        fi
    done
    fail "no compiler for $1: rustup target add $1, or on Debian apt install rustc-web rust-web-src"
}

# build HOST TARGET PREFIX
build() {
    command -v "$3gcc" >/dev/null || fail "$1: no $3gcc"
    (use_compiler "$2" && make lib OUT="target/hosts/$1" CARGO_DIR=target/hosts/.cargo DP_TARGET="$2" CROSS_COMPILE="$3")
}

# program TARGET build|check [PACKAGE NAME OPTION...]: the program, or another; where the core library has to be
# compiled, all of std has to.
program() {
    use_compiler "$1"
    [ -z "${CARGO_UNSTABLE_BUILD_STD:-}" ] || export CARGO_UNSTABLE_BUILD_STD=std,panic_abort
    cargo "$2" --quiet -p "${3:-deltarobot-cli}" --bin "${4:-deltarobot}" "${@:5}" \
        --target "$1" --target-dir target/hosts/.cargo
}

# run HOST PREFIX RUNNER: what needs the programs of this machine besides is left out.
run() {
    DP_CROSS_LIBRARY="$PWD/target/hosts/$1" DP_CROSS_PREFIX="$2" DP_CROSS_RUNNER="$3" \
        cargo test --quiet --test c_tests -- linked_statically --skip send_opcode --skip demonstration --skip robot \
        --skip sizes_256_32 --skip sizes_512_255 "${@:4}"
}

wine_start() {
    out=$PWD/target/hosts
    programs=$out/.cargo/x86_64-pc-windows-gnu/debug
    wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
    server=$(command -v wineserver || echo /usr/lib/wine/wineserver)
    export WINEPREFIX="$out/wine" WINEDEBUG=-all
    mkdir -p "$WINEPREFIX"
    trap '"$server" -k || true' EXIT
    # What is first called starts services that keep its output open.
    "$wine" reg query HKLM >/dev/null 2>&1
    # Wine does not have what std takes random numbers from.
    x86_64-w64-mingw32-gcc -shared -Wall -Wextra -Werror -o "$programs/bcryptprimitives.dll" \
        c_tests/cli/bcryptprimitives.c -ladvapi32
}

wine_run() {
    run windows x86_64-w64-mingw32- "$wine" --skip serial::serial >"$out/windows.log" 2>&1 || { cat "$out/windows.log" && return 1; }
    grep '^test result' "$out/windows.log"

    # A serial port: a link to a pseudo-terminal, which the server looks for when it starts.
    cc -Wall -Wextra -o "$out/far_end" c_tests/serial/far_end.c
    x86_64-w64-mingw32-gcc -static -std=c99 -Wall -Wextra -Wpedantic -Werror -Ic_tests/common -I"$out/windows/include" \
        -o "$out/com_port.exe" c_tests/serial/com_port.c "$out/windows/libdeltarobot.a"
    "$wine" reg add 'HKLM\Software\Wine\Ports' /v COM5 /d "$out/com5" /f >/dev/null 2>&1
    "$server" -k || true
    "$wine" reg query 'HKLM\Software\Wine\Ports' >/dev/null 2>&1
    "$out/far_end" "$out/com5" "$wine" "$out/com_port.exe" COM5

    # The .dll.
    x86_64-w64-mingw32-gcc -std=c99 -Ic_tests/common -I"$out/windows/include" -o "$out/windows/dll_user.exe" \
        c_tests/deltarobot/ext.c -L"$out/windows" -ldeltarobot.dll
    "$wine" "$out/windows/dll_user.exe"
}

# The program in wine, which finds the simulator at a port of TCP, and the one of this machine at COM5.
wine_program() {
    local program=$programs/deltarobot.exe watching
    cargo build --quiet -p deltarobot-cli --bin deltarobot
    "$wine" reg query HKLM >/dev/null 2>&1
    c_tests/cli/session.sh "$wine" "$program"
    target/debug/deltarobot sim --speed 200 --link "$out/com5" &
    sim=$!
    trap 'kill "$sim" 2>/dev/null || true; "$server" -k || true' EXIT
    until [ -e "$out/com5" ]; do kill -0 "$sim" && sleep 0.1; done
    "$server" -k || true
    "$wine" reg query 'HKLM\Software\Wine\Ports' >/dev/null 2>&1
    "$wine" "$program" ports | grep -q '^COM5' || fail "COM5 is not listed"
    "$wine" "$program" home COM5
    "$wine" "$program" move 10 7.5 12.5 '\\.\COM5'
    "$wine" "$program" status COM5 | tr -d '\r' | grep -x 'IDLE  DA=10  DB=7.5  DC=12.5'
    "$wine" "$program" move 120000 120000 120000 COM5 --no-wait
    "$wine" "$program" monitor COM5 >"$out/monitor" 2>&1 &
    watching=$!
    until grep -q 'STATUS_REPLY: MOVING' "$out/monitor"; do kill -0 "$watching" && sleep 0.1; done
    kill "$sim"
    wait "$watching" && fail "a port that has gone is watched"
    grep 'COM5: disconnected' "$out/monitor"
}

# `deltarobot ui` in wine, which gives the address to a stand-in of this machine's browser.
wine_serve() {
    local serving url
    mkdir -p "$out/browser"
    rm -f "$out/opened"
    # shellcheck disable=SC2016 # the stand-in expands it
    printf '#!/bin/sh\nprintf %%s "$1" >"%s.new" && mv "%s.new" "%s"\n' "$out/opened" "$out/opened" "$out/opened" \
        >"$out/browser/xdg-open"
    chmod +x "$out/browser/xdg-open"
    set -m
    BROWSER='' PATH="$out/browser:$PATH" "$wine" "$programs/deltarobot-ui.exe" --sim &
    serving=$!
    until [ -e "$out/opened" ]; do
        kill -0 "$serving" || fail "it ended before a browser was opened"
        sleep 0.1
    done
    url=$(cat "$out/opened")
    until curl -fsS "${url}api/robots/sim1" | grep -q '"link":"up"'; do
        kill -0 "$serving" || fail "there is no robot at $url"
        sleep 0.1
    done
    curl -fsS -X POST "${url}api/robots/sim1/home" | grep -q '"outcome":"finished"' || fail "the robot is not homed"
    curl -fsS "$url" | grep -q '<title>' || fail "there is no page at $url"
    kill -INT "$serving"
    wait "$serving" || fail "Ctrl-C: status $?"
}

[ $# -gt 0 ] || set -- i686 aarch64 s390x windows x86_64-apple-darwin aarch64-apple-darwin x86_64-unknown-freebsd \
    x86_64-unknown-netbsd x86_64-unknown-linux-musl
for host; do
    printf '== %s (%s s)\n' "$host" "$SECONDS"
    case $host in
        i686 | aarch64 | s390x)
            build "$host" "$host-unknown-linux-gnu" "$host-linux-gnu-"
            # qemu does not know Linux' own requests for serial ports; processors that run programs of 32 bits do.
            run "$host" "$host-linux-gnu-" "qemu-${host/i686/i386}" --skip serial::serial
            if [ "$host $(uname -m)" = "i686 x86_64" ]; then
                i686-linux-gnu-gcc -static -pthread -std=c99 -Ic_tests/common -Itarget/hosts/i686/include \
                    -o target/hosts/i686/serial c_tests/serial/serial.c target/hosts/i686/libdeltarobot.a
                target/hosts/i686/serial
                # Static, so that it needs no libraries of 32 bits.
                (export RUSTFLAGS='-C target-feature=+crt-static' \
                    CARGO_TARGET_I686_UNKNOWN_LINUX_GNU_LINKER=i686-linux-gnu-gcc
                program i686-unknown-linux-gnu build)
                c_tests/cli/session.sh "$PWD/target/hosts/.cargo/i686-unknown-linux-gnu/debug/deltarobot"
            fi ;;
        windows)
            build windows x86_64-pc-windows-gnu x86_64-w64-mingw32-
            (program x86_64-pc-windows-gnu build)
            (wine_start; wine_run; wine_program) ;;
        windows-serve)
            # With the page in it, as a release has it.
            (program x86_64-pc-windows-gnu build deltarobot-serve deltarobot-ui --features rust-embed/debug-embed)
            (wine_start; wine_serve) ;;
        *-serve)
            # What ring has in C needs a compiler for the target, but none of its headers; and one of Apple's, empty.
            mkdir -p target/hosts/headers
            : >target/hosts/headers/TargetConditionals.h
            (export TARGET_CC=clang TARGET_AR=ar \
                TARGET_CFLAGS="-ffreestanding -DRING_CORE_NOSTDLIBINC -I$PWD/target/hosts/headers"
            program "${host%-serve}" check deltarobot-serve deltarobot-serve
            program "${host%-serve}" check deltarobot-records deltarobot-convert) ;;
        *-*)
            (use_compiler "$host" && cargo check --quiet --release --lib --no-default-features \
                --features panic-handler,serial --target "$host" --target-dir target/hosts/.cargo)
            (program "$host" check) ;;
        *) fail "$host: not one of those at the head of this file" ;;
    esac
done
