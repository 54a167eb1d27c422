#!/usr/bin/env bash
# Installs a build, moves the result and uses it there as a user would, with
# find_package and pkg-config. Arguments: source and build folder.
set -euo pipefail

readonly source=$1 build=$2
command -v pkg-config >/dev/null || {
  echo "skipped: needs pkg-config"
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
readonly work prefix=$work/prefix

fail() {
  echo "FAILED: $*" >&2
  cat "$work/log" >&2
  exit 1
}

# says PATTERN WHAT: checks the output of the last command.
says() { grep -Eq -- "$1" "$work/log" || fail "$2 does not say '$1'"; }

# configure FOLDER ARGUMENT...: configures a project that uses the installation.
configure() {
  local folder=$1
  shift
  cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" "$@" \
    >"$work/log" 2>&1
}

# project NAME LANGUAGE FIND_PACKAGE_ARGUMENT...: only calls find_package.
project() {
  local folder=$work/$1 language=$2
  shift 2
  mkdir "$folder"
  printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' \
    "project(finds $language)" "find_package(rgbd_pose $*)" \
    >"$folder/CMakeLists.txt"
}

cmake --install "$build" --prefix "$work/first" >"$work/log" 2>&1 ||
  fail "cmake --install"
mv "$work/first" "$prefix"
! grep -rlF -e "$source/" -e "$build/" "$prefix" >"$work/log" ||
  fail "these files tell where they were built"
[ "$(ls -m "$prefix/include/rgbd_pose")" = "core, costs, frontend, robust" ] ||
  fail "a user's program needs headers of these rooms only"
! grep -rnE '#include "' "$prefix/include" | grep -v 'include "rgbd_pose/' \
  >"$work/log" || fail "these includes lack rgbd_pose/"

# Every link of a page leads to an installed file.
docs=$(dirname "$(find "$prefix" -path '*/doc/*/README.md' | grep -v /docs/)")
while IFS= read -r page; do
  # shellcheck disable=SC2016
  sed '/^```/,/^```/d' "$page" | { grep -oE '\]\([^)# ]+' || true; } | cut -c3- |
    while IFS= read -r link; do
      [[ $link == http* || -e "$(dirname "$page")/$link" ]] ||
        echo "$page: nothing at $link"
    done
done < <(find "$docs" -name '*.md') >"$work/log"
[ ! -s "$work/log" ] || fail "dead links"
[ -s "$docs/docs/README.md" ] || fail "no index of pages"

# The examples, outside of the source tree.
cp -r "$source/docs/examples" "$work/examples"
configure "$work/examples" || fail "examples: find_package"
# Other tests build and run inertial_path and wheel_scale; five_frames and
# camera_loop are built below, in other ways.
cmake --build "$work/examples/build" --parallel 2 --target estimate_motion \
  own_cost own_problem own_loss own_frontend map_loop calibrate_camera \
  find_places >"$work/log" 2>&1 || fail "examples: build"
check() {
  (cd "$work" && "$1") >"$work/log" 2>&1 || fail "$1"
  says "$2" "$1"
}
readonly examples=$work/examples/build
check "$examples/estimate_motion" '^ok, 160 of 200 matches .* 0\.000 mm$'
check "$examples/own_cost" '^error 0\.[0-9]+ mm$'
says '^back at the start within 0\.[0-9]+ mm$' own_cost
check "$examples/own_problem" '^solved, a quarter is 90\.00 degrees$'
check "$examples/own_loss" '^error 0\.[0-9]+ mm$'
check "$examples/own_frontend" '^error 0\.00[0-9]+ m$'
check "$examples/map_loop" '^[1-9][0-9]* keyframes, .* within 0\.[0-9]+ mm$'
check "$examples/calibrate_camera" '^fx 535\.5 -> 52[45]\.[0-9] .* better$'
check "$examples/find_places" '^28 shows what 0 shows, from 0\.0[0-9] m away$'

# A component only needs its own dependencies.
project costs CXX REQUIRED COMPONENTS costs
cp "$source/docs/examples/five_frames.cc" "$work/costs"
printf '%s\n' 'add_executable(five_frames five_frames.cc)' \
  'target_link_libraries(five_frames PRIVATE rgbd_pose::costs)' \
  >>"$work/costs/CMakeLists.txt"
configure "$work/costs" -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=TRUE \
  -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=TRUE ||
  fail "costs: find_package without OpenCV"
cmake --build "$work/costs/build" >"$work/log" 2>&1 || fail "costs: build"
check "$work/costs/build/five_frames" \
  '^solved, the last frame is 0\.[0-9]+ mm off, sigma 0\.'
! ldd "$work/costs/build/five_frames" | grep -iE 'opencv|yaml' >"$work/log" ||
  fail "costs: links what only the frontend needs"

# Unknown components and versions are refused with a message.
project lidar NONE REQUIRED COMPONENTS core lidar
! configure "$work/lidar" || fail "took an unknown component"
says "unknown component 'lidar'; available: core, robust, costs, frontend," lidar
project newer NONE 0.99 REQUIRED
! configure "$work/newer" || fail "took another version"
says 'compatible with requested version "0.99"' newer

# With pkg-config: what all headers include is installed, and a program. That
# headers compile alone is tested where they are built.
export PKG_CONFIG_PATH
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name rgbd_pose.pc)")
read -ra flags < <(pkg-config --cflags rgbd_pose)
read -ra libraries < <(pkg-config --libs rgbd_pose_simulation)
[[ " $(pkg-config --libs rgbd_pose) " != *simulation* ]] ||
  fail "rgbd_pose.pc links the simulator"
(cd "$prefix/include/rgbd_pose" && find . -name '*.h' |
  sed 's|^\./\(.*\)|#include "rgbd_pose/\1"|') >"$work/all.cc"
[ "$(wc -l <"$work/all.cc")" -gt 100 ] || fail "headers are missing"
"${CXX:-c++}" -std=c++17 -E "${flags[@]}" "$work/all.cc" -o /dev/null \
  >"$work/log" 2>&1 || fail "headers include what is not installed"
"${CXX:-c++}" -std=c++17 "$source/docs/examples/camera_loop.cc" \
  "${flags[@]}" "${libraries[@]}" -Wl,-rpath,"${PKG_CONFIG_PATH%/*}" \
  -o "$work/camera_loop" >"$work/log" 2>&1 || fail "pkg-config: build"
check "$work/camera_loop" '^back at the start within 0\.[0-9]+ mm$'

# Flags that change Eigen's alignment are refused, as they lead to crashes.
avx() {
  "${CXX:-c++}" -std=c++17 -O2 -mavx2 "$@" \
    "$source/docs/examples/estimate_motion.cc" "${flags[@]}" "${libraries[@]}" \
    -Wl,-rpath,"${PKG_CONFIG_PATH%/*}" -o "$work/avx" >"$work/log" 2>&1
}
if [ "$(uname -m)" = x86_64 ]; then
  ! avx || fail "took another alignment of Eigen's vectors"
  says "leave out -march=native, .* -DEIGEN_MAX_ALIGN_BYTES=16" alignment
  avx -DEIGEN_MAX_ALIGN_BYTES=16 || fail "alignment of 16 bytes: build"
  ! grep -q avx2 /proc/cpuinfo || check "$work/avx" '^ok'
fi
echo "ok"
