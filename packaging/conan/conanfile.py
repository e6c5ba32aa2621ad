# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The library, its header and what finds them; not the tools."""
import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.0"


class OpenCVRefractConan(ConanFile):
    name = "opencv-refract"
    description = "cv::refract: cameras that look through a flat window, in the style of an OpenCV contrib module"
    license = "Apache-2.0"
    topics = ("computer-vision", "opencv", "calibration", "refraction", "photogrammetry")
    package_type = "shared-library"
    settings = "os", "arch", "compiler", "build_type"

    def set_version(self):
        for line in load(self, os.path.join(self._root, "CMakeLists.txt")).splitlines():
            if line.startswith("project(OpenCVRefract VERSION "):
                self.version = line.split()[2]

    @property
    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "modules/*", "packaging/debian/*"):
            copy(self, pattern, self._root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        check_min_cppstd(self, 17)

    def requirements(self):
        self.requires("opencv/[>=4.6 <5]", transitive_headers=True, transitive_libs=True)
        self.requires("ceres-solver/[>=2.1 <3]")
        self.requires("eigen/[>=3.3 <4]")

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("TOOLS", "SAMPLES", "TESTS", "BENCH"):
            toolchain.cache_variables[f"REFRACT_BUILD_{part}"] = False
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        for folder in ("cmake", "pkgconfig"):      # Conan writes its own
            rmdir(self, os.path.join(self.package_folder, "lib", folder))

    def package_info(self):
        self.cpp_info.libs = ["opencv_refract"]
        self.cpp_info.set_property("cmake_file_name", "OpenCVRefract")
        self.cpp_info.set_property("cmake_target_name", "opencv_refract")
        self.cpp_info.set_property("pkg_config_name", "opencv_refract")
        self.cpp_info.requires = ["opencv::opencv_core", "opencv::opencv_imgproc", "opencv::opencv_calib3d",
                                  "ceres-solver::ceres-solver", "eigen::eigen"]
