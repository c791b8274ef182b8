# PlatformIO runs this when it builds the library: picks the archive that fits the board's processor and float ABI.
import os

Import("env")  # noqa: F821 (PlatformIO's)

board = env.BoardConfig()  # noqa: F821
flags = [str(flag) for name in ("CCFLAGS", "CFLAGS", "CPPFLAGS", "LINKFLAGS") for flag in env.get(name, [])]  # noqa: F821
values = {flag.split("=")[0]: flag.split("=")[1] for flag in flags if flag.startswith(("-mfpu=", "-mfloat-abi="))}
floats = "-".join(values[name] for name in ("-mfpu", "-mfloat-abi") if name in values)
source = os.path.join(os.getcwd(), "src")
places = [(board.get(name, ""), extra) for name in ("build.cpu", "build.mcu") for extra in (floats, "")]
found = [os.path.join(source, mcu, extra) for mcu, extra in places if mcu]
archives = [place for place in found if os.path.exists(os.path.join(place, "libdeltarobot.a"))]
if not archives:
    raise SystemExit("libdeltarobot: no archive for %s" % board.get("build.mcu"))
env.Append(LIBPATH=archives[:1], LIBS=["deltarobot"])  # noqa: F821
