#!/usr/bin/env bash
# api_docs_test.sh SOURCE: runs scripts/api_docs in a copy, which is removed.
set -euo pipefail
for program in doxygen dot; do
  command -v $program >/dev/null || {
    echo "skipped: needs $program"
    exit 77
  }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$1"/{core,robust,costs,frontend,apps,docs,scripts} "$folder"
"$folder/scripts/api_docs"
[ -s "$folder/build/api/html/classrgbd__pose_1_1Estimator.html" ] || {
  echo "no page of class Estimator"
  exit 1
}

# A gap (an undocumented class) is found.
comment='// What all frontends share.'
grep -qxF "$comment" "$folder/frontend/features/frontend.h"
sed -i "\\|^$comment\$|d" "$folder/frontend/features/frontend.h"
if "$folder/scripts/api_docs" >"$folder/log" 2>&1; then
  echo "a class without a comment went unnoticed"
  exit 1
fi
grep -q 'Compound rgbd_pose::FrontendOptions is not documented' "$folder/log"
