#!/bin/sh
# Packs the archives of all firmware targets and their headers, called by `make firmware-package`: pack.sh OUT VERSION.
# Environment: FIRMWARE_MCUS, the AVRs; the sizes in src/sizes.mk.
set -eu

mkdir -p "$1"
out=$(cd "$1" && pwd) version=$2
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
package=$out/libdeltarobot
rm -rf "$package"
mkdir -p "$package/src"

# archive TARGET DIRECTORY...: builds it, and puts it into these.
archive() {
    target=$1
    shift
    built=target/firmware/$target${MCU:+-$MCU}
    firmware/build.sh "$target" "$built"
    for directory; do
        mkdir -p "$package/src/$directory"
        cp "$built/libdeltarobot.a" "$package/src/$directory/"
    done
}

# As Arduino calls the processors, and below them what they give as -mfpu and -mfloat-abi.
MCU=
archive thumbv6m-none-eabi cortex-m0 cortex-m0plus
archive thumbv7m-none-eabi cortex-m3
archive thumbv7em-none-eabi cortex-m4 cortex-m4/fpv4-sp-d16-softfp cortex-m7
archive thumbv7em-none-eabihf cortex-m4/fpv4-sp-d16-hard cortex-m7/fpv4-sp-d16-hard cortex-m7/fpv5-sp-d16-hard \
    cortex-m7/fpv5-d16-hard
archive thumbv8m.main-none-eabi cortex-m33
archive thumbv8m.main-none-eabihf cortex-m33/fpv5-sp-d16-hard
archive riscv32imc-unknown-none-elf esp32c2 esp32c3
archive riscv32imac-unknown-none-elf esp32c6 esp32h2
esp=$(cd "$package/src" && echo esp* | sed 's/ /, /g')
cp -R "$built/include/." "$package/src"
for MCU in $FIRMWARE_MCUS; do
    export MCU
    archive avr-none "$MCU"
done

# Arduino finds a library by a header at the top.
{
    echo "/* All of libdeltarobot that firmware may use. Each header can be included alone, as libdeltarobot/NAME.h. */"
    (cd "$package/src" && for header in libdeltarobot/*.h; do
        case $header in
            *abi.h | *sizes.h | *deltarobot/deltarobot.h | *pc_utils.h) ;;
            *) echo "#include \"$header\"" ;;
        esac
    done)
} >"$package/src/libdeltarobot.h"

(cd "$here" && cp -R README.md CMakeLists.txt keywords.txt platformio.py zephyr examples extras "$package")
cp LICENSE-APACHE LICENSE-MIT packaging/target.cmake "$package"
for file in library.properties library.json idf_component.yml; do
    sed -e "s|@VERSION@|$version|" -e "s|@ESP_TARGETS@|$esp|" "$here/$file" >"$package/$file"
done
zip=libdeltarobot-firmware-$version.zip
(cd "$out" && rm -f "$zip" && python3 -m zipfile -c "$zip" libdeltarobot)
echo "firmware-package: $out/$zip"
