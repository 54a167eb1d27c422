#!/usr/bin/env bash
# Every program has a manual page and completions that have all its flags and
# their names, as --help has them. Arguments: source and build folder.
set -euo pipefail
readonly source=$1 build=$2 share=$2/share

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# bash calls this to have files completed or no space added; here it only
# notes what was asked for.
asked=""
compopt() { asked=$*; }

# completes EXPECTED WORD...: what bash completes for the last word.
completes() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=() asked=""
  "_$1"
  [ "${COMPREPLY[*]}" = "$expected" ] ||
    fail "$*: completed to '${COMPREPLY[*]}' instead of '$expected'"
}

check_flag() {
  local program=$1 flag=$2 type=$3 names=$4
  [[ $manual == *"\\fB\\-\\-$flag=\\fR"* ||
    $manual == *"\\fB\\-\\-[no]$flag\\fR"* ]] || fail "$program.1: no --$flag"
  [[ $zsh =~ "'--$flag"=?"[" ]] || fail "_$program: no --$flag"
  [[ $all_flags =~ " --$flag"=?" " ]] ||
    fail "$program: bash does not complete --$flag"
  [[ -z $names || ($manual == *"Names: ${names// /, }."* &&
    $zsh == *"compadd -- $names ||"*) ]] ||
    fail "$program: not all names of --$flag"
  case $type in
    bool) completes "true false" "$program" "--$flag" = ;;
    string) completes "$names" "$program" "--$flag" = ;;
    *) completes "" "$program" "--$flag" = ;;
  esac
}

for file in "$source"/apps/rgbd_*.cc; do
  program=$(basename "$file" .cc)
  for page in "man/man1/$program.1" "zsh/site-functions/_$program" \
    "bash-completion/completions/$program"; do
    [ -s "$share/$page" ] || fail "no $page"
  done
  manual=$(<"$share/man/man1/$program.1")
  zsh=$(<"$share/zsh/site-functions/_$program")
  # shellcheck source=/dev/null
  . "$share/bash-completion/completions/$program"
  COMP_WORDS=("$program" word --) COMP_CWORD=2
  "_$program"
  all_flags=" ${COMPREPLY[*]} " flags=0
  while read -r flag type names; do
    check_flag "$program" "$flag" "$type" "$names"
    flags=$((flags + 1))
  done < <("$build/bin/$program" --help | awk '
    /^  --/ { if (flag) print flag, type, names
              flag = substr($1, 3); type = $2; gsub(/[(),]/, "", type)
              names = "" }
    /^      one of: / { names = substr($0, 15) }
    END { print flag, type, names }')
  [ "$flags" -ge 2 ] || fail "$program --help: only $flags flags"
  if command -v groff >/dev/null; then
    warnings=$(groff -man -ww -Tutf8 "$share/man/man1/$program.1" 2>&1 >/dev/null)
    [ -z "$warnings" ] || fail "$program.1: $warnings"
  fi
done

# What is typed by people.
completes "--camera=" rgbd_odometry --came
[ "$asked" = "-o nospace" ] || fail "a space after --camera="
completes "tum_fr1 tum_fr2 tum_fr3" rgbd_odometry --camera = tum
completes "kinect" rgbd_odometry --camera kin
completes "" rgbd_odometry --camera = my_camera.y
[ "$asked" = "-o default" ] || fail "no files for --camera="
completes "huber,tukey" rgbd_odometry --loss = huber,tu
completes "" rgbd_odometry --output = r
[ "$asked" = "-o default" ] || fail "no files for --output="
completes "" rgbd_odometry rgbd_data
[ "$asked" = "-o default" ] || fail "no files for the recording"
completes "" rgbd_odometry --threads = 1
[ -z "$asked" ] || fail "files for a number"
completes "--noreport" rgbd_odometry --norep
echo "ok"
