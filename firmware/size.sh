#!/bin/sh
# Prints what each function of a firmware build takes with everything it calls: text and constants, and worst-case
# stack.
#
#   firmware/size.sh TARGET DIR    DIR holds what firmware/build.sh built
set -eu

target=$1
archive=$2/libdeltarobot.a
here=$(dirname "$0")
# shellcheck disable=SC2046 # a list of words
set -- $("$here/build.sh" "$target")
prefix=
for prefix; do :; done
prefix=${prefix%gcc}

case $target in
    riscv32*) emulation="-m elf32lriscv" call=0 ;;
    avr-none)
        multi=$("${prefix}gcc" "-mmcu=${MCU:-atmega2560}" -print-multi-directory)
        multi=${multi%%/*} emulation="-m $multi" call=2
        # The program counter of controllers with more than 128 KB of flash has three bytes.
        if [ "$multi" = avr6 ]; then call=3; fi ;;
    *) emulation='' call=0 ;;
esac
# The original, gcc -Os: all three functions.
original=
case $target in
    thumbv7em*) original=517 ;;
    avr-none) original=947 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/ld" <<END
SECTIONS {
    .text 0x1000 : { *(.text .text.*) }
    .rodata : { *(.rodata .rodata.*) }
    .data : { *(.data .data.* .bss .bss.*) }
}
END

# measure NAME FUNCTION...
measure() {
    name=$1; shift
    # shellcheck disable=SC2046,SC2086 # lists of options
    "${prefix}ld" $emulation --gc-sections -e "$1" $(printf -- '-u %s ' "$@") -T "$work/ld" -o "$work/elf" "$archive"
    bytes=$("${prefix}size" -A "$work/elf" | awk '$1 ~ /^\.(text|rodata|data|bss)/ { sum += $2 } END { print sum + 0 }')
    stack=0
    "${prefix}objdump" -d "$work/elf" >"$work/listing"
    for fn; do
        # A disassembler shows one of the names that an address has.
        address=$("${prefix}nm" "$work/elf" | awk -v fn="$fn" '$3 == fn { print $1 }')
        shown=$(sed -n "s/^$address <\(.*\)>:\$/\1/p" "$work/listing")
        one=$(awk -v fn="$shown" -v call=$call -f "$here/stack.awk" "$work/listing")
        if [ "$one" -gt "$stack" ]; then stack=$one; fi
    done
    printf '%-28s %-24s %6s %8s %9s\n' "$target" "$name" "$bytes" "$stack" "${original:--}"
}

printf '%-28s %-24s %6s %8s %9s\n' target function bytes stack original
whole=$original
original=
for fn in dp_process dp_recv dp_send; do measure "$fn" "$fn"; done
original=$whole
measure "these three" dp_process dp_recv dp_send
original=
# Without their second names, which end in the sizes.
all=$("${prefix}nm" --extern-only --defined-only "$archive" | sed -n 's/.* T //p' | grep -v '_[0-9]*$' | sort -u)
for fn in $all; do
    case $fn in dp_process | dp_recv | dp_send) ;; *) measure "$fn" "$fn" ;; esac
done
# shellcheck disable=SC2046 # a list of names
measure "a GX motion side" $(echo "$all" | grep ^gx_motion_)
# shellcheck disable=SC2086 # a list of names
measure "all" $all

# ram HEADER STRUCT: what an object takes, as bytes
ram() {
    case $target in
        avr-none) options=-mmcu=${MCU:-atmega2560} ;;
        riscv32*) options="-march=rv32imc -mabi=ilp32" ;;
        *) options= ;;
    esac
    # shellcheck disable=SC2086 # a list of options
    printf '#include "libdeltarobot/%s"\nstruct %s object;\n' "$1" "$2" |
        "${prefix}gcc" $options -ffreestanding -fno-common -I "${archive%/*}/include" -x c -c -o "$work/object" -
    # shellcheck disable=SC2046 # one word
    set -- "$2" $("${prefix}nm" -S "$work/object" | awk '$4 == "object" { print $2 }')
    printf '%-28s %-24s %6d %8s %9s\n' "$target" "RAM: $1" "0x$2" - -
}
ram gx_motion.h gx_motion
