#!/bin/sh
# Builds libdeltarobot.a and its headers for a bare-metal target.
#
#   firmware/build.sh TARGET OUT    builds into the directory OUT
#   firmware/build.sh TARGET        only looks for the tools: names them, or fails and says how to get what is missing
#
# Environment: the sizes in src/sizes.mk; MCU (AVR only, default atmega2560); FIRMWARE_RUSTC, a compiler to use instead
# of the first suitable one in the PATH; FIRMWARE_PREFIX, the prefix of the GNU binutils, e.g. arm-none-eabi-;
# FIRMWARE_CARGO_DIR, where cargo works. How the library is made of what cargo builds, the Makefile says.
set -eu

target=$1
out=${2-}
root=$(cd "$(dirname "$0")/.." && pwd)
case $out in
    /* | '') ;;
    # Relative to the root where it can be: make takes no spaces, which the root's path may have.
    *) [ "$PWD" = "$root" ] || out=$PWD/$out ;;
esac
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
    *) fail "not one of thumb*-none-eabi(hf), riscv32*-unknown-none-elf, avr-none;" \
        "firmware/firmware.mk lists those that are tested" ;;
esac
prefix=${FIRMWARE_PREFIX-}
for candidate in $prefixes; do
    if [ -z "$prefix" ] && command -v "${candidate}gcc" >/dev/null; then prefix=$candidate; fi
done
[ -n "$prefix" ] || fail "no $(echo "$prefixes" | sed 's/ /gcc, /g')gcc: install the GNU toolchain" \
    "(Debian: apt install $package)"

flags=${RUSTFLAGS-} helpers=
if [ "$target" = avr-none ]; then
    # avr-gcc knows which linker emulation belongs to the controller: avr5, avr6...
    emulation=$("${prefix}gcc" "-mmcu=$mcu" -print-multi-directory) || fail "MCU=$mcu: ${prefix}gcc does not know it"
    emulation="-m ${emulation%%/*}"
    # What is moved out of a loop keeps one of the few pairs of registers: without that, code is smaller and faster.
    flags="$flags -Ctarget-cpu=$mcu -Cllvm-args=-disable-machine-licm"
    # Rust's own helper functions lack some for this processor, the multiplication of 32 bits for one. The two symbols
    # ask libgcc for start-up code, which is the firmware's business.
    helpers="--defsym=__do_copy_data=0 --defsym=__do_clear_bss=0 $("${prefix}gcc" "-mmcu=$mcu" -print-libgcc-file-name)"
fi

# A compiler that has the target's core library, else one that has its source.
has_core() { ls "$("$1" --print target-libdir --target "$target" 2>/dev/null)"/libcore-*.rlib >/dev/null 2>&1; }
has_source() {
    [ -f "$("$1" --print sysroot 2>/dev/null)/lib/rustlib/src/rust/library/core/src/lib.rs" ] &&
        "$1" --print target-list 2>/dev/null | grep -qx "$target"
}
compilers=${FIRMWARE_RUSTC:-$(IFS=: && for dir in $PATH; do [ ! -x "$dir/rustc" ] || echo "$dir/rustc"; done)}
rustc=''
for candidate in $compilers; do
    if [ -z "$rustc" ] && has_core "$candidate"; then rustc=$candidate from=installed; fi
done
for candidate in $compilers; do
    if [ -z "$rustc" ] && has_source "$candidate"; then rustc=$candidate from=source; fi
done
if [ -z "$rustc" ]; then
    if [ "$target" = avr-none ]; then
        fail "no compiler with the source of core (there is no built one):" \
            "rustup toolchain install nightly --component rust-src and" \
            "FIRMWARE_RUSTC=\"\$(rustup which --toolchain nightly rustc)\"," \
            "or on Debian apt install rustc-web rust-web-src"
    fi
    fail "no compiler for it: rustup target add $target, or on Debian apt install rustc-web rust-web-src" \
        "(core is built from source then)"
fi
if [ -z "$out" ]; then
    echo "$target: $rustc ($("$rustc" --version | cut -d ' ' -f 2), core $from), ${prefix}gcc"
    exit 0
fi

if [ "$from" = source ]; then
    # Building core is an unstable feature of cargo, which release compilers have behind this switch.
    export CARGO_UNSTABLE_BUILD_STD=core RUSTC_BOOTSTRAP=1
fi
export RUSTC="$rustc" RUSTFLAGS="$flags" CARGO_PROFILE_RELEASE_OPT_LEVEL="${CARGO_PROFILE_RELEASE_OPT_LEVEL:-s}"
exec "${MAKE:-make}" --no-print-directory -C "$root" check-artifact OUT="$out" DP_TARGET="$target" SHARED=no SERIAL=no \
    CARGO_DIR="${FIRMWARE_CARGO_DIR:-target/firmware/.cargo}" CROSS_COMPILE="$prefix" \
    LD="${prefix}ld $emulation" AR="${prefix}ar" NM="${prefix}nm" OBJCOPY="${prefix}objcopy" HELPERS="$helpers"
