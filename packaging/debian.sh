#!/bin/sh
# Builds Debian's packages, called by `make deb`: debian.sh OUT VERSION [OPTION of dpkg-buildpackage]... They are built
# from a copy of the tree, with packaging/debian in the place where dpkg-buildpackage wants it, into OUT.
set -eu

out=$1 version=$2
shift 2
cd "$(dirname "$0")/.."
tree=$out/libdeltarobot-$version
rm -rf "$tree"
mkdir -p "$tree"
for entry in * ; do
    case $entry in
        target | build | fuzz) ;;
        *) cp -R "$entry" "$tree" ;;
    esac
done
rm -f "$tree/include/libdeltarobot/sizes_in_place.h"
mv "$tree/packaging/debian" "$tree/debian"
cd "$tree/debian"
major=${version%%.*}
mv libdeltarobot.install "libdeltarobot$major.install"
sed -i "s/@MAJOR@/$major/" control
# The text of a license stands behind a space, and empty lines are dots.
sed -e 's/^$/./' -e 's/^/ /' ../LICENSE-MIT >license
sed -i -e '/@MIT@/{r license' -e 'd}' copyright
rm license
chmod +x rules
cat >changelog <<EOF
libdeltarobot ($version) unstable; urgency=medium

  * See CHANGELOG.md.

 -- The libdeltarobot developers <nobody@example.org>  $(date -R)
EOF
cd ..
# They are make's, which has called this.
unset OUT MAKEFLAGS MFLAGS
dpkg-buildpackage -b -us -uc "$@"
