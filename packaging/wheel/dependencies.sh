# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# What the wheel carries inside, compiled as static libraries with hidden names: sourced by build.sh, which sets
#   work     where sources are unpacked and compiled
#   prefix   where headers, libraries and programs go
#   licences      where what each of them is under goes
#   opencv_archive      OpenCV's source package
#   zig_cc, zig_cxx, zig_ar, zig_ranlib      the compiler for the oldest glibc
# Each function makes one library; its source is Debian's, OpenCV's that of PyPI.

# shellcheck shell=sh disable=SC2154  # the variables above are those of build.sh

once() {        # once NAME SOURCE: runs the function NAME unless that was done before, with the same source
  [ ! -e "$work/$1.done" ] || [ "$(cat "$work/$1.done")" != "$2" ] || return 0
  echo "Building $1"
  begun=$(date +%s)
  rm -rf "${work:?}/$1"
  mkdir "$work/$1"
  # A list of commands after || would run to its end in spite of errors, so a shell of its own says how it ended.
  code=0
  (set -e; cd "$work/$1"; "$1") >"$work/$1.log" 2>&1 & wait $! || code=$?
  [ $code = 0 ] || { tail -30 "$work/$1.log" >&2; echo "packaging/wheel: $1 could not be built: see $work/$1.log" >&2; exit 1; }
  echo "$(($(date +%s) - begun)) s"
  printf %s "$2" >"$work/$1.done"
}

debian_source() {       # debian_source PACKAGE: unpacks its source with Debian's changes into ./source
  # The sources of what this machine's apt gets packages from; apt checks their signatures.
  lists=$work/apt
  mkdir -p "$lists/partial"
  if [ ! -s "$work/sources.list" ]; then
    apt-get indextargets --format 'deb-src $(SITE) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' 'Origin: Debian' |
      sort -u >"$work/sources.list"
  fi
  apt="apt-get -qq -o Dir::Etc::SourceList=$work/sources.list -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists=$lists
    -o APT::Sandbox::User=root"
  $apt update
  rm -rf ./*
  # A mirror may lack the newest of the security updates, or Debian's changes to a source.
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  $apt source "$1" || $apt source "$1/$release" || { $apt source --tar-only "$1/$release" && tar -xf ./*.orig.tar.*; }
  mv ./*/ source
}

build_cmake() {         # build_cmake SOURCE OPTIONS...
  source=$1; shift
  launcher=""
  command -v ccache >/dev/null && launcher="-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache"
  PKG_CONFIG_LIBDIR=$prefix/lib/pkgconfig PKG_CONFIG_PATH="" cmake -S "$source" -B build -G Ninja \
    -DCMAKE_TOOLCHAIN_FILE="$work/toolchain.cmake" -DCMAKE_BUILD_TYPE=Release $launcher \
    -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_C_VISIBILITY_PRESET=hidden \
    -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_VISIBILITY_INLINES_HIDDEN=ON -DCMAKE_INSTALL_PREFIX="$prefix" \
    -DCMAKE_INSTALL_LIBDIR=lib "$@"
  cmake --build build
  cmake --install build
}

autotools() {           # autotools CONFIGURE_OPTIONS...: in the folder of configure
  CC=$zig_cc CXX=$zig_cxx AR=$zig_ar RANLIB=$zig_ranlib CPPFLAGS=-I$prefix/include LDFLAGS=-L$prefix/lib \
    CFLAGS="-O2 -fPIC -fvisibility=hidden -w" PKG_CONFIG_LIBDIR=$prefix/lib/pkgconfig PKG_CONFIG_PATH="" \
    ./configure "$@"
}

compile() {             # compile MAKE_ARGUMENTS...: but never anew what Debian's changes make look out of date in configure
  make -j"$(nproc)" ACLOCAL=: AUTOCONF=: AUTOHEADER=: AUTOMAKE=: "$@"
}

static_library() {      # static_library NAME FILES...: of C, that need no configuration
  library=$1; shift
  objects=""
  for file in "$@"; do
    object=$(echo "$file" | tr / _).o
    "$zig_cc" -O2 -fPIC -fvisibility=hidden -w -I. -I"$prefix/include" $defines -c "$file" -o "$object"
    objects="$objects $object"
  done
  "$zig_ar" rcs "$prefix/lib/lib$library.a" $objects
}

pkg_config_file() {     # pkg_config_file NAME CFLAGS LIBS
  mkdir -p "$prefix/lib/pkgconfig"
  printf 'Name: %s\nDescription: %s\nVersion: 1\nCflags: %s\nLibs: -L%s %s\n' "$1" "$1" "$2" "$prefix/lib" "$3" \
    >"$prefix/lib/pkgconfig/$1.pc"
}

headers() {             # those that are headers only, with what CMake finds them by: Debian's packages, as everywhere else
  for header in CLI nlohmann kainjow eigen3 stb utf8 utf8.h utf8cpp; do
    [ ! -e "/usr/include/$header" ] || cp -r "/usr/include/$header" "$prefix/include"
  done
  mkdir -p "$prefix/share/eigen3" "$prefix/share/cmake"
  cp -r /usr/share/cmake/CLI11 /usr/share/cmake/nlohmann_json "$prefix/share/cmake"
  cp -r /usr/share/eigen3/cmake "$prefix/share/eigen3"
  for package in libcli11-dev nlohmann-json3-dev libkainjow-mustache-dev libeigen3-dev; do
    cp "/usr/share/doc/$package/copyright" "$licences/$package"
  done
}

defines=""

zlib() {
  debian_source zlib
  cd source
  CC=$zig_cc AR=$zig_ar RANLIB=$zig_ranlib CFLAGS="-O2 -fPIC -fvisibility=hidden" ./configure --static --prefix="$prefix"
  make -j"$(nproc)" install
  cp README "$licences/zlib"
}

libpng() {
  debian_source libpng1.6
  cd source
  autotools --host=x86_64-linux-gnu --prefix="$prefix" --disable-shared --enable-static --disable-tools
  compile install
  cp LICENSE "$licences/libpng"
}

pixman() {
  debian_source pixman
  cd source
  autotools --host=x86_64-linux-gnu --prefix="$prefix" --disable-shared --enable-static --disable-gtk --disable-libpng \
    --disable-openmp
  compile -C pixman install
  cp pixman-1.pc "$prefix/lib/pkgconfig"
  cp COPYING "$licences/pixman"
}

cairo() {       # PDF and SVG with cairo's own letters
  debian_source cairo
  cd source
  # The order of a number's bytes is looked for in an object file in a way that this linker's objects do not know.
  ax_cv_c_float_words_bigendian=no autotools --host=x86_64-linux-gnu --prefix="$prefix" --disable-shared --enable-static \
    --disable-xlib --disable-xcb --enable-png --disable-ft --disable-fc --disable-ps --enable-pdf --enable-svg \
    --disable-script --disable-interpreter --disable-gobject --disable-trace --disable-gtk-doc --disable-valgrind
  compile -C src install
  cp src/*.pc "$prefix/lib/pkgconfig"
  sed -i 's/^Requires.private:/Requires:/' "$prefix/lib/pkgconfig/cairo.pc"      # static: what it uses is linked, too
  cat COPYING COPYING-MPL-1.1 >"$licences/cairo"      # of LGPL 2.1 or MPL 1.1 the latter, as it is linked statically
}

gnuplot() {     # draws SVG; a program of its own
  debian_source gnuplot
  cd source
  mkdir -p src/beos
  touch src/beos/Makefile.in            # listed by configure, left out of Debian's source
  autotools --host=x86_64-linux-gnu --prefix=/usr --without-x --without-libcerf --without-latex --without-readline \
    --without-lua --without-cairo --without-gd --with-qt=no --disable-wxwidgets --without-tektronix --without-caca
  compile -C src gnuplot
  strip -o "$prefix/bin/gnuplot" src/gnuplot
  # Its licence asks for the changes to the released source beside the program.
  cat Copyright debian/patches/*.patch debian/patches/*.diff >"$licences/gnuplot" 2>/dev/null || cp Copyright "$licences/gnuplot"
}

ceres() {       # with Eigen alone: what it could do faster with SuiteSparse is not asked of it
  debian_source ceres-solver
  # Its small log says everything if it is let: errors only.
  build_cmake source -DMINIGLOG=ON -DMINIGLOG_MAX_LOG_LEVEL=-2 -DGFLAGS=OFF -DSUITESPARSE=OFF -DCXSPARSE=OFF -DLAPACK=OFF \
    -DEIGENSPARSE=ON -DSCHUR_SPECIALIZATIONS=OFF -DBUILD_TESTING=OFF -DBUILD_EXAMPLES=OFF -DBUILD_BENCHMARKS=OFF
  cp source/LICENSE "$licences/ceres-solver"
}

mbedtls() {     # SHA-256
  debian_source mbedtls
  build_cmake source -DENABLE_PROGRAMS=OFF -DENABLE_TESTING=OFF -DUSE_STATIC_MBEDTLS_LIBRARY=ON -DUSE_SHARED_MBEDTLS_LIBRARY=OFF \
    -DMBEDTLS_FATAL_WARNINGS=OFF
  cp source/LICENSE "$licences/mbedtls"
}

opencv() {      # the modules that the module and the tools use, and nothing that it would fetch or find on this machine
  mkdir -p source
  tar -xzf "$opencv_archive" -C source --strip-components=2 --wildcards '*/opencv/*'
  off=""
  for part in 1394 ADE AVIF FFMPEG FLATBUFFERS GSTREAMER GTK IPP ITT JASPER LAPACK OBSENSOR OPENCL OPENEXR OPENJPEG \
              PROTOBUF QUIRC UNIFONT V4L VULKAN WEBP EIGEN VA QT OPENGL; do
    off="$off -DWITH_$part=OFF"
  done
  build_cmake source $off -DBUILD_LIST=core,imgproc,imgcodecs,videoio,calib3d,features2d,flann,objdetect \
    -DBUILD_TESTS=OFF -DBUILD_PERF_TESTS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_opencv_apps=OFF -DBUILD_JAVA=OFF \
    -DBUILD_opencv_python3=OFF -DBUILD_JPEG=ON -DBUILD_TIFF=ON -DCPU_DISPATCH=AVX2 -DENABLE_PRECOMPILED_HEADERS=OFF
  cp source/LICENSE "$licences/opencv"
  for library in libjpeg-turbo libtiff; do
    cp source/3rdparty/$library/LICENSE.md "$licences/$library"
  done
  mkdir -p "$licences/opencv-3rdparty"          # what OpenCV's own install states for the code that it includes
  cp "$prefix"/share/licenses/opencv4/* "$licences/opencv-3rdparty"
}
