"""Cameras, frames, results and errors can be passed to and from processes."""

import copy
import multiprocessing
import pickle
import subprocess
import sys

import numpy as np
import pytest

import rgbd_pose
from conftest import motion, move, random_points


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def estimate():
    points = random_points(200)
    return rgbd_pose.estimate_motion(points, move(motion(), points))


def fail(count):
    rgbd_pose.estimate_motion(
        np.ones((count, 3)), np.ones((count, 3))
    ).raise_if_failed()


def test_cameras():
    camera = rgbd_pose.Camera(
        500, 501, 320, 240, distortion=(0.1, 0.2, 0.3, 0.4), color_readout=0.02
    )
    for same in (again(camera), copy.copy(camera), copy.deepcopy(camera)):
        assert repr(same) == repr(camera)


def test_frames_and_what_became_of_them(sequence, camera):
    frames = list(rgbd_pose.Recording(sequence))
    same = again(frames[3])
    assert same.index == 3 and same.timestamp == frames[3].timestamp
    assert np.array_equal(same.gray, frames[3].gray)
    assert np.array_equal(same.depth, frames[3].depth)
    for tracker in (rgbd_pose.Odometry(camera), rgbd_pose.Slam(camera)):
        for frame in frames:
            tracked = tracker.track(frame.gray, frame.depth, frame.timestamp)
        copied = again(tracked)
        assert type(copied) is type(tracked)
        assert repr(copied) == repr(tracked)
        assert np.array_equal(copied.world_from_cam, tracked.world_from_cam)
        assert np.array_equal(copied.covariance, tracked.covariance)
        assert len(copied.edges) == len(tracked.edges)
    tracker.finish()
    keyframe = tracker.keyframes()[0]
    assert np.array_equal(again(keyframe).map_from_cam, keyframe.map_from_cam)


def test_estimates():
    first = estimate()
    same = again(first)
    assert same.ok and repr(same) == repr(first)
    for name in ("cur_from_prev", "covariance", "weights", "inliers"):
        assert np.array_equal(getattr(same, name), getattr(first, name)), name


def test_summaries_of_solves():
    poses = np.tile(rgbd_pose.pose_block(np.eye(4)), (2, 1))
    poses[1, 4] = 0.5
    problem = rgbd_pose.Problem()
    factor = rgbd_pose.RelativePoseFactor(np.eye(4), np.eye(6))
    problem.add_residual_block(factor, None, list(poses))
    summary = rgbd_pose.solve(problem)
    for same in (again(summary), copy.copy(summary)):
        assert same.ok and repr(same) == repr(summary)
        assert same.solve_ms == summary.solve_ms
    problem.set_parameter_block_constant(poses[0])
    poses[1, 4] = 0.5
    unfinished = rgbd_pose.solve(problem, max_iterations=1)
    assert again(unfinished).reason == unfinished.reason != ""


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol(protocol):
    # In a process of its own, which protocols 0 and 1 might end.
    program = f"""
import pickle, rgbd_pose
camera = rgbd_pose.Camera(500, 500, 320, 240)
assert repr(pickle.loads(pickle.dumps(camera, {protocol}))) == repr(camera)
try:
    pickle.dumps(rgbd_pose.Problem(), {protocol})
except TypeError as error:
    print(error)
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout == "cannot pickle 'rgbd_pose.Problem' object\n"


def test_errors_of_trajectories():
    times = np.arange(5.0)
    poses = np.zeros((5, 7))
    poses[:, 6] = 1.0
    poses[:, 0] = times**2
    other = poses.copy()
    other[:, :3] *= 1.01
    ate = rgbd_pose.evaluate_ate((times, other), (times, poses))
    assert again(ate).rmse == ate.rmse > 0
    assert np.array_equal(again(ate).timestamps, ate.timestamps)
    rpe = rgbd_pose.evaluate_rpe((times, other), (times, poses))
    assert again(rpe).translation.rmse == rpe.translation.rmse


def test_reasons_come_out_of_a_process_pool():
    context = multiprocessing.get_context("spawn")
    with context.Pool(1) as pool:
        with pytest.raises(rgbd_pose.EstimateError, match="2 usable") as error:
            pool.apply(fail, (2,))
        assert error.value.estimate.status == "too_few_matches"
        with pytest.raises(rgbd_pose.InputError, match="no such"):
            pool.apply(rgbd_pose.Recording, ("/no/folder",))


def test_damaged_bytes_are_told():
    state = rgbd_pose.Camera(500, 500, 320, 240).__getstate__()
    camera = rgbd_pose.Camera.__new__(rgbd_pose.Camera)
    with pytest.raises(rgbd_pose.InputError, match="cut off"):
        camera.__setstate__((state[0], state[1][:50]))
    with pytest.raises(rgbd_pose.InputError, match="another version"):
        camera.__setstate__(("0.1", state[1]))
