#!/bin/sh
# Builds the targets given for which there is a toolchain, and says what the others lack.
# With FIRMWARE_STRICT=1 a target that can't be built is an error.
set -eu

here=$(dirname "$0")
missing=0
for target; do
    if tools=$("$here/build.sh" "$target"); then
        "$here/build.sh" "$target" "target/firmware/$target"
        echo "built $tools"
    else
        missing=1
    fi
done
[ $missing = 0 ] || [ "${FIRMWARE_STRICT:-0}" = 0 ]
