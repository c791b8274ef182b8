"""`conan create packaging/conan` in a clone of libdeltarobot; needs Rust, make and binutils, as `make` does."""

import os
import shutil

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import cross_building
from conan.tools.files import copy, load, rm, rmdir

SIZES = {
    "DP_BUFSIZE": 128,
    "DP_DATA_MAX_SIZE": 32,
    "OLP_LINE_MAX": 255,
    "OLP_WINDOW_MAX": 8,
    "OLP_REPLY_MAX": 128,
    "OLP_DEVICES_MAX": 16,
    "GX_QUEUE_MAX": 16,
    "GX_WINDOW_MAX": 16,
}


class Libdeltarobot(ConanFile):
    name = "libdeltarobot"
    description = "The deltarobot serial protocol, the Ozeki line protocol and GX binary vectors"
    license = "MIT OR Apache-2.0"
    topics = ("serial", "protocol", "robotics")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], **{size: ["ANY"] for size in SIZES}}
    default_options = {"shared": False, **SIZES}

    @property
    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        manifest = load(self, os.path.join(self._root, "Cargo.toml"))
        self.version = manifest.split('\nversion = "')[1].split('"')[0]

    def export_sources(self):
        # Folder by folder: Conan's copy searches all that is below, what was built too.
        for file in ("Cargo.toml", "Cargo.lock", "Makefile", "build.rs", "LICENSE-APACHE", "LICENSE-MIT", "README.md"):
            shutil.copy2(os.path.join(self._root, file), self.export_sources_folder)
        for folder in ("crates", "firmware", "include", "packaging", "src", "c_tests"):
            target = os.path.join(self.export_sources_folder, folder)
            copy(self, "*", os.path.join(self._root, folder), target, excludes="*/sizes_in_place.h")

    def validate(self):
        if cross_building(self):
            raise ConanInvalidConfiguration("cross-compile with make, which README.md shows")

    def package_id(self):
        # The same library for all C compilers.
        del self.info.settings.compiler
        del self.info.settings.build_type

    def _make(self, target, *variables):
        sizes = " ".join(f"{size}={getattr(self.options, size)}" for size in SIZES)
        self.run(" ".join(["make", target, "OUT=out", sizes, *variables]), cwd=self.source_folder)

    def layout(self):
        self.folders.source = "."
        self.folders.build = "."

    def build(self):
        self._make("lib")

    def package(self):
        self._make("install", f'PREFIX="{self.package_folder}"')
        copy(self, "LICENSE-*", self.source_folder, os.path.join(self.package_folder, "licenses"))
        # Conan writes these itself.
        for folder in ("pkgconfig", "cmake"):
            rmdir(self, os.path.join(self.package_folder, "lib", folder))
        unwanted = ["*.a"] if self.options.shared else ["*.so*", "*.dylib"]
        for pattern in unwanted:
            rm(self, pattern, os.path.join(self.package_folder, "lib"))

    def package_info(self):
        self.cpp_info.libs = ["deltarobot"]
        self.cpp_info.set_property("cmake_file_name", "deltarobot")
        self.cpp_info.set_property("cmake_target_name", "deltarobot::deltarobot")
        self.cpp_info.set_property("pkg_config_name", "deltarobot")
