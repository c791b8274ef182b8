#!/bin/sh
# Installs what `make` has built, or removes it: `install.sh install|uninstall`, called by `make install|uninstall`,
# which sets the variables. Directories may contain spaces.
# shellcheck disable=SC2153 # those in capitals are the Makefile's
set -eu

# absolute DIRECTORY: the same, from /, without slashes at its end.
absolute() {
    case $1 in
        /*) path=$1 ;;
        *) path=$PWD/$1 ;;
    esac
    while [ "${path%/}" != "$path" ]; do path=${path%/}; done
    printf %s "$path"
}
prefix=$(absolute "$PREFIX")
libdir=$(absolute "$LIBDIR")
includedir=$(absolute "$INCLUDEDIR")

headers=$includedir/libdeltarobot
pkgconfig=$libdir/pkgconfig
cmake=$libdir/cmake/deltarobot
major=${VERSION%%.*}

# put MODE FILE DIRECTORY
put() {
    mkdir -p "$DESTDIR$3"
    install -m "$1" "$2" "$DESTDIR$3/${2##*/}"
}

# link TARGET NAME: a symbolic link in the library's directory.
link() {
    ln -sf "$1" "$DESTDIR$libdir/$2"
}

# below DIRECTORY VARIABLE: the directory, told relative to the variable that holds the prefix when it lies there: then
# the whole tree can be moved.
below() {
    case $1/ in
        "$prefix"/*) printf %s "\${$2}${1#"$prefix"}" ;;
        *) printf %s "$1" ;;
    esac
}

# escaped TEXT: as the replacement in sed's s|||.
escaped() {
    printf %s "$1" | sed 's/[\\&|]/\\&/g'
}

# The sizes as the lines of a file, behind one another in a replacement of sed's.
pc_sizes='' cmake_sizes=''
for size in $SIZES; do
    pc_sizes="$pc_sizes\\
$(printf %s "${size%%=*}" | tr '[:upper:]' '[:lower:]')=${size#*=}"
    cmake_sizes="$cmake_sizes\\
set(deltarobot_${size%%=*} ${size#*=})"
done

# template FILE DIRECTORY VARIABLE: the file in packaging/ with its placeholders filled in; the variable holds the
# prefix in that file.
template() {
    mkdir -p "$DESTDIR$2"
    sed -e "s|@VERSION@|$VERSION|g" -e "s|@MAJOR@|$major|g" \
        -e "s|@PC_SIZES@|$pc_sizes|" -e "s|@CMAKE_SIZES@|$cmake_sizes|" \
        -e "s|@PREFIX@|$(escaped "$prefix")|g" -e "s|@CMAKE_PREFIX@|$(escaped "$cmake_prefix")|g" \
        -e "s|@LIBDIR@|$(escaped "$(below "$libdir" "$3")")|g" \
        -e "s|@INCLUDEDIR@|$(escaped "$(below "$includedir" "$3")")|g" \
        "packaging/$1" >"$DESTDIR$2/$1"
    chmod 644 "$DESTDIR$2/$1"
}

# The prefix as the CMake files find it: so many directories above their own.
case $cmake/ in
    "$prefix"/*) cmake_prefix="\${_deltarobot_here}"$(printf %s "${cmake#"$prefix"}" | sed 's,[^/][^/]*,..,g') ;;
    *) cmake_prefix=$prefix ;;
esac

case $1 in
    install)
        # Without cargo, what is there may be anything.
        for size in $SIZES; do
            if ! grep -qsx "#define ${size%%=*} ${size#*=}" "$OUT"/include/libdeltarobot/*.h ||
                [ ! -e "$OUT/libdeltarobot.a" ]; then
                echo "install: $OUT has no library with $size; build it with make first" >&2
                exit 1
            fi
        done
        for header in $HEADERS; do
            put 644 "$OUT/include/$header" "$(dirname "$includedir/$header")"
        done
        put 644 "$OUT/libdeltarobot.a" "$libdir"
        put 644 src/protocol_pc_utils.cpp "$prefix/share/deltarobot"
        # The shared library, and its links, each to the one before it; a .dll stands beside the programs, and has none.
        previous=
        for file in $SHARED_FILES; do
            [ -e "$OUT/$file" ] || break
            case $file in
                *.dll) put 755 "$OUT/$file" "$(absolute "$BINDIR")" ;;
                *.dll.a | *.def) put 644 "$OUT/$file" "$libdir" ;;
                *) if [ -z "$previous" ]; then put 755 "$OUT/$file" "$libdir"; else link "$previous" "$file"; fi ;;
            esac
            previous=$file
        done
        template deltarobot.pc "$pkgconfig" prefix
        template deltarobot-config.cmake "$cmake" _deltarobot_prefix
        template deltarobot-config-version.cmake "$cmake" _deltarobot_prefix
        echo "install: libdeltarobot $VERSION is in $DESTDIR$libdir"
        ;;
    uninstall)
        for header in $HEADERS; do
            rm -f "$DESTDIR$includedir/$header"
        done
        for file in libdeltarobot.a $SHARED_FILES; do
            case $file in
                *.dll) rm -f "$DESTDIR$(absolute "$BINDIR")/$file" ;;
                *) rm -f "$DESTDIR$libdir/$file" ;;
            esac
        done
        rm -f "$DESTDIR$prefix/share/deltarobot/protocol_pc_utils.cpp"
        rm -f "$DESTDIR$pkgconfig/deltarobot.pc" "$DESTDIR$cmake/deltarobot-config.cmake" \
            "$DESTDIR$cmake/deltarobot-config-version.cmake"
        # Only ours, and not if somebody put something there.
        for directory in "$headers" "$cmake" "$prefix/share/deltarobot"; do
            rmdir "$DESTDIR$directory" 2>/dev/null || true
        done
        echo "uninstall: libdeltarobot $VERSION is gone from $DESTDIR$libdir"
        ;;
    *)
        echo "usage: $0 install|uninstall" >&2
        exit 2
        ;;
esac
