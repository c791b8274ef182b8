"""Builds the wheel: the shared library by `make`, and what cffi needs to know from the headers that come with it.

The library is loaded, not linked to, and needs no other: one wheel serves every Python 3 and every libc of a processor.
Environment: PYTHON_BUILD, where to build (`make wheel` sets it); DP_TARGET and CROSS_COMPILE, as `make` takes them.
"""

import os
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("PYTHON_BUILD") or ROOT / "target" / "wheel").resolve()
TARGET = os.environ.get("DP_TARGET", "")
HEADERS = ["payload.h", "protocol_ext.h", "host.h", "kinematics.h", "line_protocol.h", "gx.h"]

# The platform that pip knows: of the targets that the Makefile builds shared libraries for.
PLATFORMS = {
    "x86_64-pc-windows-gnu": "win_amd64",
    "i686-pc-windows-gnu": "win32",
    "x86_64-unknown-linux-gnu": "manylinux2014_x86_64.musllinux_1_1_x86_64",
    "aarch64-unknown-linux-gnu": "manylinux2014_aarch64.musllinux_1_1_aarch64",
    "i686-unknown-linux-gnu": "manylinux2014_i686.musllinux_1_1_i686",
    "armv7-unknown-linux-gnueabihf": "manylinux2014_armv7l.musllinux_1_1_armv7l",
    "s390x-unknown-linux-gnu": "manylinux2014_s390x.musllinux_1_1_s390x",
}


def platform() -> str:
    if TARGET:
        if TARGET not in PLATFORMS:
            raise SystemExit(f"DP_TARGET={TARGET}: wheels are built for {', '.join(PLATFORMS)}")
        return PLATFORMS[TARGET]
    here = re.sub("[-.]", "_", sysconfig.get_platform())
    return re.sub("^linux_(.*)", r"manylinux2014_\1.musllinux_1_1_\1", here)


def make() -> Path:
    """The directory with the library, without the serial port: so it needs no libc."""
    relative = os.path.relpath(BUILD / f"library-{TARGET or 'host'}", ROOT)
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS")}
    command = ["make", "--no-print-directory", "lib", f"OUT={relative}", "SERIAL=no", "SHARED=yes"]
    subprocess.run(command, cwd=ROOT, env=environment, check=True)
    return ROOT / relative


def declarations(include: Path) -> str:
    """What cffi reads: the headers behind the preprocessor, and the macros that are plain numbers."""
    stubs = BUILD / "stubs"
    stubs.mkdir(parents=True, exist_ok=True)
    for header in ("stdint.h", "stddef.h"):  # cffi knows what they declare
        (stubs / header).write_text("")
    source = "".join(f'#include "libdeltarobot/{header}"\n' for header in HEADERS)
    macros = ["-U__GNUC__", "-U__clang__", "-D_WIN64" if platform() == "win_amd64" else "-U_WIN64"]
    command = [os.environ.get("CC") or "cc", "-E", "-nostdinc", f"-I{include}", f"-I{stubs}", *macros, "-xc", "-"]
    run = lambda *flags: subprocess.run([*command, *flags], input=source, stdout=subprocess.PIPE, text=True, check=True)
    text = run("-P").stdout
    # The plain names: those with the sizes are for programs that were compiled with the headers.
    text = re.sub(r"\b((?:dp|olp|gx)_[a-z0-9_]*?)(?:_\d+){2,4}(?= *\()", r"\1", text)
    text = re.sub(r"struct libdeltarobot_packing_of_\w+;", "", text)
    long, pointer = word_sizes()
    text = text.replace("sizeof(unsigned long)", str(long)).replace("sizeof(size_t)", str(pointer))
    numbers = re.findall(r"^#define ((?:DP|OLP|GX)_\w+) \(?(-?\d+)\)?$", run("-dM").stdout, re.MULTILINE)
    return text + "".join(f"#define {name} {value}\n" for name, value in numbers)


def word_sizes() -> tuple[int, int]:
    """Of an unsigned long and a pointer."""
    pointer = 4 if re.search("win32|i686|armv7l", platform()) else 8
    return 4 if platform().startswith("win") else pointer, pointer


class BuildPy(build_py):
    def run(self) -> None:
        super().run()
        from cffi import FFI

        out = make()
        package = Path(self.build_lib) / "deltarobot"
        libraries = ["deltarobot.dll", "libdeltarobot.dylib", "libdeltarobot.so"]
        library = next(out / name for name in libraries if (out / name).exists())
        shutil.copyfile(library, package / library.name)
        ffi = FFI()
        ffi.cdef(declarations(out / "include"))
        ffi.set_source("deltarobot._abi", None)
        ffi.emit_python_code(str(package / "_abi.py"))


class Wheel(bdist_wheel):
    def get_tag(self) -> tuple[str, str, str]:
        return "py3", "none", platform()

    def finalize_options(self) -> None:
        super().finalize_options()
        self.root_is_pure = False


BUILD.mkdir(parents=True, exist_ok=True)
setup(
    version=re.search('^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1],
    cmdclass={"build_py": BuildPy, "bdist_wheel": Wheel},
    options={"build": {"build_base": str(BUILD / "build")}, "egg_info": {"egg_base": str(BUILD)}},
)
