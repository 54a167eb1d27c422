#!/usr/bin/env bash
# install_dependencies_test.sh SOURCE: each script requests exactly the packages
# that it needs from apt-get; nothing is installed here.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# A machine without any packages; requests to apt-get are written to log.
mkdir "$work/bin" "$work/scripts"
cp "$source/scripts/install_dependencies" "$work/scripts"
for program in dpkg-query npm sudo apt-get; do
  printf '#!/bin/sh\n' >"$work/bin/$program"
done
echo 'exec "$@"' >>"$work/bin/sudo"
# shellcheck disable=SC2016
echo 'echo "$@" >>"$LOG"' >>"$work/bin/apt-get"
chmod +x "$work"/bin/*
export LOG=$work/log

# asked_by SCRIPT: the packages that the script requests.
asked_by() {
  local groups
  groups=$(sed -n 's/^ *scripts\/install_dependencies //p' "$source/scripts/$1")
  [ -n "$groups" ] || fail "$1 installs nothing"
  : >"$LOG"
  # shellcheck disable=SC2086
  PATH=$work/bin:$PATH "$work/scripts/install_dependencies" $groups 2>/dev/null
  grep '^install' "$LOG" | tr ' ' '\n'
}

for script in demo frontends cost_accuracy benchmark test check coverage fuzz; do
  asked_by $script >"$work/asked"
  grep -qx libceres-dev "$work/asked" || fail "$script does without Ceres"
done
asked_by demo >"$work/asked"
! grep -E 'slurm|munge|colmap|rosbag|chromium|doxygen|pytest|gtest|benchmark|clang|pybind' \
  "$work/asked" || fail "the demo needs none of these"
grep -qx jq "$work/asked" || fail "the demo runs jq"
asked_by test | grep -qx slurmctld || fail "no Slurm for the tests"
asked_by check | grep -qx librosbag-storage-dev || fail "bags go unchecked"
[ "$(asked_by api_docs | grep -cv '^-\|^install$')" -eq 5 ] ||
  fail "api_docs needs five packages"

! "$work/scripts/install_dependencies" furniture 2>"$LOG" ||
  fail "took an unknown group"
grep -q "unknown group 'furniture'; available: build, run, test" "$LOG" ||
  fail "does not say which groups there are"
! "$work/scripts/install_dependencies" 2>"$LOG" || fail "took no group"
echo "ok"
