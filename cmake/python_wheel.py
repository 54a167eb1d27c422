"""Builds the Python package for `pip install .` (PEP 517) by CMake, with
only Python's standard library, since pip may be offline.

RGBD_POSE_BUILD_DIR names an existing build folder to use; the default is
build-python.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

SOURCES = pathlib.Path(__file__).resolve().parent.parent


def version():
    text = (SOURCES / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(rgbd_pose VERSION ([\d.]+)", text).group(1)


def configure(folder):
    """Runs CMake. Of a failure only what it says of errors is told."""
    if shutil.which("cmake") is None:
        sys.exit("rgbd_pose: cmake is missing (docs/python.md)")
    run = subprocess.run(
        ["cmake", "-S", str(SOURCES), "-B", folder]
        + ["-DCMAKE_BUILD_TYPE=Release", "-DRGBD_POSE_BUILD_TESTS=OFF"]
        + ["-DRGBD_POSE_BUILD_BENCHMARKS=OFF"]
        + ["-DRGBD_POSE_BUILD_PYTHON=ON", "-DRGBD_POSE_WHEEL=ON"]
        + [f"-DPython_EXECUTABLE={sys.executable}"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if run.returncode == 0:
        return
    # The place of an error, then its text, indented.
    errors = re.findall(r"^CMake Error at .*\n((?:  .*\n|\n)*)", run.stdout, re.M)
    lines = [" ".join(error.split()) for error in errors]
    sys.exit("\n".join(lines) or run.stdout)


def numpy_needed(folder):
    """The requirement of the wheel: NumPy 2 needs a module by pybind11 2.12."""
    cache = pathlib.Path(folder, "CMakeCache.txt").read_text(encoding="utf-8")
    where = re.search(r"^pybind11_DIR:\w+=(.*)", cache, re.M)[1]
    text = pathlib.Path(where, "pybind11ConfigVersion.cmake").read_text("utf-8")
    found = re.search(r'PACKAGE_VERSION "(\d+)\.(\d+)', text).groups()
    return "numpy" if tuple(map(int, found)) >= (2, 12) else "numpy<2"


def build_folder():
    """The configured build folder."""
    folder = os.environ.get("RGBD_POSE_BUILD_DIR")
    if not folder:
        folder = str(SOURCES / "build-python")
        configure(folder)
    return folder


def build_package(folder, prefix):
    """Builds the module; returns the folder of the package below prefix."""
    jobs = str(os.cpu_count() or 1)
    subprocess.run(
        ["cmake", "--build", folder, "--target", "_rgbd_pose", "-j", jobs],
        check=True,
    )
    subprocess.run(
        ["cmake", "--install", folder, "--component", "python"]
        + ["--prefix", prefix],
        check=True,
    )
    return next(pathlib.Path(prefix).rglob("rgbd_pose/__init__.py")).parent


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    tag = f"{python}-{python}-{platform}"
    info = f"rgbd_pose-{version()}.dist-info"
    folder = build_folder()
    with tempfile.TemporaryDirectory() as prefix:
        files = {
            f"rgbd_pose/{path.name}": path.read_bytes()
            for path in sorted(build_package(folder, prefix).iterdir())
            if path.is_file()
        }
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: rgbd_pose\nVersion: {version()}\n"
        f"Requires-Python: >=3.8\nRequires-Dist: {numpy_needed(folder)}\n"
    ).encode()
    files[f"{info}/WHEEL"] = (
        "Wheel-Version: 1.0\nGenerator: rgbd_pose\n"
        f"Root-Is-Purelib: false\nTag: {tag}\n"
    ).encode()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest())
        record += f"{name},sha256={digest.decode().rstrip('=')},{len(content)}\n"
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = f"rgbd_pose-{version()}-{tag}.whl"
    with zipfile.ZipFile(
        pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED
    ) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return wheel
