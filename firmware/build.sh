#!/bin/sh
# Builds libdeltarobot.a and its headers for a bare-metal target.
#
#   firmware/build.sh TARGET OUT    builds into the directory OUT
#   firmware/build.sh TARGET        only looks for the tools: names them, or fails and says how to get what is missing
#
# Environment: the sizes in src/sizes.mk; MCU (AVR only, default atmega2560); FIRMWARE_RUSTC, a compiler to use instead
# of the first suitable one in the PATH; FIRMWARE_PREFIX, the prefix of the GNU binutils, e.g. arm-none-eabi-;
# FIRMWARE_OPT, the optimisation level; FIRMWARE_CARGO_DIR, where cargo works.
set -eu

target=$1
out=${2-}
root=$(cd "$(dirname "$0")/.." && pwd)
mcu=${MCU:-atmega2560}

fail() {
    echo "$target: $*" >&2
    exit 1
}

# Binutils that can read the target's objects; those of the firmware's own compiler.
emulation=
case $target in
    thumb*-none-eabi | thumb*-none-eabihf) prefixes=arm-none-eabi- package=gcc-arm-none-eabi ;;
    riscv32*-unknown-none-elf)
        prefixes="riscv32-unknown-elf- riscv-none-elf- riscv64-unknown-elf-" package=gcc-riscv64-unknown-elf
        emulation="-m elf32lriscv" ;;
    avr-none) prefixes=avr- package="gcc-avr avr-libc" ;;
    *) fail "not one of thumb*-none-eabi(hf), riscv32*-unknown-none-elf, avr-none; firmware/firmware.mk lists those that are tested" ;;
esac
prefix=${FIRMWARE_PREFIX-}
for candidate in $prefixes; do
    if [ -z "$prefix" ] && command -v "${candidate}gcc" >/dev/null; then prefix=$candidate; fi
done
[ -n "$prefix" ] || fail "no $(echo "$prefixes" | sed 's/ *$//; s/- /-, /g')gcc: install the GNU toolchain (Debian: apt install $package)"

flags="${RUSTFLAGS-}"
helpers=
if [ "$target" = avr-none ]; then
    # avr-gcc knows which linker emulation belongs to the controller: avr5, avr6...
    emulation=$("${prefix}gcc" "-mmcu=$mcu" -print-multi-directory) || fail "MCU=$mcu: ${prefix}gcc does not know it"
    emulation="-m ${emulation%%/*}"
    flags="$flags -Ctarget-cpu=$mcu"
    # Rust's own helper functions lack some for this processor, the multiplication of 32 bits for one.
    helpers=$("${prefix}gcc" "-mmcu=$mcu" -print-libgcc-file-name)
fi

# A compiler that has the target's core library, else one that has its source.
has_core() { ls "$("$1" --print target-libdir --target "$target" 2>/dev/null)"/libcore-*.rlib >/dev/null 2>&1; }
has_source() {
    [ -f "$("$1" --print sysroot 2>/dev/null)/lib/rustlib/src/rust/library/core/src/lib.rs" ] &&
        "$1" --print target-list 2>/dev/null | grep -qx "$target"
}
compilers=${FIRMWARE_RUSTC:-$(IFS=: && for dir in $PATH; do [ ! -x "$dir/rustc" ] || echo "$dir/rustc"; done)}
rustc= from=
for candidate in $compilers; do
    if [ -z "$rustc" ] && has_core "$candidate"; then rustc=$candidate from=installed; fi
done
for candidate in $compilers; do
    if [ -z "$rustc" ] && has_source "$candidate"; then rustc=$candidate from=source; fi
done
if [ -z "$rustc" ]; then
    if [ "$target" = avr-none ]; then
        fail "no compiler with the source of core (there is no built one): rustup toolchain install nightly --component rust-src" \
            "and FIRMWARE_RUSTC=\"\$(rustup which --toolchain nightly rustc)\", or on Debian apt install rustc-web rust-web-src"
    fi
    fail "no compiler for it: rustup target add $target, or on Debian apt install rustc-web rust-web-src (core is built from source then)"
fi
if [ -z "$out" ]; then
    echo "$target: $rustc ($("$rustc" --version | cut -d ' ' -f 2), core $from), ${prefix}gcc"
    exit 0
fi

mkdir -p "$out/include/libdeltarobot"
out=$(cd "$out" && pwd)
work=${FIRMWARE_CARGO_DIR:-$root/target/firmware/.cargo}
build_std=
if [ $from = source ]; then
    # Building core is an unstable feature of cargo, which release compilers have behind this switch.
    build_std="-Zbuild-std=core"
    export RUSTC_BOOTSTRAP=1
fi
export RUSTC="$rustc" RUSTFLAGS="$flags" CARGO_PROFILE_RELEASE_OPT_LEVEL="${FIRMWARE_OPT:-s}"
export DP_HEADER_DIR="$work/$target/include"
# shellcheck disable=SC2086 # an option or nothing
(cd "$root" && ${CARGO:-cargo} rustc --quiet --lib --release --no-default-features --features panic-handler \
    --crate-type staticlib --target "$target" $build_std --target-dir "$work")

# The serial port is a part for hosts.
cp "$DP_HEADER_DIR"/*.h "$out/include"
cp "$DP_HEADER_DIR"/libdeltarobot/*.h "$out/include/libdeltarobot"
cp "$DP_HEADER_DIR/exports.txt" "$out"
rm -f "$out/include/libdeltarobot/serial.h"

# One object with only the public functions global, so that nothing in it can stand in for a function of the firmware's,
# memcpy or one of libgcc's. The bitcode is for link-time optimisation in Rust, and the unwind tables only say "can't".
# The two symbols ask for start-up code on AVR, which is the firmware's business.
exports=$(grep -v ^dp_serial_ "$out/exports.txt")
object=$out/.deltarobot.o
cp "$work/$target/release/libdeltarobot.a" "$object.a"
"${prefix}objcopy" -w -R .llvmbc -R .llvmcmd -R '.ARM.exidx*' -R '.rel.ARM.exidx*' \
    -N __do_copy_data -N __do_clear_bss "$object.a" 2>/dev/null
# shellcheck disable=SC2046,SC2086 # lists of options
"${prefix}ld" $emulation -r --gc-sections $(printf -- '-u %s ' $exports) -o "$object" "$object.a" $helpers
# shellcheck disable=SC2046 # a list of options
"${prefix}objcopy" -w --strip-debug --discard-locals -R .comment -R '.note*' \
    -N '__*_REGION_*__' $(printf -- '--keep-global-symbol=%s ' $exports) "$object"

undefined=$("${prefix}nm" -u "$object")
[ -z "$undefined" ] || fail "undefined symbols are left:" "$undefined"
! "${prefix}nm" "$object" | grep -E 'panic|rust_begin_unwind|core[0-9]*3fmt' >&2 || fail "panic or formatting code is left, see above"
! "${prefix}size" -A "$object" | awk '$1 ~ /^\.(data|bss)/ && $2 > 0' | grep . >&2 || fail "it takes RAM, see above"

rm -f "$out/libdeltarobot.a"
"${prefix}ar" rcsD "$out/libdeltarobot.a" "$object"
rm -f "$object" "$object.a"
