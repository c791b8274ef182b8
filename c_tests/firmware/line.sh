#!/bin/sh
# A device of the line protocol on an AVR (line_sketch.c): line.sh size|test LIBRARY-DIRECTORY WORK-DIRECTORY
#
# size prints what the controller's flash and RAM hold with it; test runs it in simavr and looks at what it says.
# Environment: MCU (default atmega2560).
set -eu

what=$1
lib=$2
out=$3/line
tests=$(cd "$(dirname "$0")" && pwd)
example=$tests/../../examples/firmware
mcu=${MCU:-atmega2560}
mkdir -p "$out"

fail() {
    echo "line.sh: $*" >&2
    exit 1
}

# build NAME OPTION...: an ELF file, whose name is printed
build() {
    name=$1
    shift
    avr-gcc "-mmcu=$mcu" -std=gnu99 -Os -Wall -Wextra -Werror -ffunction-sections -fdata-sections -DUART_INTERRUPT \
        -DFIFO_SIZE=128u "$@" -I "$lib/include" -Wl,--gc-sections -o "$out/$name.elf" "$example/avr/board.c" \
        "$tests/line_sketch.c" -L "$lib" -ldeltarobot
    echo "$out/$name.elf"
}

# The constant of the library's headers that has this name.
size_of() { sed -n "s/^#define $1 //p" "$lib/include/libdeltarobot/sizes.h"; }

if [ "$what" = size ]; then
    avr-gcc "-mmcu=$mcu" -E -dM -x c /dev/null -include avr/io.h >"$out/io"
    io() { awk -v name="$1" '$2 == name { print $3 }' "$out/io" | tr -d '()'; }
    flash=$(io FLASHEND) start=$(io RAMSTART) end=$(io RAMEND)
    call=2
    [ $((flash)) -lt 131072 ] || call=3
    printf '%-44s %8s %8s %8s\n' \
        "$mcu, OLP_WINDOW_MAX=$(size_of OLP_WINDOW_MAX), OLP_REPLY_MAX=$(size_of OLP_REPLY_MAX)" flash RAM stack
    # worst ELF FUNCTION: its stack, in bytes
    worst() { avr-objdump -d "$1" | awk -v fn="$2" -v call=$call -f "$tests/../../firmware/stack.awk"; }
    row() {
        avr-size -A "$2" | awk -v name="$1" -v stack="$3" '
            { bytes[$1] = $2 }
            END {
                flash = bytes[".text"] + bytes[".data"]; ram = bytes[".data"] + bytes[".bss"]
                printf "%-44s %8d %8d %8s\n", name, flash, ram, stack
            }'
    }
    for row in "the board alone:-DBOARD_ONLY" "a device with acks and checksums:-DDEVICE" \
        "the same, with floats:-DWITH_FLOATS"; do
        elf=$(build size "${row#*:}")
        stack=$(worst "$elf" main)
        if [ "${row#*:}" != -DBOARD_ONLY ]; then
            # The library calls the sketch's functions by pointers: they come on top.
            deepest=0
            for fn in setswitch send_line; do
                more=$(worst "$elf" $fn)
                [ "$more" -le "$deepest" ] || deepest=$more
            done
            stack=$((stack + call + deepest))
        fi
        row "${row%%:*}" "$elf" "$stack"
    done
    printf '%-44s %8d %8d\n' "the controller has" $((flash + 1)) $((end - start + 1))
    exit 0
fi

${CC:-cc} -std=gnu99 -O2 -Wall -Wextra -Wpedantic -Werror -o "$out/simavr_run" "$tests/simavr_run.c" -lsimavr -lelf
elf=$(build test)
# A command, and time to answer it: the simulated time goes on while the input waits. Its end ends the simulation.
{
    sleep 0.3
    for command in "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6" "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6" \
        "c=setswitch&state=0&t=11&id=9o5qzg&s=a3d6" "c=setswitch&state=0&t=20&id=9o5qzg" \
        "c=linksetup&ack=off&checksum=none&t=30&id=9o5qzg" "c=linksetup&ack=off&checksum=none&t=30&id=9o5qzg" \
        "c=setswitch&state=0&t=40&id=9o5qzg" "c=setfan&t=50&id=9o5qzg" "c=setswitch&t=60&id=9o5qzg"; do
        printf '%s\n' "$command"
        sleep 0.3
    done
} | timeout 60 "$out/simavr_run" "$mcu" "$elf" >"$out/said" 2>"$out/log" || {
    cat "$out/log" >&2; fail "it did not run"
}
grep -v '^c=heaterinfo' "$out/said" | sed 's/&t=[0-9]*$//' >"$out/answers"
cat >"$out/expected" <<'LINES'
c=welcome&id=M1F910&type=OzekiTemperatureController&pos=1
c=welcome&id=9o5qzg&type=OzekiSwitchController&pos=2
c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=0&id=M1F910
c=ack&checksum=a3d6&t=11&id=9o5qzg
c=setswitch_resp&state=1&pwm=254&id=9o5qzg
c=ack&checksum=a3d6&t=11&id=9o5qzg
c=setswitch_resp&state=1&pwm=254&id=9o5qzg
c=onerror&code=checksum&t=N&id=M1F910
c=onerror&code=checksum&t=N&id=M1F910
c=onerror&code=checksum&t=N&id=M1F910
c=linksetup_resp&ack=off&checksum=none&id=9o5qzg
c=setswitch_resp&state=0&pwm=254&id=9o5qzg
c=onerror&code=unknowncommand&t=50&id=9o5qzg
c=onerror&code=refused&t=60&id=9o5qzg
LINES
# The t of these depends on how many events there were.
sed 's/code=checksum&t=[0-9]*&/code=checksum\&t=N\&/' "$out/answers" | diff "$out/expected" - >&2 ||
    fail "it says something else"
# Nothing lost: the numbers of the messages that have one of their own go up one by one.
heaters=$(grep -c '^c=heaterinfo&temp=2[01]\.00&state=[01]&id=M1F910&t=[0-9]*$' "$out/said")
[ "$heaters" -ge 8 ] || fail "only $heaters events"
echo "    line_sketch, $mcu: $(wc -l <"$out/expected") answers and $heaters events as expected"
