"""Tracking with an inertial sensor, compared with the program."""

import numpy as np
import pytest

import rgbd_pose
from conftest import run_program


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data") / "shaken"
    run_program(
        "rgbd_simulate", "--path=handheld", "--frames=45", "--imu",
        "--imu_gyro_bias=0.01", f"--output={folder}",
    )
    return folder


@pytest.mark.parametrize("name", ["Odometry", "Slam"])
def test_tracks_with_a_gyroscope_as_the_program_does(name, shaken, tmp_path):
    for flags, folder in (((), "with"), (("--imu=none",), "without")):
        run_program(
            f"rgbd_{name.lower()}", f"--dataset={shaken}", "--threads=1",
            f"--output={tmp_path}/{folder}", "--noreport", *flags,
        )
    recording = rgbd_pose.Recording(shaken)
    tracker = getattr(rgbd_pose, name)(recording.camera)
    calibration = recording.imu_calibration()
    tracker.use_imu(calibration["cam_from_imu"], calibration["delay"])
    tracker.add_imu(recording.imu())
    for frame in recording:
        tracker.track(
            frame.gray, frame.depth, frame.timestamp,
            depth_delay=frame.depth_delay,
        )
    if name == "Slam":
        tracker.finish()
    tracker.save_trajectory(tmp_path / "trajectory.txt")
    path = (tmp_path / "trajectory.txt").read_bytes()
    assert path == (tmp_path / "with/trajectory.txt").read_bytes()
    assert path != (tmp_path / "without/trajectory.txt").read_bytes()


def test_refuses_what_it_cannot_use(shaken):
    recording = rgbd_pose.Recording(shaken)
    odometry = rgbd_pose.Odometry(recording.camera)
    with pytest.raises(rgbd_pose.InputError, match="cam_from_imu"):
        odometry.use_imu(np.eye(3))
    with pytest.raises(rgbd_pose.InputError, match="samples"):
        odometry.add_imu(np.zeros((5, 6)))
    with pytest.raises(rgbd_pose.InputError, match="add_imu: call use_imu"):
        odometry.add_imu(recording.imu())
    frame = next(iter(recording))
    odometry.track(frame.gray, frame.depth, frame.timestamp)
    with pytest.raises(rgbd_pose.InputError, match="before the first frame"):
        odometry.use_imu(np.eye(4))
