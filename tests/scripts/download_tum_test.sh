#!/usr/bin/env bash
# Tests scripts/download_tum with a local server. The argument is the script.
set -euo pipefail

command -v curl >/dev/null && command -v python3 >/dev/null || {
  echo "skipped: needs curl and python3"
  exit 77
}
readonly script=$1
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf "$work"' EXIT

fail() {
  echo "FAILED: $*" >&2
  cat "$work/err" >&2
  exit 1
}

# run EXIT_CODE NAME: checks the exit code, and that failures print one line.
run() {
  local code=0
  "$script" "$2" "$work/to" >"$work/out" 2>"$work/err" || code=$?
  [ "$code" -eq "$1" ] || fail "$2: exit code $code instead of $1"
  [ "$1" -eq 0 ] || [ "$(wc -l <"$work/err")" -eq 1 ] ||
    fail "$2: not one line"
}

says() { grep -q -- "$1" "$work/err" || fail "does not say '$1'"; }

make_archive() {
  local sequence=rgbd_dataset_$1 files=$work/www/${1%%_*}
  mkdir -p "$files" "$work/$sequence"
  head -c 300000 /dev/urandom >"$work/$sequence/depth.bin"
  tar -czf "$files/$sequence.tgz" -C "$work" "$sequence"
}

for name in freiburg1_xyz freiburg1_desk freiburg1_rpy freiburg1_room; do
  make_archive $name
done
truncate -s 200000 "$work/www/freiburg1/rgbd_dataset_freiburg1_room.tgz"

# Supports ranges, logs what it sends; reports a wrong size of freiburg1_rpy.
cat >"$work/server.py" <<'END'
import http.server, os, sys

class Handler(http.server.BaseHTTPRequestHandler):
    def answer(self, with_body):
        path = sys.argv[1] + self.path
        if not os.path.exists(path):
            return self.send_error(404)
        data = open(path, 'rb').read()
        asked = self.headers.get('Range')
        start = int(asked[6:].split('-')[0]) if asked else 0
        size = len(data) - start
        if 'rpy' in path and not with_body:
            size += 7
        self.send_response(206 if asked else 200)
        if asked:
            self.send_header('Content-Range', 'bytes %d-%d/%d' %
                             (start, len(data) - 1, len(data)))
        self.send_header('Content-Length', str(size))
        self.end_headers()
        if with_body:
            self.wfile.write(data[start:])
            open(sys.argv[1] + '/log', 'a').write('%d\n' % size)

    def do_HEAD(self):
        self.answer(False)

    def do_GET(self):
        self.answer(True)

    def log_message(self, *arguments):
        pass

server = http.server.HTTPServer(('127.0.0.1', 0), Handler)
print(server.server_port, flush=True)
server.serve_forever()
END
python3 "$work/server.py" "$work/www" >"$work/port" &
server=$!
for _ in $(seq 100); do
  [ ! -s "$work/port" ] || break
  sleep 0.1
done
export RGBD_POSE_TUM_URL=http://127.0.0.1:$(cat "$work/port")
export no_proxy=127.0.0.1

# A complete download; nothing else is left behind.
run 0 freiburg1_xyz
cmp "$work/"{,to/}rgbd_dataset_freiburg1_xyz/depth.bin || fail "other bytes"
[ "$(ls "$work/to")" = rgbd_dataset_freiburg1_xyz ] || fail "left something"

# A second call has nothing to do.
lines=$(wc -l <"$work/www/log")
run 0 freiburg1_xyz
[ "$(wc -l <"$work/www/log")" -eq "$lines" ] || fail "fetched again"

# An interrupted download continues where it stopped.
archive=rgbd_dataset_freiburg1_desk.tgz
head -c 100000 "$work/www/freiburg1/$archive" >"$work/to/$archive.partial"
run 0 freiburg1_desk
cmp "$work/"{,to/}rgbd_dataset_freiburg1_desk/depth.bin || fail "other bytes"
rest=$(($(stat -c %s "$work/www/freiburg1/$archive") - 100000))
[ "$(tail -1 "$work/www/log")" -eq "$rest" ] || fail "did not resume"

run 3 freiburg1_rpy # wrong size
says "delete it"
run 3 freiburg1_room # damaged
says "is damaged"
run 3 freiburg1_360 # not on the server
says "cannot be reached"
run 2 freiburg9_moon
says "freiburg1_xyz"
[ "$(ls -d "$work/to"/*/ | wc -l)" -eq 2 ] || fail "unpacked a bad archive"

# No server.
kill "$server"
wait "$server" 2>/dev/null || true
server=
run 3 freiburg1_teddy
says "check the network"
echo passed
