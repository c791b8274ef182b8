#!/bin/sh
# Looks at what is shipped: check-artifact.sh OUT STAGE VERSION EXPORT... (called by `make check-artifact`).
#
# That the library can't panic is proved here: no code of Rust's panicking or formatting was linked, and no symbol is
# left to be found elsewhere. The stripped files can't show that, so the files before stripping are looked at too.
set -eu

out=$1 stage=$2 version=$3
shift 3
wanted=$(printf '%s\n' "$@" | sort)
static=$out/libdeltarobot.a
shared=$out/libdeltarobot.so.$version

fail() {
    printf 'check-artifact: %s\n' "$1" >&2
    exit 1
}

# names NM-OPTION... FILE: the symbols, sorted.
names() {
    "$NM" "$@" | sed -n 's/^.* //p' | sort
}

# check_exports FILE NM-OPTION...
check_exports() {
    file=$1
    shift
    found=$(names --extern-only --defined-only "$@" "$file")
    [ "$found" = "$wanted" ] || fail "$file does not export what src/ffi/exports.txt says, but: $(echo $found)"
    missing=$(names --undefined-only "$@" "$file")
    [ -z "$missing" ] || fail "$file needs symbols from elsewhere: $(echo $missing)"
}

# check_lean FILE
check_lean() {
    waste=$(names "$1" | grep -iE 'panic|unwind|eh_personality|4core[0-9a-zA-Z_]*3fmt|core_fmt|alloc' || true)
    [ -z "$waste" ] || fail "the library can panic or allocate: $1 has $(echo $waste)"
}

members=$(ar t "$static" | wc -l)
[ "$members" -eq 1 ] || fail "$static has $members objects, not one"
check_exports "$static"
check_lean "$stage/linked.o"
sizes="$static $(wc -c <"$static") bytes"

if [ "$SHARED" = yes ]; then
    check_exports "$shared" --dynamic
    check_lean "$stage/cargo.so"
    needed=$("$READELF" --dynamic "$shared" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
    [ -z "$needed" ] || fail "$shared needs $(echo $needed)"
    sizes="$sizes, $shared $(wc -c <"$shared") bytes"
fi
echo "check-artifact: $sizes, $# symbols, nothing else"
