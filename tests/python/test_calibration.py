"""calibrate() finds the errors of a camera from a recording."""

import shutil
import subprocess
import sys

import pytest

import rgbd_pose
from conftest import run_program


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calibration") / "room"
    run_program(
        "rgbd_simulate", "--path=handheld", "--frames=40", f"--output={folder}"
    )
    return folder


@pytest.fixture(scope="module")
def wrong(recording):
    """The recording's camera with a focal length that is 2 % too large."""
    text = (recording / "camera.yaml").read_text()
    path = recording.parent / "wrong.yaml"
    path.write_text(text.replace("525", "535.5"))
    return path


@pytest.fixture(scope="module")
def calibration(recording, wrong):
    return rgbd_pose.calibrate(
        recording, wrong, groundtruth="none", max_views=5000
    )


def test_finds_what_is_wrong(calibration):
    assert calibration.accepted, calibration.reason
    assert calibration.camera.fx == pytest.approx(525, abs=1.5)
    fx = calibration.parameters["fx"]
    assert fx.status == "determined"
    assert fx.before == 535.5 and fx.found == calibration.camera.fx
    assert 0 < fx.sigma < 2
    assert calibration.parameters["depth_factor"].status == "fixed"
    assert "the new camera is better" in calibration.summary
    assert repr(calibration) == "Calibration(accepted)"
    assert repr(fx) == (
        f"CalibratedParameter(determined: 535.5 to {fx.found:.6g} "
        f"+- {fx.sigma:.2g})"
    )


def test_keeps_what_is_fixed(recording, wrong):
    fixed = rgbd_pose.calibrate(
        recording, wrong, groundtruth="none", fix="focal", max_views=1000
    )
    assert fixed.parameters["fx"].status == "fixed"
    assert fixed.camera.fx == 535.5


def test_files_are_read_again(calibration, tmp_path):
    calibration.save_camera(tmp_path / "camera.yaml")
    camera = rgbd_pose.Camera.load(tmp_path / "camera.yaml")
    assert camera.fx == pytest.approx(calibration.camera.fx)
    calibration.save_depth_noise(tmp_path / "noise.yaml")
    a, b = calibration.depth_noise
    assert a + b == pytest.approx(1.65e-3, rel=0.2)
    rgbd_pose.Odometry(camera, depth_noise=str(tmp_path / "noise.yaml"))
    with pytest.raises(rgbd_pose.InputError, match="no such file"):
        rgbd_pose.Odometry(camera, depth_noise=str(tmp_path / "none.yaml"))


def test_says_what_makes_no_sense(recording):
    with pytest.raises(rgbd_pose.InputError, match="size"):
        rgbd_pose.calibrate(recording, fix="size")
    with pytest.raises(rgbd_pose.InputError):
        rgbd_pose.calibrate(recording / "nothing")
    with pytest.raises(rgbd_pose.InputError, match="max_passes"):
        rgbd_pose.calibrate(recording, max_passes=0)


def test_warns_of_what_is_left_out(recording, tmp_path):
    damaged = tmp_path / "room"
    shutil.copytree(recording, damaged)
    for image in sorted((damaged / "rgb").iterdir())[5:8]:
        image.write_bytes(b"")
    with pytest.warns(UserWarning) as said:
        rgbd_pose.calibrate(damaged, groundtruth="none", max_views=1000)
    said = [str(warning.message) for warning in said]
    assert sum("is empty; copy it again" in line for line in said) == 4
    assert said[-1].startswith("stopped early (3 of 8 frames cannot be read")


def test_an_interrupt_ends_it(recording):
    # SIGINT, as sent by Ctrl-C in a terminal. Times are processor times.
    program = f"""
import os, signal, threading, time, rgbd_pose
def calibrate():
    begun = time.process_time()
    try:
        rgbd_pose.calibrate({str(recording)!r}, max_views=1000)
    except KeyboardInterrupt:
        print("interrupted")
    return time.process_time() - begun
whole = calibrate()
threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
print("early" if calibrate() < 0.5 * whole else "late")
"""
    said = subprocess.run(
        [sys.executable, "-c", program],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    assert said.split() == ["interrupted", "early"]
