#!/bin/sh
# `pip wheel .`, without the network: its one file can be installed in a fresh
# virtual environment, where the module can be imported, has its stubs, and can
# be removed.
# usage: pip_test.sh PYTHON SOURCE_FOLDER [BUILD_FOLDER]
# Without BUILD_FOLDER everything is compiled, in a copy of the sources.
set -eu
python=$1 sources=$2 build=${3-}
unset PYTHONPATH
if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
  echo "skipped: needs python3-venv"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if [ -n "$build" ]; then
  export RGBD_POSE_BUILD_DIR="$build"
else
  unset RGBD_POSE_BUILD_DIR
  mkdir "$folder/sources"
  tar -C "$sources" --exclude='./build*' --exclude=./.git -c . |
    tar -C "$folder/sources" -x
  sources=$folder/sources
fi
# What is missing is said in one line.
mkdir "$folder/bin"
cat >"$folder/bin/cmake" <<END
#!/bin/sh
exec $(command -v cmake) -DCMAKE_DISABLE_FIND_PACKAGE_pybind11=TRUE "\$@"
END
chmod +x "$folder/bin/cmake"
if PATH="$folder/bin:$PATH" "$python" -B -c '
import sys

sys.path.insert(0, sys.argv[1])
import python_wheel

python_wheel.configure(sys.argv[2])' "$sources/cmake" "$folder/configured" \
  >"$folder/said" 2>&1; then
  echo "is configured without pybind11"
  exit 1
fi
if [ "$(wc -l <"$folder/said")" -ne 1 ] ||
  ! grep -q 'apt-get install pybind11-dev' "$folder/said"; then
  cat "$folder/said"
  exit 1
fi
# Builds where nothing is installed, not even numpy.
"$python" -m venv "$folder/builder"
"$folder/builder/bin/python" -m pip --disable-pip-version-check wheel \
  --no-index --no-deps --quiet --wheel-dir "$folder/wheels" "$sources"
if [ "$(ls "$folder/wheels" | wc -l)" -ne 1 ]; then
  ls "$folder/wheels"
  exit 1
fi
rm -rf "$folder/builder"
# Uses the distribution's numpy.
"$python" -m venv --system-site-packages "$folder/venv"
pip="$folder/venv/bin/python -m pip --disable-pip-version-check"
$pip install --no-index --quiet "$folder"/wheels/rgbd_pose-*.whl
cd "$folder"
venv/bin/python - <<'END'
import pathlib
import sys

import rgbd_pose

folder = pathlib.Path(rgbd_pose.__file__).parent
assert str(folder).startswith(sys.prefix), folder
assert (folder / "py.typed").exists() and (folder / "__init__.pyi").exists()
assert "tum_fr1" in rgbd_pose.camera_presets()
points = [[0, 0, 2], [1, 0, 3], [0, 1, 2], [1, 1, 4]] * 20
assert rgbd_pose.estimate_motion(points, points).ok
END
$pip show rgbd_pose | grep -q '^Version: [0-9]'
$pip uninstall --yes --quiet rgbd_pose
if venv/bin/python -c 'import rgbd_pose' 2>/dev/null; then
  echo "is still there after pip uninstall"
  exit 1
fi
