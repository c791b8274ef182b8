#!/bin/sh
# Runs firmware in emulators: run.sh test|bench, from the repository's root, after `make lib firmware-all`.
#
# Environment: HOST_LIB, where the host's library is; DP_BUFSIZE, DP_DATA_MAX_SIZE.
set -eu

what=$1
root=$PWD
out=$root/target/firmware/test
example=$root/examples/firmware
tests=$root/c_tests/firmware
sizes="-DDP_BUFSIZE=${DP_BUFSIZE:-128} -DDP_DATA_MAX_SIZE=${DP_DATA_MAX_SIZE:-32}"
strict="-Os -g -Wconversion -Wshadow -Wstrict-prototypes -Werror"
mcu=${MCU:-atmega2560}
mkdir -p "$out"

for tool in arm-none-eabi-gcc avr-gcc riscv64-unknown-elf-gcc qemu-system-arm timeout; do
    command -v $tool >/dev/null || { echo "$what: $tool is missing (Debian: apt install gcc-arm-none-eabi gcc-avr" \
        "avr-libc gcc-riscv64-unknown-elf qemu-system-arm libsimavr-dev libelf-dev)" >&2; exit 1; }
done

${CC:-cc} -std=gnu99 -O2 -Wall -Wextra -Wpedantic -Werror -I "$HOST_LIB/include" -o "$out/host" "$tests/host.c" \
    "$HOST_LIB/libdeltarobot.a"
${CC:-cc} -std=gnu99 -O2 -Wall -Wextra -Wpedantic -Werror -o "$out/simavr_run" "$tests/simavr_run.c" -lsimavr -lelf

# quietly COMMAND...: its output is shown when it fails.
quietly() {
    "$@" >"$out/log" 2>&1 || { cat "$out/log" >&2; echo "failed: $*" >&2; exit 1; }
}

# qemu CPU FILE [OPTION...]
qemu() {
    cpu=$1 file=$2
    shift 2
    echo qemu-system-arm -M lm3s6965evb -cpu "$cpu" -display none -monitor none -serial stdio "$@" -kernel "$file"
}

# build TARGET VARIANT PROGRAM CFLAGS MAKE-VARIABLE...: an ELF file, whose name is printed
build() {
    target=$1 variant=$2 program=$3 cflags=$4
    shift 4
    case $program in
        controller) sources= ;;
        *) sources="MAIN=$tests/$program.c" ;;
    esac
    # shellcheck disable=SC2086 # a word or none
    quietly make -s -B -C "$example" "VARIANT=$variant" "OUT=$out/$target-$program" "CFLAGS=$strict $cflags" \
        "DELTAROBOT=$root/target/firmware/$target" "$@" $sources
    echo "$out/$target-$program/controller-"*"-$variant.elf"
}

# on NAME ROLE ROUNDS COMMAND...
on() {
    name=$1 role=$2 rounds=$3
    shift 3
    echo "  $name"
    # shellcheck disable=SC2068 # a command line
    "$out/host" "$role" "$rounds" -- $@ 2>"$out/log" || { cat "$out/log" >&2; exit 1; }
}

# QEMU's UART knows no baud rate: the FIFO of the interrupt variant has to hold whatever the host sends at once.
unpaced=-DFIFO_SIZE=4096u

if [ "$what" = test ]; then
    echo "linking"
    for target in thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabi thumbv7em-none-eabihf \
        riscv32imc-unknown-none-elf avr-none; do
        "$tests/link.sh" $target "$root/target/firmware/$target" "$out"
    done
    echo "QEMU, lm3s6965evb"
    for program in controller echo; do
        elf=$(build thumbv7em-none-eabi polled $program "" CPU=cortex-m4)
        on "$program, polled, cortex-m4" $program 10000 "$(qemu cortex-m4 "$elf")"
        elf=$(build thumbv7em-none-eabihf interrupt $program $unpaced CPU=cortex-m4 FLOAT=hard)
        on "$program, interrupt, cortex-m4, hard float" $program 10000 "$(qemu cortex-m4 "$elf")"
        elf=$(build thumbv7m-none-eabi polled $program "" CPU=cortex-m3)
        on "$program, polled, cortex-m3" $program 1000 "$(qemu cortex-m3 "$elf")"
        elf=$(build thumbv7m-none-eabi interrupt $program $unpaced CPU=cortex-m3)
        on "$program, interrupt, cortex-m3" $program 1000 "$(qemu cortex-m3 "$elf")"
        elf=$(build thumbv6m-none-eabi polled $program "" CPU=cortex-m0)
        on "$program, polled, cortex-m0" $program 1000 "$(qemu cortex-m0 "$elf")"
    done
    echo "simavr, $mcu at 16 MHz and 115200 baud"
    programs="controller echo"
    if [ "${DP_DATA_MAX_SIZE:-32}" -gt 64 ]; then
        # The search through noise takes it longer than a FIFO lasts at this speed (make firmware-bench: longest
        # dp_recv).
        programs=controller
        echo "  echo left out: too slow for noise with payloads of more than 64 bytes"
    fi
    for program in $programs; do
        for variant in polled interrupt; do
            elf=$(build avr-none "$variant" "$program" "" BOARD=avr "MCU=$mcu")
            on "$program, $variant" "$program" 10000 "$out/simavr_run $mcu $elf"
        done
    done
    "$tests/line.sh" test "$root/target/firmware/avr-none" "$out"
    # The C tests of the other protocols, as they are, on what firmware gets. Not line/messages.c: it
    # takes strtof for its measure, and newlib's rounds twice.
    lib=$root/target/firmware/thumbv7em-none-eabi
    for program in gx/contouring gx/messages gx/streams gx/contour gx/motion gx/host gx/hostile \
        line/conversation line/encoder line/device line/device_calls line/host line/host_link; do
        quietly arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -std=gnu11 -O1 -ffunction-sections -I "$root/c_tests/common" \
            -I "$lib/include" --specs=rdimon.specs -nostartfiles -T "$tests/semihost.ld" -Wl,--gc-sections \
            -o "$out/c_test.elf" "$tests/semihost.c" "$root/c_tests/$program.c" "$lib/libdeltarobot.a"
        quietly timeout 100 qemu-system-arm -M mps2-an386 -display none -monitor none -serial null \
            -semihosting-config enable=on,target=native -kernel "$out/c_test.elf"
        echo "  thumbv7em-none-eabi, $(tail -n 1 "$out/log")"
    done
    echo "firmware-test: passed"
else
    # measure TARGET LIBDIR SIZES: compiles the benchmark with the model, for the processor in $cpu or $mcu; prints what
    # it prints
    measure() {
        lib=$2
        case $1 in
            avr-none) prefix=avr- flags="-mmcu=$mcu" board="$example/avr/board.c" ;;
            *)
                prefix=arm-none-eabi- flags="-mcpu=$cpu -mthumb"
                board="$example/tm4c/startup.c $example/tm4c/board.c -nostartfiles --specs=nano.specs \
                    -T $example/tm4c/link.ld" ;;
        esac
        flags="$flags $3"
        mkdir -p "$out/bench"
        # shellcheck disable=SC2086 # lists of options
        {
            quietly "${prefix}gcc" $flags -Os -c -o "$out/bench/small.o" "$root/c_tests/deltarobot/model/model.c"
            quietly "${prefix}gcc" $flags -O2 -c -o "$out/bench/fast.o" "$tests/fast_model.c"
            quietly "${prefix}gcc" $flags -std=gnu99 -Os -Wall -Wextra -Werror -ffunction-sections \
                -I "$lib/include" -Wl,--gc-sections -o "$out/bench/$1.elf" $board "$tests/bench.c" \
                "$out/bench/small.o" "$out/bench/fast.o" "$lib/libdeltarobot.a"
        }
        # shellcheck disable=SC2046 # a command line
        case $1 in
            avr-none) lines "$out/simavr_run" "$mcu" "$out/bench/$1.elf" mute ;;
            *) lines $(qemu "$cpu" "$out/bench/$1.elf" -icount shift=0 -semihosting-config enable=on,target=native) ;;
        esac
    }
    # both TARGET: for the sizes of the build, and the longest dp_recv for large ones.
    both() {
        measure "$1" "$root/target/firmware/$1" "$sizes"
        large=$out/large/$1
        quietly env DP_BUFSIZE=512 DP_DATA_MAX_SIZE=255 "$root/firmware/build.sh" "$1" "$large"
        measure "$1" "$large" "-DDP_BUFSIZE=512 -DDP_DATA_MAX_SIZE=255 -DLONGEST_ALONE=1"
    }
    lines() {
        timeout 900 "$@" 2>"$out/log" >"$out/bench/table" </dev/null || true
        grep -q '^done' "$out/bench/table" || {
            cat "$out/log" "$out/bench/table" >&2; echo "bench: it did not end" >&2; exit 1
        }
        sed '/^done/d' "$out/bench/table"
    }
    for row in "thumbv6m-none-eabi cortex-m0" "thumbv7em-none-eabi cortex-m4"; do
        cpu=${row#* }
        echo "${row% *} ($cpu)"
        both "${row% *}"
    done
    echo "avr-none ($mcu)"
    both avr-none
    lib=$root/target/firmware/avr-none
    quietly avr-gcc "-mmcu=$mcu" -std=gnu99 -Os -Wall -Wextra -Werror -ffunction-sections -I "$lib/include" \
        -Wl,--gc-sections -o "$out/bench/gx.elf" "$example/avr/board.c" "$tests/gx_bench.c" "$lib/libdeltarobot.a"
    lines "$out/simavr_run" "$mcu" "$out/bench/gx.elf" mute
    # At 16 MHz and 115,200 baud a byte comes every 1,389 cycles.
    quietly avr-gcc "-mmcu=$mcu" -std=gnu99 -Os -Wall -Wextra -Werror -ffunction-sections -I "$lib/include" \
        -Wl,--gc-sections -o "$out/bench/line.elf" "$example/avr/board.c" "$tests/line_bench.c" "$lib/libdeltarobot.a"
    echo "a device of the line protocol, avr-none ($mcu)"
    lines "$out/simavr_run" "$mcu" "$out/bench/line.elf" mute
fi
