"""Preintegrated inertial samples and what their factors find."""

import numpy as np
import pytest

import rgbd_pose
from conftest import rotation

GRAVITY = np.array([0.0, 0.0, -9.81])
NOISE = {"gyro": 3e-4, "accel": 2e-3, "gyro_walk": 2e-5, "accel_walk": 3e-4}

# A sensor that turns at a constant rate about an axis of its own and moves along
# sines of time in the world.
RATE = np.array([0.4, -0.9, 0.6])  # rad/s
SIZE = np.array([0.3, 0.2, 0.25])  # m
OMEGA = np.array([4.0, 5.0, 3.0])  # rad/s
PHASE = np.array([0.2, 1.5, 0.8])


def world_from_sensor(t):
    pose = np.eye(4)
    pose[:3, :3] = rotation([1.0, 2.0, -0.5], 0.8) @ rotation(
        RATE, np.linalg.norm(RATE) * t
    )
    pose[:3, 3] = SIZE * np.sin(OMEGA * t + PHASE)
    return pose


def velocity(t):
    return SIZE * OMEGA * np.cos(OMEGA * t + PHASE)


def acceleration(t):
    return -SIZE * OMEGA**2 * np.sin(OMEGA * t + PHASE)


def samples(hertz, seconds, bias=np.zeros(6), begin=0.0):
    """(N, 7) without noise, a little longer than asked for."""
    stamps = begin + np.arange(-1, int(seconds * hertz) + 2) / hertz
    forces = [
        world_from_sensor(t)[:3, :3].T @ (acceleration(t) - GRAVITY)
        for t in stamps
    ]
    return np.column_stack([stamps, RATE + bias[:3] + 0.0 * stamps[:, None],
                            forces + bias[3:]])


def sampling_error(hertz, seconds):
    """Largest error of an acceleration's integral (m/s) that is linear between
    samples: h^2 / 12 of the second derivative, and at both ends, which may lie
    between samples, h^2 / 8 for the time h."""
    h, w = 1.0 / hertz, np.linalg.norm(RATE)
    second = np.linalg.norm(SIZE * OMEGA**4)  # along the axes of the world
    turning = (second + 2.0 * w * np.linalg.norm(SIZE * OMEGA**3)
               + w**2 * (np.linalg.norm(SIZE * OMEGA**2) + 9.81))
    return h**2 * (second * seconds / 12.0 + 2.0 * turning * h / 8.0)


def predict(motion, pose, v):
    """The pose and the velocity at the end."""
    t, R = motion.seconds, pose[:3, :3]
    end = pose.copy()
    end[:3, :3] = R @ motion.start_from_end
    end[:3, 3] += v * t + GRAVITY * t**2 / 2.0 + R @ motion.position
    return end, v + GRAVITY * t + R @ motion.velocity


@pytest.mark.parametrize("hertz", [100, 200, 400])
@pytest.mark.parametrize("start, end", [(0.0, 1.0), (0.1234, 0.7071)])
def test_an_exact_motion_is_predicted(hertz, start, end):
    bias = np.array([0.02, -0.03, 0.01, 0.1, 0.2, -0.15])
    motion = rgbd_pose.Preintegration(
        samples(hertz, 1.0, bias), start, end, bias
    )
    assert motion.seconds == pytest.approx(end - start, abs=1e-12)
    np.testing.assert_array_equal(motion.bias, bias)
    pose, v = predict(motion, world_from_sensor(start), velocity(start))
    truth = world_from_sensor(end)
    # A constant rate is integrated exactly.
    np.testing.assert_allclose(pose[:3, :3], truth[:3, :3], atol=1e-12)
    tolerance = sampling_error(hertz, end - start)
    assert tolerance < 20.0 / hertz**2
    assert np.linalg.norm(v - velocity(end)) < tolerance
    error = np.linalg.norm(pose[:3, 3] - truth[:3, 3])
    assert error < tolerance * (end - start)
    factor = rgbd_pose.InertialFactor(motion, GRAVITY)
    ends = [(world_from_sensor(t), velocity(t)) for t in (start, end)]
    residuals, _ = factor.evaluate([
        block for p, v in ends for block in (rgbd_pose.pose_block(p), v, bias)
    ])
    assert np.abs(residuals).max() < 1.0  # sigmas
    assert repr(motion).startswith(f"Preintegration({end - start:.6g} s: ")


def test_noise_and_derivatives_by_the_bias():
    noise = {"gyro": 1e-3, "accel": 1e-2, "gyro_walk": 1e-3, "accel_walk": 1e-2}
    seconds, rows = 0.5, samples(200, 0.5)
    motion = rgbd_pose.Preintegration(rows, 0.0, seconds, **noise)
    sigma = np.sqrt(np.diag(motion.covariance))
    # White noise, and the walk of the bias summed up, of a rotation.
    omega = 1e-3 * np.sqrt(seconds + seconds**3 / 3.0)
    np.testing.assert_allclose(sigma[:3], omega, rtol=0.01)
    np.testing.assert_allclose(sigma[9:12], 1e-3 * np.sqrt(seconds))
    np.testing.assert_allclose(sigma[12:], 1e-2 * np.sqrt(seconds))
    for array in (motion.covariance, motion.velocity, motion.start_from_end):
        assert not array.flags.writeable
    for k, d in enumerate(1e-5 * np.eye(6)):
        more = rgbd_pose.Preintegration(rows, 0.0, seconds, d)
        turn = motion.start_from_end.T @ more.start_from_end
        change = np.concatenate([
            [turn[2, 1], turn[0, 2], turn[1, 0]],
            more.velocity - motion.velocity, more.position - motion.position,
        ])
        np.testing.assert_allclose(change / 1e-5, motion.by_bias[:, k], atol=1e-4)


def test_other_samples_of_a_recording_do_not_matter():
    rows = samples(200, 4.0)
    part = rows[(rows[:, 0] > 0.98) & (rows[:, 0] < 1.52)]
    for start, end in [(1.0, 1.5), (1.001, 1.499)]:
        whole = rgbd_pose.Preintegration(rows, start, end)
        alone = rgbd_pose.Preintegration(part, start, end)
        np.testing.assert_array_equal(whole.position, alone.position)
        np.testing.assert_array_equal(whole.covariance, alone.covariance)
    # Exactly the samples of the interval.
    exact = rgbd_pose.Preintegration(rows[1:], rows[1, 0], rows[-1, 0])
    assert exact.seconds == pytest.approx(rows[-1, 0] - rows[1, 0])


def test_a_path_and_its_biases_are_found():
    bias = np.array([0.015, -0.02, 0.01, 0.1, -0.15, 0.08])
    stamps = 0.5 * np.arange(11)
    truth = [world_from_sensor(t) for t in stamps]
    rows = samples(400, stamps[-1], bias)
    rng = np.random.default_rng(1)

    poses = np.array([rgbd_pose.pose_block(pose) for pose in truth])
    for pose, exact in zip(poses[1:], truth[1:]):
        off = np.eye(4)
        off[:3, :3] = rotation(rng.normal(size=3), 0.1)
        off[:3, 3] = rng.normal(0.0, 0.1, 3)
        pose[:] = rgbd_pose.pose_block(exact @ off)
    velocities = np.zeros((len(stamps), 3))
    biases = np.zeros((len(stamps), 6))
    for _ in range(2):  # again at the biases that were found
        problem = rgbd_pose.Problem()
        for i in range(len(stamps) - 1):
            motion = rgbd_pose.Preintegration(
                rows, stamps[i], stamps[i + 1], biases[i], **NOISE
            )
            problem.add_residual_block(
                rgbd_pose.InertialFactor(motion, GRAVITY), None,
                [poses[i], velocities[i], biases[i],
                 poses[i + 1], velocities[i + 1], biases[i + 1]],
            )
        for i in range(0, len(stamps), 2):
            problem.add_residual_block(
                rgbd_pose.AbsolutePositionFactor(
                    truth[i][:3, 3], 1e-6 * np.eye(3)
                ),
                None, [poses[i]],
            )
        problem.set_parameter_block_constant(poses[0])
        assert rgbd_pose.solve(problem).ok

    # Samples are linear in between, which is the only error.
    tolerance = sampling_error(400, 0.5)  # m/s in an interval
    for i in range(len(stamps)):
        found = rgbd_pose.pose_matrix(poses[i])
        np.testing.assert_allclose(found, truth[i], atol=tolerance)
        np.testing.assert_allclose(
            velocities[i], velocity(stamps[i]), atol=tolerance
        )
    np.testing.assert_allclose(biases[:, :3], bias[:3] + 0.0 * biases[:, :3],
                               atol=tolerance)
    # An acceleration is the change of a velocity in half a second.
    np.testing.assert_allclose(biases[:, 3:], bias[3:] + 0.0 * biases[:, 3:],
                               atol=tolerance / 0.5)


def test_known_poses_tell_the_bias_of_a_gyroscope():
    bias = np.array([0.015, -0.02, 0.01])
    rows = samples(200, 2.0, np.concatenate([bias, np.zeros(3)]))
    rows[:, 4:] = 0.0  # there is no accelerometer
    stamps = 0.5 * np.arange(5)
    poses = [rgbd_pose.pose_block(world_from_sensor(t)) for t in stamps]
    found = np.zeros(3)
    for tolerance in (1e-4, 1e-9):  # corrected to first order, then again
        at = np.concatenate([found, np.zeros(3)])
        problem = rgbd_pose.Problem()
        for i in range(4):
            motion = rgbd_pose.Preintegration(rows, stamps[i], stamps[i + 1], at)
            problem.add_residual_block(
                rgbd_pose.GyroscopeFactor(motion), None,
                [poses[i], poses[i + 1], found],
            )
        for pose in poses:
            problem.set_parameter_block_constant(pose)
        assert rgbd_pose.solve(problem).ok
        np.testing.assert_allclose(found, bias, atol=tolerance)
    sigma = np.sqrt(np.diag(problem.covariance([found])))
    # The noise over all of the time; its axes turn by 0.6 rad in an interval.
    np.testing.assert_allclose(sigma, 3e-4 / np.sqrt(2.0), rtol=0.02)


ROWS = samples(100, 1.0)
MOTION = rgbd_pose.Preintegration(ROWS, 0.0, 1.0)


def with_number(row, column, value):
    rows = ROWS.copy()
    rows[row, column] = value
    return rows


@pytest.mark.parametrize("make, message", [
    (lambda: rgbd_pose.Preintegration(ROWS, 0.5, 1.5),
     "inertial samples from -0.010000 s to 1.010000 s do not cover 0.500000 s "
     "to 1.500000 s"),
    (lambda: rgbd_pose.Preintegration(ROWS[:0], 0.0, 1.0),
     "there are no inertial samples"),
    (lambda: rgbd_pose.Preintegration(ROWS, 0.5, np.nan),
     "an inertial interval from 0.500000 s to nan s has no length"),
    (lambda: rgbd_pose.Preintegration(
        np.delete(ROWS, range(50, 60), axis=0), 0.0, 1.0),
     "no inertial sample for 0.110 s after 0.480000 s, the longest gap allowed "
     "is 0.05 s"),
    (lambda: rgbd_pose.Preintegration(ROWS, 0.0, 1.0, max_gap=0.0),
     "the longest gap between inertial samples must be above 0 s, not 0"),
    (lambda: rgbd_pose.Preintegration(ROWS[::-1], 0.0, 1.0),
     r"samples\[1\]: its stamp is not finite or not after the previous one; .*"),
    (lambda: rgbd_pose.Preintegration(with_number(70, 0, np.nan), 0.0, 0.5),
     r"samples\[70\]: its stamp is not finite or .*"),
    (lambda: rgbd_pose.Preintegration(with_number(7, 2, np.inf), 0.0, 1.0),
     "the inertial sample at 0.060000 s is not finite"),
    (lambda: rgbd_pose.Preintegration(ROWS[:, :4], 0.0, 1.0),
     r"samples: has shape \(103, 4\); it needs \(N, 7\)"),
    (lambda: rgbd_pose.Preintegration(ROWS, 0.0, 1.0, np.zeros(3)),
     r"bias: has shape \(3,\); it needs \(6,\)"),
    (lambda: rgbd_pose.Preintegration(ROWS, 0.0, 1.0, np.full(6, np.nan)),
     "bias: is not finite"),
    (lambda: rgbd_pose.Preintegration(ROWS, 0.0, 1.0, gyro=0.0),
     "densities and random walks of an inertial sensor must be above 0, not 0"),
    (lambda: rgbd_pose.InertialFactor(MOTION, [0.0, 0.0, np.nan]),
     "gravity: is not finite"),
    (lambda: rgbd_pose.GyroscopeFactor(MOTION).evaluate([np.zeros(7)]),
     r"evaluate: the factor is over 3 blocks \(pose, pose, bias\), not 1"),
    (lambda: rgbd_pose.Problem().add_residual_block(
        rgbd_pose.InertialFactor(MOTION, GRAVITY), None, [
            np.zeros(n) for n in (7, 6, 6, 7, 6, 6)]),
     r"blocks\[1\]: has shape \(6,\); a velocity needs \(3,\)"),
])
def test_what_cannot_be_used_is_refused(make, message):
    with pytest.raises(rgbd_pose.InputError, match=f"^{message}$"):
        make()


def test_a_factor_needs_a_motion():
    for motion in (None, ROWS):
        with pytest.raises(TypeError, match="Preintegration"):
            rgbd_pose.GyroscopeFactor(motion)
