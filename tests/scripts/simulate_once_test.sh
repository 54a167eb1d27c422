#!/usr/bin/env bash
# simulate_once_test.sh SOURCE: a simulation that was stopped is repeated, one
# that is complete is not.
set -euo pipefail
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "FAILED: $*"
  exit 1
}

# In place of rgbd_simulate: it keeps its frames also where it is stopped.
cat >"$folder/program" <<'END'
#!/bin/sh
for word; do
  case $word in
    --frames=*) frames=${word#*=} ;;
    --output=*) output=${word#*=} ;;
  esac
done
[ ! -e "$output" ] || exit 2
mkdir "$output" && echo "$frames" >"$output/frames"
exit "$STATUS"
END
chmod +x "$folder/program"
simulate() { # STATUS FRAMES
  STATUS=$1 "$source/scripts/simulate_once" "$folder/program" "$folder/xyz" \
    "--frames=$2"
}

for stopped in 6 6; do
  simulate $stopped 1 && fail "a stopped simulation is reported as complete"
  [ ! -d "$folder/xyz" ] || fail "some of the frames are taken for all"
done
simulate 0 3
[ "$(cat "$folder/xyz/frames")" = 3 ] || fail "it was not repeated"
simulate 0 4
[ "$(cat "$folder/xyz/frames")" = 3 ] || fail "a complete one was repeated"
for script in accuracy demo endurance frontends; do
  grep -q simulate_once "$source/scripts/$script" ||
    fail "scripts/$script renders by itself"
done
echo ok
