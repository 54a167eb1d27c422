#!/usr/bin/env bash
# without_simulator_test.sh FOLDER LIBRARY...: of the programs there, only those
# that simulate hold the simulator or load its library; no LIBRARY does.
set -euo pipefail

simulates() {
  { nm -C "$1" && ldd "$1" || true; } 2>/dev/null |
    grep -E 'rgbd_pose::Synthetic|rgbd_pose_simulation' >/dev/null
}

status=0
simulates "$1/rgbd_simulate" || {
  echo "rgbd_simulate holds no simulator; is it looked for by its old name?"
  status=1
}
for file in "$1"/rgbd_{odometry,evaluate,batch,report} "${@:2}"; do
  if simulates "$file"; then
    echo "$file holds the simulator"
    status=1
  fi
done
exit $status
