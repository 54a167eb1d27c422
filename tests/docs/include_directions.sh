#!/usr/bin/env bash
# include_directions.sh SOURCE: each room (folder) includes only itself and the
# rooms that docs/where_things_go.md lists above it, and no file includes itself
# through others.
set -euo pipefail
cd "$1"
status=0
above=()  # the rooms checked before

# room FOLDER OURS THEIRS: its sources may include rooms above it that match
# OURS and library headers that match THEIRS (regular expressions).
room() {
  local files ours
  files=$(find "$1" -maxdepth 1 -name '*.h' -o -maxdepth 1 -name '*.cc')
  if [ -z "$files" ]; then
    echo "$1: no sources; has it moved?"
    status=1
    return
  fi
  above+=("$1")
  ours=$(printf '%s\n' "${above[@]}" | grep -E "^($2)" | paste -sd'|')
  # Standard headers have neither a folder nor an extension.
  # shellcheck disable=SC2086
  if grep -nE '^ *# *include' $files /dev/null |
    grep -vE "include (\"($ours|$1)/[a-z_0-9]+\.h\"|<[a-z_0-9]+>|<($3))"; then
    echo "$1 must not include the above"
    status=1
  fi
}

room core/util core 'Eigen/|ceres/|fcntl.h|sys/|unistd.h'
room core/geometry core 'Eigen/'
room core/estimation core 'Eigen/|ceres/'
room core/evaluation core 'Eigen/'
room core/inertial core 'Eigen/|ceres/'
room core/factors core 'Eigen/|ceres/'
room core/pose_graph core 'Eigen/|ceres/'
room core/initial_guess core 'Eigen/'
room robust 'core/|robust' 'ceres/'
room costs/parts 'core/|costs/' 'Eigen/'
room costs/matches 'core/|costs/' 'Eigen/'
room costs/assembly 'core/|costs/' 'Eigen/|ceres/'
room costs/direct 'core/|costs/' 'Eigen/'
room costs 'core/|costs|robust' 'Eigen/|ceres/'
# The type of the cost list is needed here.
room costs/calibration 'core/|costs' 'Eigen/|ceres/'
room costs/factors 'core/|costs' 'Eigen/|ceres/'
opencv='Eigen/|opencv2/'
room frontend/frame 'core/|frontend/' "$opencv"
room frontend/files 'core/|frontend/' "$opencv|yaml-cpp/|libdeflate\.h|spng\.h|turbojpeg\.h|Imf[A-Za-z]+\.h"
room frontend/bags 'core/|frontend/' "$opencv|sqlite3\.h|zstd\.h|lz4frame\.h|bzlib\.h|libdeflate\.h"
room frontend/sources 'core/|frontend/' "$opencv|OpenNI\.h"
room frontend/features 'core/|frontend/' "$opencv"
room frontend/places 'core/|frontend/' "$opencv"
room frontend/tracking 'core/|frontend/' "$opencv"
room frontend/settings 'core/|robust|costs|frontend/' 'none'
room frontend/slam 'core/|robust|costs|frontend/' "$opencv|ceres/|fcntl.h|unistd.h|sys/file.h"
room frontend/calibration 'core/|costs|frontend/' 'Eigen/'
room frontend/fusion 'core/|frontend/' "$opencv"
room frontend/simulation 'core/|frontend/' "$opencv"
programs='core/|robust|costs|frontend/|apps/'
libraries="$opencv|ceres/|nlohmann/|glog/|gflags/|sys/|sched.h|unistd.h|fcntl.h|glob.h|link.h"
room apps/shell 'core/|apps/' "$libraries"
room apps/results "$programs" "$libraries"
room apps/compare "$programs" "$libraries"
room apps/batch "$programs" "$libraries"
room apps/jacobians "$programs" "$libraries"
room apps/report "$programs" "$libraries"
room apps/view "$programs" "$libraries|httplib\.h"
room apps/export "$programs" "$libraries"
room apps/run "$programs" "$libraries"
room apps/python "$programs" "$libraries|pybind11/|Python.h|cxxabi.h"

# Finds include cycles, also within a room.
circles=$(grep -roE --include='*.h' '^#include "[^"]+"' core robust costs \
  frontend apps | sed 's/:#include "/ /; s/"$//' | tsort 2>&1 >/dev/null || true)
if [ -n "$circles" ]; then
  echo "$circles"
  echo "headers include each other in a circle"
  status=1
fi
exit $status
