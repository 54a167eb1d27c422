#!/usr/bin/env bash
# with_python3.sh SCRIPT...: runs it, or reports that the test is skipped.
command -v python3 >/dev/null || {
  echo "skipped: needs python3"
  exit 77
}
exec python3 -B "$@"
