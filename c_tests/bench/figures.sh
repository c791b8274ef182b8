#!/usr/bin/env bash
# Prints sizes, speeds and coverage as one page of Markdown: figures.sh LIBDIR WORKDIR [BUFSIZE DATA_MAX]. Called by
# `make figures`, which has built the library in LIBDIR and, below target/firmware, those for FIRMWARE_TARGETS.
set -euo pipefail
work=$2
here=$(dirname "$0")
mkdir -p "$work"

cat <<END
# Figures

Written by \`make figures\`, on $(uname -m) with $(rustc --version | cut -d ' ' -f 1,2) and $(${CC:-cc} --version | sed -n 1p).

## Instructions for each byte of the wire

Counted by callgrind, calls inclusive. \`model\` is plain C: for the deltarobot format a model of the original's
algorithm, for the others the obvious way. \`full-ring\`: one \`dp_recv\`, for each byte of the ring. Also printed by
\`make bench\`, with times.

| case | library | model | goal |
|---|---|---|---|
END
"$here/run.sh" "$@" >"$work/bench.log"
awk '
    $1 == "time" && $4 == "library" { name[++n] = $2 }
    $1 == "count" { goal[$2] = $3; value[$2, $4] = sprintf("%.1f", $6) }
    function cell(side) { return (name[i], side) in value ? value[name[i], side] : "" }
    function limit() { return goal[name[i]] > 0 ? goal[name[i]] : "" }
    END { for (i = 1; i <= n; i++) printf "| `%s` | %s | %s | %s |\n", name[i], cell("library"), cell("model"), limit() }
' "$work/figures"

cat <<END

## Flash, RAM and stack on bare metal

Bytes, with all that is called. \`make firmware-size\` prints the same for each function, and a whole sketch on AVR.

END
for target in $FIRMWARE_TARGETS; do
    "$here/../../firmware/size.sh" "$target" "$here/../../target/firmware/$target"
done | awk '
    $1 == "target" && done++ || $1 != "target" && $2 !~ /^(these|all|a|RAM:)$/ { next }
    { name = $2; last = NF; for (i = 3; i <= NF && $i !~ /^([0-9]+|-|bytes)$/; i++) name = name " " $i
      row = "| " $1 " | " name; for (; i <= NF; i++) row = row " | " $i; print row " |" }
    $1 == "target" { gsub(/[^|]+/, "---", row); print row "|" }'

cat <<END

## Instructions and cycles on firmware

A byte of the wire, in emulators: instructions on Cortex-M0 and Cortex-M4, cycles on AVR; the last lines of each with the
loop that calls, those before without. \`model\` is a model of the original's algorithm. Also printed by
\`make firmware-bench\`.

\`\`\`text
END
HOST_LIB=$1 "$here/../firmware/run.sh" bench
cat <<END
\`\`\`

## Lines of the library that the tests run

Also printed by \`make coverage\`.

| file | lines | run |
|---|---|---|
END
"$here/../coverage.sh" "$work/coverage" | sed 's/ *\([0-9]*\) lines *\([0-9.]* %\)$/ | \1 | \2 |/; s/^/| /'
