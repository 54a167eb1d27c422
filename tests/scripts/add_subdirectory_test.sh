#!/usr/bin/env bash
# Builds an example in a project that has the sources as a folder of its own.
# Argument: source folder.
set -euo pipefail

readonly source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$source/docs/examples/estimate_motion.cc" "$work"
printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(uses CXX)' \
  "add_subdirectory($source rgbd_pose)" \
  'add_executable(estimate_motion estimate_motion.cc)' \
  'target_link_libraries(estimate_motion PRIVATE rgbd_pose::costs)' \
  >"$work/CMakeLists.txt"
cmake -S "$work" -B "$work/build" -DCMAKE_BUILD_TYPE=Release
cmake --build "$work/build" --target estimate_motion --parallel "$(nproc)"
"$work/build/estimate_motion" | tee "$work/log"
grep -q '^ok' "$work/log"
