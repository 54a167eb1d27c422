#!/usr/bin/env bash
# reach_test.sh SOURCE: scripts/mutants covers every cost, factor and loss, and
# docs/Doxyfile every header that the examples include.
set -euo pipefail
cd "$1"
command -v python3 >/dev/null || {
  echo "skipped: needs python3"
  exit 77
}
status=0
missing() {
  echo "$*"
  status=1
}

mutants=$(scripts/mutants --list)
direct=$(sed -n 's/^#include "\(costs\/direct\/.*\)"/\1/p' costs/cost_list.h)
factors=$(sed -n 's/^#include "\(.*\/\(factors\|calibration\)\/.*\)"/\1/p' costs/factors/factor_list.cc |
  grep -v factor_list.h)
for file in costs/matches/*.h $direct $factors robust/losses.h; do
  grep -qF "$file:" <<<"$mutants" || missing "no mutant of $file"
done

input=$(sed -n '/^INPUT = /,/[^\\]$/p' docs/Doxyfile | tr -d '\\' | tr ' ' '\n' |
  grep '\.h$')
for file in $input; do
  [ -f "$file" ] || missing "docs/Doxyfile: there is no $file"
done
included=$(sed -n 's/^#include "rgbd_pose\/\(.*\)"/\1/p' docs/examples/*.cc docs/*.md)
for file in $(sort -u <<<"$included"); do
  grep -qxF "$file" <<<"$input" ||
    missing "docs/Doxyfile: $file is missing, which examples include"
done
exit $status
