"""Shared by tests: random matches, a sequence and the programs' results."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import rgbd_pose


def run_program(name, *flags):
    program = pathlib.Path(os.environ["RGBD_POSE_BIN"]) / name
    return subprocess.run(
        [str(program), *flags], check=True, capture_output=True, text=True
    ).stdout


@pytest.fixture(scope="session")
def sequence(tmp_path_factory):
    """Folder of a sequence of 8 frames, with inertial samples, in TUM layout."""
    folder = tmp_path_factory.mktemp("data") / "sequence"
    run_program(
        "rgbd_simulate", "--path=xyz", "--frames=8", "--imu",
        f"--output={folder}",
    )
    return folder


@pytest.fixture(scope="session")
def camera(sequence):
    return rgbd_pose.Camera.load(sequence / "camera.yaml")


def track_all(tracker, frames):
    return [tracker.track(f.gray, f.depth, f.timestamp) for f in frames]


def rotation(axis, angle):
    """(3, 3) by Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def rigid(axis, angle, translation):
    """(4, 4)."""
    result = np.eye(4)
    result[:3, :3] = rotation(axis, angle)
    result[:3, 3] = translation
    return result


# Of the factors that measure a motion, and a direction in the axes of a camera.
MOTION_COVARIANCE = np.diag([1e-4, 1e-4, 2e-4, 1e-6, 1e-6, 4e-6])
DOWN = np.array([0.0, 1.0, 0.0])
# Without a lens.
KINECT = rgbd_pose.Camera(525.0, 525.0, 319.5, 239.5)


def motion():
    """(4, 4) cur_from_prev: 5 degrees and about 10 cm."""
    return rigid([1.0, -2.0, 0.5], np.radians(5.0), [0.05, -0.04, 0.07])


def move(cur_from_prev, points):
    return points @ cur_from_prev[:3, :3].T + cur_from_prev[:3, 3]


def random_points(count, seed=1):
    """(count, 3) in view of a Kinect, 1-4 m away."""
    rng = np.random.default_rng(seed)
    rays = rng.uniform([-0.5, -0.4, 1.0], [0.5, 0.4, 1.0], (count, 3))
    return rays * rng.uniform(1.0, 4.0, (count, 1))


def add_kinect_noise(points, rng, camera):
    """Noise of the estimator's default model."""
    z = points[:, 2]
    pixels = points[:, :2] / z[:, None] * [camera.fx, camera.fy]
    pixels += rng.normal(0.0, 0.5, pixels.shape)
    depth = z + rng.normal(0.0, 1.425e-3 * z**2)
    rays = pixels / [camera.fx, camera.fy]
    return np.column_stack([rays * depth[:, None], depth])


def raises_one_line(pattern):
    """InputError of a single line that matches from its start to its end."""
    return pytest.raises(rgbd_pose.InputError, match=f"^{pattern}$")
