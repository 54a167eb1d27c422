#!/usr/bin/env bash
# without_simulator_test.sh FOLDER LIBRARY...: only programs that simulate
# contain or load the simulator, and none of the libraries does.
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
