#!/usr/bin/env bash
# determinism_test.sh RGBD_SIMULATE RGBD_ODOMETRY...: each of the given
# programs, with one thread and with two, twice each, writes the same bytes for
# the same 60 frames, except for timing columns.
set -euo pipefail
simulate=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$simulate" --path=xyz --frames=60 --output=sequence >/dev/null
frames=$(grep -vc '^#' sequence/rgb.txt)
[ "$frames" -ge 60 ] || { echo "only $frames frames" >&2; exit 1; }

# Removes the last six columns of frames.csv, which are times (_ms).
results() {
  sha256sum <"$1/trajectory.txt"
  sha256sum <"$1/errors.csv"
  sha256sum <"$1/cloud.ply"
  head -1 "$1/frames.csv" | grep -q 'qw,decode_ms' || echo "other columns"
  sed -E 's/(,[^,]*){6}$//' "$1/frames.csv" | sha256sum
}

for odometry in "$@"; do
  for threads in 1 2; do
    for try in 1 2; do
      "$odometry" --dataset=sequence --camera=sequence/camera.yaml \
        --output=run --threads="$threads" --save_cloud=run/cloud.ply \
        --noreport >/dev/null
      results run >this
      [ -f first ] || cp this first
      if ! cmp -s first this; then
        echo "other bytes: $odometry --threads=$threads, try $try" >&2
        diff first this >&2 || true
        exit 1
      fi
      rm -r run
    done
  done
done
echo "$frames frames, $# program(s), 1 and 2 threads, twice: same bytes"
