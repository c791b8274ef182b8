#!/bin/sh
# Links the firmware library of a target in the ways a firmware may: link.sh TARGET LIBRARY-DIRECTORY WORK-DIRECTORY
set -eu

target=$1
lib=$2
work=$3/link-$1
here=$(dirname "$0")

# shellcheck disable=SC2046 # a list of words
set -- $("$here/../../firmware/build.sh" "$target")
prefix=
for prefix; do :; done
prefix=${prefix%gcc}
newlib=
nosys="--specs=nano.specs --specs=nosys.specs"
nostdlib=-nostdlib
case $target in
    thumbv6m*) arch="-mthumb -mcpu=cortex-m0" newlib=$nosys ;;
    thumbv7m*) arch="-mthumb -mcpu=cortex-m3" newlib=$nosys ;;
    thumbv7em*eabi) arch="-mthumb -mcpu=cortex-m4 -mfloat-abi=soft" newlib=$nosys ;;
    thumbv7em*hf) arch="-mthumb -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16" newlib=$nosys ;;
    riscv32*) arch="-march=rv32imc -mabi=ilp32" ;;
    avr-none) arch="-mmcu=${MCU:-atmega2560}" newlib=" " ;;
esac
mkdir -p "$work"
count=0

fail() {
    echo "$target: $*" >&2
    exit 1
}

# link WHAT OBJECT-OPTIONS LINK-OPTIONS...: the warnings of newlib's empty system calls are not ours.
link() {
    what=$1 options=$2
    shift 2
    # shellcheck disable=SC2086 # lists of options
    "${prefix}gcc" $arch -Os -Wall -Wextra -Werror -fno-builtin -ffunction-sections -I "$lib/include" $options \
        -c -o "$work/main.o" "$here/link.c" || fail "$what: does not compile"
    # shellcheck disable=SC2086
    "${prefix}gcc" $arch -Wl,--gc-sections -Wl,--fatal-warnings -L "$lib" -o "$work/elf" "$@" 2>"$work/log" ||
        { cat "$work/log" >&2; fail "$what: does not link"; }
    count=$((count + 1))
}
has() { "${prefix}nm" "$work/elf" | awk -v name="$1" '$3 == name { found = 1 } END { exit !found }'; }

sizes="-DDP_BUFSIZE=${DP_BUFSIZE:-128} -DDP_DATA_MAX_SIZE=${DP_DATA_MAX_SIZE:-32}"
main="$work/main.o"
start="-Wl,-e,main"

link "nothing else" "-DEVERYTHING" $nostdlib $start "$main" -ldeltarobot
link "before the object" "-DEVERYTHING" $nostdlib $start -Wl,--whole-archive -ldeltarobot -Wl,--no-whole-archive "$main"
link "programs of the original's header" "-DOLD_HEADER $sizes" $nostdlib $start "$main" -ldeltarobot
link "before libgcc" "" $nostdlib $start "$main" -ldeltarobot -lgcc
link "behind libgcc" "" $nostdlib $start "$main" -lgcc -ldeltarobot
link "functions of the firmware's" "-DOWN_FUNCTIONS -DEVERYTHING" $nostdlib $start -Wl,--whole-archive -ldeltarobot \
    -Wl,--no-whole-archive "$main" -lgcc
if [ -n "$newlib" ]; then
    # nosys.specs makes the linker warn of system calls that do nothing.
    # shellcheck disable=SC2086
    link "the C library" "-DEVERYTHING" -Wl,--no-fatal-warnings $newlib "$main" -ldeltarobot
    # shellcheck disable=SC2086
    link "the C library first" "" -Wl,--no-fatal-warnings $newlib "$main" -lc -ldeltarobot
fi

link "a part" "-DONLY_SEND" $nostdlib $start "$main" -ldeltarobot
has main || fail "no main in it?"
! has dp_recv || fail "a program that only sends carries dp_recv"

link "sections" "-DEVERYTHING" $nostdlib $start "$main" -ldeltarobot
for fn in dp_process dp_recv dp_send; do
    [ "$("${prefix}nm" "$work/elf" | awk -v a=$fn -v b="${fn}_${DP_BUFSIZE:-128}_${DP_DATA_MAX_SIZE:-32}" \
        '$3 == a || $3 == b { print $1 }' | sort -u | wc -l)" = 1 ] || fail "$fn and its sized name are two functions"
done
echo "    $target: $count ways"
