# Worst-case stack of a function (-v fn=NAME) in the output of `objdump -d`, in bytes, with all it calls but not the
# caller's callbacks (calls through a pointer). A function's own part is the sum of all that it pushes and reserves,
# wherever that stands. -v call=N: bytes that a call instruction pushes (2 or 3 on AVR).

/^[0-9a-f]+ <.*>:$/ { name = $2; gsub(/[<>:]/, "", name); low = high = 0; next }
name == "" { next }

{
    split($0, field, "\t")
    op = field[3]; args = field[4]
    if (split(op, word, " ") > 1) { op = word[1]; args = substr(field[3], length(op) + 2) }
    sub(/[;@].*/, "", args)
}

# ARM
op ~ /^(push|stmdb|vpush)/ && args ~ /\{/ && (op !~ /^stmdb/ || args ~ /^sp!/) {
    list = args; sub(/.*\{/, "", list); sub(/\}.*/, "", list)
    bytes = 0
    n = split(list, part, ",")
    for (i = 1; i <= n; i++)
        if (split(part[i], range, "-") == 2) {
            gsub(/[^0-9]/, "", range[1]); gsub(/[^0-9]/, "", range[2])
            bytes += range[2] - range[1] + 1
        } else
            bytes++
    own[name] += bytes * (list ~ /d[0-9]/ ? 8 : 4)
    next
}
op ~ /^sub(\.w|w)?$/ && args ~ /^sp, (sp, )?#/ { sub(/.*#/, "", args); own[name] += args; next }
op ~ /^str/ && args ~ /\[sp, #-[0-9]+\]!/ { sub(/.*#-/, "", args); own[name] += args + 0; next }
# (Within a function bl is a far jump.)
op ~ /^blx?(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?$/ && /</ {
    if (target($0) != name || !/\+0x[0-9a-f]+>/) calls[name] = calls[name] " " target($0)
    next
}
op ~ /^b(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?(\.[nw])?$/ && /</ { tail($0); next }

# RISC-V
op ~ /^(c\.)?addi?(16sp)?$/ && args ~ /^sp,(sp,)?-/ { sub(/.*,-/, "", args); own[name] += args; next }
op ~ /^(jal|jalr|call)$/ && /</ { calls[name] = calls[name] " " target($0); next }
op ~ /^(j|tail)$/ && /</ { tail($0); next }

# AVR: the frame is taken off the Y register, between reading the stack pointer and writing it
op == "push" { own[name]++; next }
op ~ /^e?icall$/ { own[name] += call; next }
op ~ /^r?call$/ && /<.*\+0x/ && args ~ /^\.\+0/ { own[name] += call; next }
op ~ /^r?call$/ && /</ { calls[name] = calls[name] " " target($0); next }
op ~ /^r?jmp$/ && /</ { tail($0); next }
op == "in" && args ~ /^r28, 0x3d/ { frame[name] = 1; next }
op == "out" && args ~ /^0x3d/ { frame[name] = 0; next }
frame[name] && op == "sbiw" && args ~ /^r28/ { sub(/.*0x/, "", args); own[name] += hex(args); next }
frame[name] && op == "subi" && args ~ /^r28/ { sub(/.*0x/, "", args); low = hex(args); next }
frame[name] && op == "sbci" && args ~ /^r29/ {
    sub(/.*0x/, "", args); high = hex(args); bytes = low + 256 * high
    if (bytes < 32768) own[name] += bytes
    next
}

function hex(text,    i, value) {
    value = 0
    text = tolower(text); gsub(/[^0-9a-f]/, "", text)
    for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
    return value
}
function target(line) { sub(/.*</, "", line); sub(/[>+].*/, "", line); return line }
function tail(line,    to) { to = target(line); if (to != name) tails[name] = tails[name] " " to }

function worst(fn, depth,    list, n, i, most, deeper) {
    if (fn in done) return done[fn]
    if (depth > 20) { print "stack.awk: recursion at " fn > "/dev/stderr"; exit 1 }
    most = own[fn] + 0
    n = split(calls[fn], list, " ")
    for (i = 1; i <= n; i++) { deeper = own[fn] + call + worst(list[i], depth + 1); if (deeper > most) most = deeper }
    n = split(tails[fn], list, " ")
    for (i = 1; i <= n; i++) { deeper = worst(list[i], depth + 1); if (deeper > most) most = deeper }
    return done[fn] = most
}

END { print worst(fn, 0) }
