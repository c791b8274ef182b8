#!/usr/bin/env bash
# The program of another host, as it is used there, with a simulator at a port of TCP.
#
#   c_tests/cli/session.sh COMMAND...      such as `wine64 deltarobot.exe` or `qemu-i386 deltarobot`
set -euo pipefail
# Whatever runs in the background gets SIGINT as the shell's child in the foreground does.
set -m

deltarobot=("$@")
work=$(mktemp -d)
children=()
end() {
    kill -9 "${children[@]}" || true
    wait
    rm -rf "$work"
}
trap 'end 2>/dev/null' EXIT
cd "$work"

fail() {
    echo "session.sh: $*" >&2
    tail -n 20 "$work"/* >&2
    exit 1
}

# Text as Unix has it.
run() { "${deltarobot[@]}" "$@" 2>errors | tr -d '\r'; }

# start NAME ARGUMENTS...: runs in the background, and prints to a file of that name.
start() {
    "${deltarobot[@]}" "${@:2}" >"$1" 2>"$1.errors" &
    children+=($!)
}

# says FILE PATTERN
says() {
    for ((i = 0; i < 1200; i++)); do
        grep -qs "$2" "$1" && return
        sleep 0.05
    done
    fail "$1 does not say $2"
}

# gives EXPECTED ARGUMENTS...: the last line of what is printed.
gives() {
    local last
    last=$(run "${@:2}" | tail -n 1) || true
    [ "$last" = "$1" ] || fail "${*:2}: \`$last\` instead of \`$1\`: $(cat errors)"
}

# ends STATUS ARGUMENTS...
ends() {
    local status=0
    run "${@:2}" >output || status=$?
    [ "$status" = "$1" ] || fail "${*:2}: status $status instead of $1: $(cat output errors)"
}

run --version | grep -qx "deltarobot [0-9.]*" || fail "--version"
gives 'STATUS?' decode '24 53 00 B1 3A'
ends 2 jump
ends 3 status nowhere
grep -q '^deltarobot: nowhere: ' errors || fail "a device that is not there: $(cat errors)"

start sim sim --speed 200 --listen 127.0.0.1:0
says sim '^tcp://'
port=$(tr -d '\r' <sim)

ends 0 home "$port"
gives 'IDLE  DA=0  DB=0  DC=0 STP_A STP_B STP_C' status "$port"
ends 0 move 10 7.5 12.5 "$port"
gives 'IDLE  DA=10  DB=7.5  DC=12.5' status "$port"
gives 'move: accepted' move 120000 120000 120000 "$port" --no-wait
run status "$port" | grep -q '^MOVING' || fail 'does not move'
ends 0 cancel "$port"
run status "$port" | grep -q '^IDLE' || fail 'was not cancelled'

# Ctrl-C ends a motion.
start moving move 120000 120000 120000 "$port"
says moving '^MOVING'
kill -INT "${children[-1]}"
status=0
wait "${children[-1]}" || status=$?
[ "$status" = 5 ] || fail "Ctrl-C: status $status"
run status "$port" | grep -q '^IDLE' || fail 'Ctrl-C did not cancel'

# A tap, whose recording is shown and sent again.
start tap record --tap --listen 127.0.0.1:0 "$port" recording.txt
says tap '^tcp://'
ends 0 home "$(tr -d '\r' <tap)"
kill -INT "${children[-1]}"
wait "${children[-1]}" || fail "record: $(cat tap.errors)"
run monitor recording.txt >shown
says shown '> HOMING!'
says shown '< ACK: (HOMING!)'
run monitor - <recording.txt | grep -q '> HOMING!' || fail "standard input: $(cat errors)"
start watch monitor --protocol deltarobot --reconnect "$port"
run replay --side host --fast recording.txt - >sent
[ "$(head -c 5 sent | od -An -tx1 | tr -d ' ')" = 244800a63a ] || fail "replay: $(od -An -tx1 sent)"
kill -INT "${children[-1]}"
wait "${children[-1]}" || fail "monitor: $(cat watch.errors)"
ends 0 replay --side host --fast recording.txt "$port"
