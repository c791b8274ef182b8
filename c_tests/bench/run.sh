#!/bin/sh
# run.sh LIBDIR WORKDIR [BUFSIZE DATA_MAX]: measures the library in LIBDIR (the OUT of `make lib`) beside plain C, for
# the deltarobot format the model of the original.
# Environment: CC, CFLAGS; STRICT=1 makes a missed goal an error. Time is shown, never judged: other programs run too.
set -eu
lib=$1 work=$2 sizes="-DDP_BUFSIZE=${3:-128} -DDP_DATA_MAX_SIZE=${4:-32}"
here=$(dirname "$0")
mkdir -p "$work"

# The model is what the original was: a library of its own, which the compiler can't merge with its caller.
model="$here/../deltarobot/model/model.c"
: >"$work/figures"
for program in deltarobot line gx; do
    # shellcheck disable=SC2086 # lists of options
    ${CC:-cc} ${CFLAGS:--O2 -Wall -Wextra} $sizes -I"$lib/include" -o "$work/$program" \
        "$here/$program.c" $model "$lib/libdeltarobot.a"
    model=
    "$work/$program" | awk '{ print "time", $0 }' >>"$work/figures"
    command -v valgrind >/dev/null || continue
    rm -f "$work"/callgrind.out*
    valgrind --tool=callgrind --callgrind-out-file="$work/callgrind.out" --compress-strings=no --compress-pos=no \
        "$work/$program" callgrind >"$work/callgrind.log" 2>&1 || { cat "$work/callgrind.log"; exit 1; }
    # A dump is one side of a case: its own total, and what the calls into the library or the model add up to.
    for dump in "$work"/callgrind.out.*; do
        awk -v program=$program '
            BEGIN { measured = program == "deltarobot" ? "(dp|model)_(process|recv|send|receiver)" : "(olp|gx|plain)_" }
            /^desc: Trigger: Client Request: / { name = $5; goal = $6; side = $7; bytes = $8 }
            /^fn=/ { inside = $0 ~ "^fn=" measured }
            /^cfn=/ { counts = !inside && $0 ~ "^cfn=" (name ~ /^full-ring/ ? "(dp|model)_recv" : measured) }
            /^calls=/ { getline; if (counts) calls += $2 }
            /^(totals|summary):/ { all = $2 }
            END { if (name != "") print "count", name, goal, side, bytes, calls / bytes, all / bytes }
        ' "$dump" >>"$work/figures"
    done
done
command -v valgrind >/dev/null || echo "valgrind is not installed: no instructions are counted, only time is measured."

awk -v strict="${STRICT:-0}" '
    $1 == "time" {
        if ($4 == "library") cases[++n] = $2
        v[$2, "ns", $4] = $6
        goal[$2] = $3
    }
    $1 == "count" { counted = 1; v[$2, "calls", $4] = $6; v[$2, "loop", $4] = $7 }
    function cell(what, side) { return (c, what, side) in v ? sprintf("%.1f", v[c, what, side]) : "-" }
    END {
        if (counted) {
            print "Instructions and nanoseconds for a byte of the wire. calls: inside the functions; loop: with the loop"
            print "that calls them. full-ring: one dp_recv, for a byte of the ring."
        }
        form = "%-24s %8s %8s %8s | %8s %8s | %8s %8s%s\n"
        printf form, "", "library", "model", "goal", "library", "model", "library", "model", ""
        printf form, "case", "calls", "calls", "", "loop", "loop", "ns", "ns", ""
        for (i = 1; i <= n; i++) {
            c = cases[i]; note = ""
            if (counted) {
                judged++
                if (goal[c] > 0 && v[c, "calls", "library"] > goal[c]) note = note " OVER-GOAL"
                if ((c, "calls", "model") in v && v[c, "calls", "library"] > v[c, "calls", "model"])
                    note = note " MORE-THAN-MODEL"
                if (note != "") missed++
            }
            if ((c, "ns", "model") in v && v[c, "ns", "library"] > v[c, "ns", "model"]) {
                slower++
                note = note " slower"
            }
            printf form, c, cell("calls", "library"), cell("calls", "model"), goal[c], cell("loop", "library"), \
                cell("loop", "model"), cell("ns", "library"), cell("ns", "model"), note
        }
        if (counted) {
            for (i = 1; i <= n; i++)
                if (cases[i] ~ /^full-ring/ && v[cases[i], "calls", "library"] > worst)
                    worst = v[cases[i], "calls", "library"]
            printf "One dp_recv of a full ring: at most %.1f instructions for a byte of the ring.\n", worst
            printf "%d cases, %d miss a goal; ", judged, missed
        }
        printf "slower than the model by the clock: %d\n", slower
        exit strict + 0 && missed > 0
    }' "$work/figures"
