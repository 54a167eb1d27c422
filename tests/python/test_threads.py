"""The GIL is released while the library works."""

import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import rgbd_pose
from conftest import motion, move, random_points


class Counter(threading.Thread):
    """Counts whenever it gets the GIL."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count = 0
        self.stopped = False

    def run(self):
        while not self.stopped:
            self.count += 1
            time.sleep(0)  # releases the GIL


@pytest.fixture
def counter():
    """A thread that gets the GIL only when it is released voluntarily."""
    interval = sys.getswitchinterval()
    thread = Counter()
    thread.start()
    while thread.count == 0:
        time.sleep(0.001)
    sys.setswitchinterval(1000.0)
    yield thread
    sys.setswitchinterval(interval)
    thread.stopped = True
    thread.join()


def advances(counter, function):
    """Whether the counter moves during any of a hundred calls."""
    for _ in range(100):
        before = counter.count
        function()
        if counter.count > before:
            return True
    return False


def test_the_counter_waits_for_python_code(counter):
    assert not advances(counter, lambda: sum(range(10000)))


def test_estimate_motion_releases_it(counter):
    prev = random_points(50000)
    cur = move(motion(), prev)
    assert advances(counter, lambda: rgbd_pose.estimate_motion(prev, cur))


def test_reading_and_tracking_release_it(counter, sequence, camera):
    recording = rgbd_pose.Recording(sequence, camera)
    assert advances(counter, lambda: recording[0])
    frame = recording[0]
    odometry = rgbd_pose.Odometry(camera)
    assert advances(counter, lambda: odometry.track(frame.gray, frame.depth))
    slam = rgbd_pose.Slam(camera)
    assert advances(counter, lambda: slam.track(frame.gray, frame.depth))


def test_problems_release_it(counter):
    prev = random_points(50000)
    cur = move(motion(), prev)
    assert advances(counter, lambda: rgbd_pose.PairFactor(prev, cur))
    poses = np.tile(rgbd_pose.pose_block(np.eye(4)), (2, 1))
    problem = rgbd_pose.Problem()
    problem.add_residual_block(
        rgbd_pose.PairFactor(prev, cur), None, list(poses)
    )
    problem.set_parameter_block_constant(poses[0])
    assert advances(counter, lambda: rgbd_pose.solve(problem, max_iterations=2))
    assert advances(counter, lambda: problem.covariance(list(poses)))
    samples = np.zeros((20000, 7))
    samples[:, 0] = 0.01 * np.arange(20000)
    assert advances(
        counter, lambda: rgbd_pose.Preintegration(samples, 0.0, 199.0)
    )


def test_many_threads_get_the_same(counter):
    prev = random_points(5000)
    cur = move(motion(), prev)
    expected = rgbd_pose.estimate_motion(prev, cur).cur_from_prev
    results = [None] * 4

    def work(i):
        results[i] = rgbd_pose.estimate_motion(prev, cur).cur_from_prev

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        np.testing.assert_array_equal(result, expected)


def test_calls_of_one_odometry_wait_for_each_other(sequence, camera):
    frame = rgbd_pose.Recording(sequence, camera)[0]
    odometry = rgbd_pose.Odometry(camera)
    frames = []

    def work():
        for _ in range(5):
            frames.append(odometry.track(frame.gray, frame.depth))
            assert len(odometry.trajectory[0]) > 0

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(f.index for f in frames) == list(range(20))
    # But for the first one, all show the frame before again.
    assert sorted(f.status for f in frames) == ["degraded"] * 19 + ["ok"]


def test_threads_share_a_loop_over_a_recording(sequence):
    errors = []

    def work(frames, seen):
        try:
            seen.extend(frame.index for frame in frames)
        except BaseException as error:
            errors.append(error)

    for _ in range(5):
        frames = iter(rgbd_pose.Recording(sequence))
        seen = []
        threads = [
            threading.Thread(target=work, args=(frames, seen)) for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not errors
        assert sorted(seen) == list(range(8))
        assert next(frames, None) is None


def test_daemon_threads_do_not_abort_the_end():
    # Python terminates threads that request the GIL after Python's end.
    program = """
import threading, time, numpy as np, rgbd_pose
points = np.random.default_rng(1).random((1000, 3)) + [0, 0, 2]
def run():
    while True:
        rgbd_pose.estimate_motion(points, points)
for _ in range(3):
    threading.Thread(target=run, daemon=True).start()
time.sleep(0.3)
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, timeout=60
    )
    assert ended.returncode == 0, ended.stderr
