#!/bin/sh
# Renews vendor/: the parts of three.js, uPlot and MCAP's reader that the station uses, in the versions of c_tests/station's lock file.
# For developers alone: building the program needs no npm. Takes the directory to write to, vendor/ by default.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
packages=$here/../../../c_tests/station
out=${1:-$here/vendor}
cd "$packages"
[ -d node_modules ] || npm ci --silent
export NODE_PATH="$packages/node_modules"
bundle() {
    npx --no-install esbuild "$here/vendor/$1.d.ts" --loader:.ts=ts --bundle --minify --format=esm --target=es2022 \
        --alias:@mcap/core="$packages/node_modules/@mcap/core" \
        --legal-comments=none --log-level=warning --outfile="$out/$1.js"
}
bundle three
bundle uplot
bundle mcap
cp node_modules/uplot/dist/uPlot.min.css "$out/uplot.css"
cp node_modules/three/LICENSE "$out/three.LICENSE"
cp node_modules/uplot/LICENSE "$out/uplot.LICENSE"
cat node_modules/@mcap/core/LICENSE node_modules/@foxglove/crc/LICENSE.md >"$out/mcap.LICENSE"
