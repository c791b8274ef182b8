#!/bin/sh
# Looks at what is shipped: check-artifact.sh OUT STAGE VERSION EXPORT... (called by `make check-artifact`).
#
# That the library can't panic is proved here: no code of Rust's panicking or formatting was linked, and no symbol is
# left to be found elsewhere. The stripped .so can't show that, so the file before stripping is looked at.
# shellcheck disable=SC2153 # NM, READELF, SIZE, SHARED, SERIAL, BARE and OBJECTS come from the Makefile
set -eu

static=$1/libdeltarobot.a
shared=$1/libdeltarobot.so.$3
stage=$2
shift 3
wanted=$(printf '%s\n' "$@" | sort)
# What the serial port asks of libc.
system='__errno_location
__xpg_strerror_r
clock_gettime
close
flock
ioctl
open
poll
read
strlen
tcdrain
tcflush
write'

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
    [ "$found" = "$wanted" ] || fail "$file does not export what is marked #[export], but: $found"
    missing=$(names --undefined-only "$@" "$file" | sed 's/@.*//' | grep -vxF "$allowed" || true)
    [ -z "$missing" ] || fail "$file needs symbols from elsewhere: $missing"
}

# check_lean FILE
check_lean() {
    waste=$(names "$1" | grep -iE 'panic|unwind|eh_personality|4core[0-9a-zA-Z_]*3fmt|core_fmt|alloc' || true)
    [ -z "$waste" ] || fail "the library can panic or allocate: $1 has $waste"
}

allowed='' libraries=''
# grep takes an empty list for a pattern that empty lines match: then there are only those.
if [ "$SERIAL" = yes ]; then
    allowed=$system libraries=libc.so.6
fi
found=$(ar t "$static" | xargs)
[ "$found" = "$OBJECTS" ] || fail "$static consists of $found instead of $OBJECTS"
check_exports "$static"
check_lean "$static"
ram=$("$SIZE" -A "$static" | awk '$1 ~ /^\.(data|bss)/ && $1 !~ /^\.data\.rel\.ro/ && $2 > 0 { print $1 }')
[ -z "$ram" ] || fail "the library has variables: $ram"
# A program that does not use the serial port needs nothing.
for object in $OBJECTS; do
    missing=$(names --undefined-only "$stage/$object")
    [ -z "$missing" ] || [ "$object" = serial.o ] || fail "$object needs symbols from elsewhere: $missing"
done
# Firmware has no unwinder, and linkers complain about tables for one that refer to code they dropped.
if [ -n "$BARE" ]; then
    unwinding=$("$SIZE" -A "$static" | awk '$1 ~ /^\.(eh_frame|ARM\.ex)/ { print $1 }')
    [ -z "$unwinding" ] || fail "$static has unwind tables: $unwinding"
fi
sizes="$static $(wc -c <"$static") bytes"

if [ "$SHARED" = yes ]; then
    check_exports "$shared" --dynamic
    check_lean "$stage/cargo.so"
    needed=$("$READELF" --dynamic "$shared" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | xargs)
    [ "$needed" = "$libraries" ] || fail "$shared needs $needed"
    sizes="$sizes, $shared $(wc -c <"$shared") bytes"
fi
echo "check-artifact: $sizes, $# symbols, nothing else"
