#!/bin/sh
# Builds the wheel, installs it into a fresh environment and runs its tests: python.sh PROGRAM DIRECTORY, with the path
# of the program `deltarobot`. Exit status 77: Python, or what it takes from its package index, can't be had here.
set -eu
program=$1 work=$2
root=$(cd "$(dirname "$0")/../.." && pwd)

missing() {
    echo "$*"
    exit 77
}

rm -rf "$work/venv"
mkdir -p "$work"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' || missing "python3 is missing, or before 3.10"
python3 -m venv "$work/venv" || missing "python3 has no venv"
python=$work/venv/bin/python
"$python" -m pip --disable-pip-version-check install --quiet setuptools cffi pyserial numpy pytest mypy matplotlib ||
    missing "pip gets no packages"

rm -f "$work"/out/*.whl
make -C "$root" OUT="$work/out" PYTHON="$python" wheel
"$python" -m pip --disable-pip-version-check install --quiet --no-index "$work"/out/*.whl

export PATH="${program%/*}:$PATH" PYTHONDONTWRITEBYTECODE=1
cd "$root/packaging/python"
"$python" -m pytest -q --doctest-modules --doctest-glob='*.md' tests ../../docs/python.md --pyargs deltarobot
"$python" -m mypy --cache-dir "$work/mypy"
