#!/usr/bin/env bash
# Comes to the library by the package managers, and builds and runs a program with each, by default with all; from the
# repository's root:
#
#   c_tests/packaging/managers.sh DIRECTORY [conan|meson|colcon|debian|wheel|vcpkg|homebrew]...
#
# Debian's packages: cmake, pkg-config, python3-venv, dpkg-dev, debhelper, lintian, doxygen, ruby, rustc-web,
# rust-web-src, gcc-mingw-w64-x86-64-win32. The rest comes from Python's package index.
set -euo pipefail
root=$PWD work=$1
mkdir -p "$work"
work=$(cd "$work" && pwd)
shift
# What was compiled of other crates is there.
export CARGO_DIR=$root/target/release/.cargo
unset MAKEFLAGS MFLAGS
version=$(sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' Cargo.toml)
expected="$version 128 32 8"

fail() {
    echo "managers.sh: $*" >&2
    exit 1
}
# quietly COMMAND...: its output is shown when it fails.
quietly() {
    "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2 && fail "$*"; }
}
# prints COMMAND...: the last line is the consumer's.
prints() {
    local found
    found=$("$@" | tail -n 1)
    [ "$found" = "$expected" ] || fail "$* prints $found instead of $expected"
}
# packages NAME...: an environment of Python's with these.
packages() {
    [ -d "$work/venv" ] || python3 -m venv "$work/venv"
    "$work/venv/bin/pip" --disable-pip-version-check install --quiet "$@"
    export PATH="$work/venv/bin:$PATH"
}

try_conan() {
    packages conan
    sed -n 's/\(.*\) ?= \(.*\)/"\1": \2,/p' src/sizes.mk | while read -r size; do
        grep -qF "$size" packaging/conan/conanfile.py || fail "conanfile.py has another $size"
    done
    export CONAN_HOME=$work/conan-home
    rm -rf "$CONAN_HOME"
    quietly conan profile detect
    for variant in "True 128" "False 512"; do
        shared=${variant% *} size=${variant#* }
        quietly conan create packaging/conan -o "&:shared=$shared" -o "&:DP_BUFSIZE=$size" \
            -c "tools.cmake.cmake_layout:test_folder=$work/conan-test-$shared"
        grep -qx "$version $size 32 8" "$work/log" || { cat "$work/log" && fail "conan: wrong sizes"; }
    done
}

try_meson() {
    packages "meson>=1.3" ninja
    rm -rf "$work/meson"
    mkdir -p "$work/meson/subprojects"
    cp c_tests/packaging/meson/meson.build c_tests/packaging/consumer.c "$work/meson"
    ln -s "$root" "$work/meson/subprojects/libdeltarobot"
    # Other sizes take other headers.
    export DP_BUFSIZE=512
    quietly meson setup "$work/meson/build" "$work/meson"
    quietly meson compile -C "$work/meson/build"
    expected="$version 512 32 8" prints "$work/meson/build/consumer"
}

try_colcon() {
    packages colcon-common-extensions
    rm -rf "$work/colcon"
    mkdir -p "$work/colcon/src/consumer"
    cp c_tests/packaging/colcon/* c_tests/packaging/consumer.c "$work/colcon/src/consumer"
    ln -s "$root" "$work/colcon/src/libdeltarobot"
    (cd "$work/colcon" && quietly colcon build)
    prints "$work/colcon/install/consumer/lib/consumer/consumer"
    grep -q "<version>$version</version>" package.xml || fail "package.xml has another version"
}

try_debian() {
    # Without asking for the compiler: cargo need not be Debian's.
    quietly make deb OUT="$work/deb" DEB_FLAGS=-d
    quietly lintian --fail-on error "$work/deb/"*.changes
    rm -rf "$work/debian"
    for package in "$work"/deb/*.deb; do dpkg-deb -x "$package" "$work/debian"; done
    local lib
    lib=$(echo "$work"/debian/usr/lib/*-linux-*)
    cc -o "$work/debian/consumer" -I "$work/debian/usr/include" c_tests/packaging/consumer.c -L "$lib" -ldeltarobot
    LD_LIBRARY_PATH=$lib prints "$work/debian/consumer"
    "$work/debian/usr/bin/deltarobot" decode 24 53 00 B1 3A >/dev/null
    # Where Debian wants what a package has about another one.
    [ -f "$work/debian/usr/share/doc/libdeltarobot-dev/html/index.html" ] || fail "debian: no pages"
}

# A wheel for Windows, which has the library; pip there takes it, and cffi knows the structs as C does there.
try_wheel() {
    packages cffi
    rm -rf "$work/wheel"
    # By the compiler, and in the directory, of c_tests/hosts.sh.
    export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 CARGO_UNSTABLE_BUILD_STD=core CARGO_DIR=$root/target/hosts/.cargo
    quietly make wheel OUT="$work/wheel" PYTHON=python DP_TARGET=x86_64-pc-windows-gnu CROSS_COMPILE=x86_64-w64-mingw32-
    quietly pip download --no-deps --no-index --find-links "$work/wheel" --platform win_amd64 --only-binary=:all: \
        -d "$work/wheel/taken" deltarobot
    python3 -m zipfile -e "$work"/wheel/taken/*.whl "$work/wheel/content"
    local library
    library=$(find "$work/wheel/content" -name deltarobot.dll)
    [ -n "$library" ] || fail "wheel: no .dll"
    (cd "${library%/*}" && python -c '
from _abi import ffi

for header in "host", "line_protocol", "gx":
    print(f"#include <libdeltarobot/{header}.h>")
for name in "dp_host", "olp_receiver", "gx_commands", "gx_contour":
    room = dict(ffi.typeof(f"struct {name}").fields)["opaque"].type.length
    print(f"_Static_assert(sizeof(struct {name}) == {room} * sizeof(unsigned long), \"{name}\");")
') >"$work/wheel/sizes.c"
    x86_64-w64-mingw32-gcc -fsyntax-only -I include "$work/wheel/sizes.c"
}

try_vcpkg() {
    rm -rf "$work/vcpkg"
    cat >"$work/vcpkg.cmake" <<EOF
function(vcpkg_execute_required_process)
  cmake_parse_arguments(run "" "WORKING_DIRECTORY;LOGNAME" "COMMAND" \${ARGN})
  execute_process(COMMAND \${run_COMMAND} WORKING_DIRECTORY "\${run_WORKING_DIRECTORY}" RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "failed")
  endif()
endfunction()
function(vcpkg_fixup_pkgconfig)
endfunction()
function(vcpkg_install_copyright)
endfunction()
set(TARGET_TRIPLET here)
set(VCPKG_LIBRARY_LINKAGE static)
set(CURRENT_BUILDTREES_DIR "$work/vcpkg/build")
set(CURRENT_PACKAGES_DIR "$work/vcpkg/packages")
include("$root/packaging/vcpkg/libdeltarobot/portfile.cmake")
EOF
    quietly cmake -P "$work/vcpkg.cmake"
    [ ! -e "$work/vcpkg/packages/lib/libdeltarobot.so" ] || fail "vcpkg: a static port has a shared library"
    cc -o "$work/vcpkg/consumer" -I "$work/vcpkg/packages/include" c_tests/packaging/consumer.c \
        "$work/vcpkg/packages/lib/libdeltarobot.a"
    prints "$work/vcpkg/consumer"
    grep -q "\"$version\"" packaging/vcpkg/libdeltarobot/vcpkg.json || fail "vcpkg.json has another version"
}

try_homebrew() {
    quietly ruby -c packaging/homebrew/libdeltarobot.rb
}

[ $# -gt 0 ] || set -- conan meson colcon debian wheel vcpkg homebrew
for manager; do
    (try_"$manager")
    echo "managers.sh: $manager ($SECONDS s)"
done
