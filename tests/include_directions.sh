#!/usr/bin/env bash
# include_directions.sh SOURCE: each folder includes what docs/architecture.md
# says it may, and no more.
set -euo pipefail
cd "$1"

# may FOLDER OWN THEIRS: the folders of the project and the libraries whose
# headers it may include (as regular expressions).
status=0
may() {
  local count
  count=$(find "$1" -name '*.h' -o -name '*.cc' | wc -l)
  if [ "$count" -lt 5 ]; then
    echo "$1: only $count sources; has it moved?"
    status=1
  fi
  # Standard headers have neither a folder nor an ending.
  if grep -rnE --include='*.h' --include='*.cc' '^ *# *include' "$1" |
    grep -vE "include (\"($2)/|<[a-z_0-9]+>|<($3))"; then
    echo "$1 must not include the above"
    status=1
  fi
}

may core 'core' 'Eigen/|ceres/'
may robust 'core|robust' 'ceres/'
may costs 'core|robust|costs' 'Eigen/|ceres/'
may frontend 'core|frontend' 'Eigen/|opencv2/|yaml-cpp/|libdeflate\.h'
exit $status
