# The dependencies that Debian 12 has, in place of Conan's own: to try the recipe without a remote.
[settings]
os=Linux
arch=x86_64
compiler=gcc
compiler.version=12
compiler.libcxx=libstdc++11
compiler.cppstd=17
build_type=Release

[platform_requires]
opencv/4.6.0
ceres-solver/2.1.0
eigen/3.4.0

[conf]
tools.cmake.cmaketoolchain:generator=Ninja
