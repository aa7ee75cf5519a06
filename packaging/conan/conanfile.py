"""kerf for Conan 2: `conan create packaging/conan` from a checkout.

Options: `threads` (tbb, std, serial), `c_interface`, and `system_packages`, which takes Highway, xxHash and oneTBB
from the system instead of from a remote.
"""

import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.0"


class KerfConan(ConanFile):
    name = "kerf"
    description = "Split bounding volume hierarchies over triangle meshes: exact, watertight rays and spatial queries"
    license = "Apache-2.0"
    topics = ("ray-tracing", "bvh", "mesh", "geometry")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "threads": ["tbb", "std", "serial"],
        "c_interface": [True, False],
        "system_packages": [True, False],
    }
    default_options = {
        "shared": False,
        "fPIC": True,
        "threads": "tbb",
        "c_interface": False,
        "system_packages": False,
    }
    implements = ["auto_shared_fpic"]

    @property
    def _checkout(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._checkout, "CMakeLists.txt"))
        self.version = re.search(r"project\(kerf VERSION ([0-9.]+)", text).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "src/*", "bindings/c/*"):
            copy(self, pattern, self._checkout, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def requirements(self):
        if self.options.system_packages:
            return
        self.requires("highway/[>=1.0.3]")
        self.requires("xxhash/[>=0.8.1]")
        if self.options.threads == "tbb":
            self.requires("onetbb/[>=2021.8]")

    def validate(self):
        check_min_cppstd(self, 20)

    def generate(self):
        toolchain = CMakeToolchain(self)
        variables = toolchain.cache_variables
        variables["KERF_THREADS"] = str(self.options.threads)
        variables["KERF_BINDINGS_C"] = bool(self.options.c_interface)
        for part in ("BUILD_TOOL", "BUILD_TESTS", "BUILD_BENCHMARKS", "BUILD_EXAMPLES", "TEST_PACKAGE"):
            variables[f"KERF_{part}"] = False
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))  # CMakeDeps writes its own
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))

    def package_info(self):
        library = self.cpp_info.components["kerf"]
        library.libs = ["kerf"]
        library.set_property("cmake_target_name", "kerf::kerf")
        self.cpp_info.set_property("cmake_file_name", "kerf")
        if self.options.system_packages:
            library.system_libs = ["hwy"] + (["tbb"] if self.options.threads == "tbb" else [])
        else:
            library.requires = ["highway::highway", "xxhash::xxhash"]
            if self.options.threads == "tbb":
                library.requires.append("onetbb::onetbb")
        if self.options.threads == "std" and self.settings.os in ("Linux", "FreeBSD"):
            library.system_libs.append("pthread")
        if self.options.c_interface:
            interface = self.cpp_info.components["kerf_c"]
            interface.libs = ["kerf_c"]
            interface.set_property("cmake_target_name", "kerf::c")
            interface.requires = ["kerf"]
