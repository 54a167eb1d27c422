#!/usr/bin/env bash
# api_docs_test.sh SOURCE: runs scripts/api_docs in a copy, which is removed.
set -euo pipefail
for package in doxygen graphviz python3-sphinx python3-myst-parser \
  python3-sphinx-rtd-theme; do
  dpkg-query -W "$package" >/dev/null 2>&1 || {
    echo "skipped: needs $package"
    exit 77
  }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$1"/{core,robust,costs,frontend,apps,docs,scripts} "$1"/*.md \
  "$1/CITATION.cff" "$folder"
cd "$folder"
scripts/api_docs

# fails_with LINE...: scripts/api_docs fails and prints these.
fails_with() {
  local line
  if scripts/api_docs >log 2>&1; then
    echo "went unnoticed: $*"
    exit 1
  fi
  for line in "$@"; do
    grep -qF -- "$line" log || {
      echo "went unnoticed: $line"
      exit 1
    }
  done
}

for page in *.md $(find docs -name '*.md') index api/index \
  api/classrgbd__pose_1_1Estimator; do
  [ -s "build/site/${page%.md}.html" ] || {
    echo "no page of $page"
    exit 1
  }
done
grep -q 'url=../api/index.html' build/site/docs/api.html
if grep -rE '<(script|link|img)[^>]*(src|href)="(https?:)?//' build/site; then
  echo "the site needs a network"
  exit 1
fi

# Dead links are found.
cp docs/faq.md faq
cat >>docs/faq.md <<'END'
[a](no_page.md) [b](no_file.cc) [c](runs.md#no_heading) [d](#not_here)
![e](no_image.png)
END
fails_with no_page.md no_file.cc no_heading not_here no_image.png
mv faq docs/faq.md

# A gap (an undocumented class) is found.
comment='// What all frontends share.'
grep -qxF "$comment" frontend/features/frontend.h
sed -i "\\|^$comment\$|d" frontend/features/frontend.h
fails_with 'Compound rgbd_pose::FrontendOptions is not documented'
