#!/bin/sh
# Changes the code in one place at a time, and looks whether the tests notice: mutants.sh SAMPLE SEED OUT takes a random
# sample of about SAMPLE changes of the core and the C ABI, which SEED picks. A change is tried on the unit tests, and
# where these pass, on the C programs of its subject, linked statically. Needs cargo-mutants.
set -eu

sample=$1
seed=$2
out=$PWD/$3
subjects="deltarobot line gx shared"
# Tests that count to a million take seconds this way, not minutes.
export CARGO_TARGET_DIR="$out/target" CARGO_PROFILE_TEST_OPT_LEVEL=1

# files SUBJECT: what belongs to it
files() {
    core=crates/protocols/src
    case $1 in
        deltarobot) echo "$core/deltarobot/** src/protocol* src/protocol/** src/protocol_ext/** src/payload* src/payload/**
            src/ring* src/receiver* src/host* src/host/** src/controller* src/controller/**" ;;
        line) echo "$core/line/** src/line* src/line_host/** src/line_device/** src/line_protocol/**" ;;
        gx) echo "$core/gx/** src/gx* src/gx/** src/gx_host/** src/gx_motion/** src/contouring_protocol*" ;;
        shared) echo "$core/*.rs $core/decimal/** $core/kinematics/** src/memory.rs src/state.rs src/kinematics.rs" ;;
    esac
}

# units SUBJECT: the unit tests that concern it
units() {
    case $1 in
        shared) echo "bytes:: decimal:: kinematics:: session::" ;;
        *) echo "$1::" ;;
    esac
}

# programs SUBJECT: the C tests that concern it
programs() {
    case $1 in
        deltarobot) echo "::deltarobot:: ::special:: traces:: oracle:: send_opcode" ;;
        line) echo "::line:: special::line line_demonstration" ;;
        gx) echo "::gx:: special::gx gx_exhaustive gx_demonstration" ;;
        shared) echo linked_statically ;;
    esac
}

# mutants SUBJECT OPTION...
mutants() {
    subject=$1
    shift
    set -f
    # shellcheck disable=SC2046 # a list of options
    cargo mutants --package deltarobot --package deltarobot-protocols --no-times --colors never --baseline skip \
        --timeout 300 --build-timeout 600 --output "$out/$subject" $(printf -- '-f %s ' $(files "$subject")) "$@"
    set +f
}

rm -rf "$out"/*/mutants.out*
total=0
for subject in $subjects; do
    mkdir -p "$out/$subject"
    total=$((total + $(mutants "$subject" --list 2>/dev/null | wc -l)))
done
shards=$(((total + sample - 1) / sample))
shard=--shard=$((seed % shards))/$shards
echo "mutants: shard $shard of $total"

# lines SUBJECT NAME: how many there are in the list of that name
lines() { find "$out/$1/mutants.out" -name "$2.txt" -exec cat {} + 2>/dev/null | wc -l; }

# A change that is missed makes cargo-mutants fail; the list says which.
noticed=0
: >"$out/missed.txt"
for subject in $subjects; do
    # shellcheck disable=SC2046 # a list of words
    mutants "$subject" "$shard" --sharding round-robin --test-package deltarobot-protocols -- --lib -- \
        $(units "$subject") || true
    noticed=$((noticed + $(lines "$subject" caught) + $(lines "$subject" timeout)))
    [ "$(lines "$subject" missed)" -gt 0 ] || continue
    # Those that the unit tests missed, by their names.
    set --
    while read -r name; do
        # shellcheck disable=SC2016 # a pattern
        set -- "$@" --re "^$(printf %s "$name" | sed 's/[][\.*^$(){}+?|]/\\&/g')\$"
    done <"$out/$subject/mutants.out/missed.txt"
    # shellcheck disable=SC2046 # a list of words
    mutants "$subject" "$@" --test-package deltarobot --features serial -- --test c_tests -- $(programs "$subject") \
        --skip linked_to_the_shared_library --skip under_the_sanitizers --skip under_valgrind --skip for_other_sizes ||
        true
    noticed=$((noticed + $(lines "$subject" caught) + $(lines "$subject" timeout)))
    cat "$out/$subject/mutants.out/missed.txt" >>"$out/missed.txt"
done

cat "$out/missed.txt"
echo "mutants: $noticed of $((noticed + $(wc -l <"$out/missed.txt"))) changes were noticed, the ones above were not"
