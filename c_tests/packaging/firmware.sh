#!/usr/bin/env bash
# Uses the firmware package as Arduino, PlatformIO, ESP-IDF, Zephyr and CMake do, as far as their tools can be had:
# firmware.sh DIRECTORY, from the repository's root, after `make firmware-package`. Debian's packages: arduino-builder,
# arduino-core-avr, gcc-arm-none-eabi, gcc-riscv64-unknown-elf, gcc-avr, cmake, libsimavr-dev, libelf-dev, python3-venv.
set -euo pipefail
root=$PWD work=$1
rm -rf "$work"
mkdir -p "$work/libraries"
work=$(cd "$work" && pwd)

fail() {
    echo "firmware.sh: $*" >&2
    exit 1
}
# quietly COMMAND...: its output is shown when it fails.
quietly() {
    "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2 && fail "$*"; }
}

python3 -m zipfile -e target/firmware/libdeltarobot-firmware-*.zip "$work/libraries"
package=$work/libraries/libdeltarobot

# Arduino: its builder and its AVR core, as Debian has them. The builder is older than precompiled libraries: what
# library.properties makes of today's, the two flags, is said to it. Nor has Debian's avr-gcc this macro.
# The Mega's sketch runs in simavr and answers.
flags=$(sed -n 's/^ldflags=//p' "$package/library.properties")
for board in mega:cpu=atmega2560=atmega2560 uno=atmega328p leonardo=atmega32u4; do
    build=$work/arduino-${board%%[:=]*} mcu=${board##*=}
    mkdir -p "$build"
    quietly arduino-builder -compile -hardware /usr/share/arduino-builder -hardware /usr/share/arduino/hardware \
        -tools /usr/bin -prefs=runtime.tools.avr-gcc.path=/usr \
        -prefs=compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__ \
        "-prefs=compiler.libraries.ldflags=-L$package/src/$mcu $flags" \
        -libraries "$work/libraries" -fqbn "arduino:avr:${board%=*}" -build-path "$build" \
        "$package/examples/Controller/Controller.ino"
done
cc -std=gnu99 -O2 -o "$work/simavr_run" c_tests/firmware/simavr_run.c -lsimavr -lelf
# Requests are lost until the sketch has opened its port, and while it answers, as answers are longer.
for _ in $(seq 2000); do printf '\044S\0\261:'; done |
    timeout 300 "$work/simavr_run" atmega2560 "$work/arduino-mega/Controller.ino.elf" >"$work/answers" 2>"$work/log"
grep -qaF "\$s$(printf '\020')" "$work/answers" || fail "the sketch does not answer"
echo "arduino: Mega, Uno and Leonardo"

# CMake: the archive follows from the flags, and what it is linked with has no other float ABI.
# build NAME HOW PREFIX FLAGS [CMAKE-OPTION]...
count=0
build() {
    quietly cmake -S c_tests/packaging/firmware -B "$work/$1" "-DPACKAGE=$package" "-DHOW=$2" "-DPREFIX=$3" \
        "-DFLAGS=$4" "${@:5}"
    quietly cmake --build "$work/$1"
    count=$((count + 1))
}
arm='arm-none-eabi-'
build m0 plain $arm "-mcpu=cortex-m0plus -mthumb"
build m3 plain $arm "-mcpu=cortex-m3 -mthumb"
build m4 plain $arm "-mcpu=cortex-m4 -mthumb -mfloat-abi=softfp -mfpu=fpv4-sp-d16"
build m7 plain $arm "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16"
build m33 plain $arm "-mcpu=cortex-m33 -mthumb -mfloat-abi=soft"
build m33-hard plain $arm "-mcpu=cortex-m33 -mthumb -mfloat-abi=hard -mfpu=fpv5-sp-d16"
build riscv plain riscv64-unknown-elf- "-march=rv32imac -mabi=ilp32 -nostdlib"
build avr plain avr- "-mmcu=atmega328p"
! cmake -S c_tests/packaging/firmware -B "$work/none" "-DPACKAGE=$package" -DHOW=plain -DPREFIX=avr- \
    -DFLAGS=-mmcu=atmega8 >"$work/log" 2>&1 || fail "there is an archive for an ATmega8"
grep -q "no archive for" "$work/log" || fail "what is missing is not said"
echo "cmake: $count processors"

build esp32c3 idf riscv64-unknown-elf- "-march=rv32imc -mabi=ilp32" -DIDF_TARGET=esp32c3
build esp32c6 idf riscv64-unknown-elf- "-march=rv32imac -mabi=ilp32" -DIDF_TARGET=esp32c6
build zephyr-m4 zephyr $arm "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16" -DCONFIG_CPU_CORTEX_M4=y \
    -DCONFIG_FP_HARDABI=y
build zephyr-m0 zephyr $arm "-mcpu=cortex-m0 -mthumb" -DCONFIG_CPU_CORTEX_M0=y
echo "esp-idf, zephyr: 4 processors, with stand-ins for their functions"

# The source tree's own CMakeLists.txt finds out what to build in the same way.
(
    export RUSTC=${FIRMWARE_RUSTC:-/usr/bin/rustc} RUSTC_BOOTSTRAP=1 CARGO_UNSTABLE_BUILD_STD=core
    export CARGO_DIR=$root/target/firmware/.cargo CARGO_PROFILE_RELEASE_OPT_LEVEL=s
    package=$root build source source $arm "-mcpu=cortex-m0 -mthumb"
)
echo "cmake: the source tree"

# PlatformIO packs it; and its script is run by the SCons that PlatformIO runs it in, for a Mega.
python3 -m venv "$work/venv"
"$work/venv/bin/pip" --disable-pip-version-check install --quiet platformio scons
(cd "$work" && PLATFORMIO_CORE_DIR=$work/pio quietly "$work/venv/bin/pio" pkg pack "$package" -o "$work/pio.tar.gz")
tar tzf "$work/pio.tar.gz" >"$work/packed"
grep -qx 'src/cortex-m4/fpv4-sp-d16-hard/libdeltarobot.a' "$work/packed" || fail "pio packs no archive"
cp c_tests/packaging/firmware/main.c "$work"
cat >"$work/SConstruct" <<EOF
env = Environment(tools=["gcc", "gnulink"], CC="avr-gcc", LINK="avr-gcc", CCFLAGS=["-mmcu=atmega2560"],
    LINKFLAGS=["-mmcu=atmega2560", "-nostdlib", "-Wl,-e,main"], CPPPATH=["$package/src"])
env.BoardConfig = lambda: {"build.mcu": "atmega2560"}
SConscript("$package/platformio.py", exports="env", must_exist=True)
env.Program("firmware.elf", "main.c")
EOF
(cd "$work" && quietly "$work/venv/bin/scons")
echo "platformio: packed; its script in SCons"
