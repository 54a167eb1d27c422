"""What each factor measures, alone and as all matches of a pair of frames."""

import numpy as np
import pytest

import rgbd_pose
from conftest import (
    DOWN, KINECT, MOTION_COVARIANCE,
    add_kinect_noise, motion, move, raises_one_line, random_points, rigid,
    rotation,
)


@pytest.mark.parametrize("cost", ["bidirectional_point", "point_to_point"])
@pytest.mark.parametrize("loss", ["none", "huber", "tukey"])
def test_a_pair_moves_as_estimate_motion_does(cost, loss):
    rng = np.random.default_rng(3)
    points = random_points(300)
    ref = add_kinect_noise(points, rng, KINECT)
    cur = add_kinect_noise(move(motion(), points), rng, KINECT)
    if loss != "none":
        cur[:30] = random_points(30, seed=5)
    # So near that the estimator chooses its weights there, and never again.
    guess = motion() @ rigid([1.0, 1.0, 0.0], 0.004, [0.002, 0.0, -0.002])
    estimate = rgbd_pose.estimate_motion(
        ref, cur, KINECT, cost=cost, loss=loss, initial_guess=guess,
        robust_schedule="direct",
    )
    factor = rgbd_pose.PairFactor(
        ref, cur, KINECT, cost=cost, loss=loss, initial_guess=guess
    )
    poses = np.array([rgbd_pose.pose_block(np.eye(4)),
                      rgbd_pose.pose_block(np.linalg.inv(guess))])
    problem = rgbd_pose.Problem()
    problem.add_residual_block(factor, None, list(poses))
    problem.set_parameter_block_constant(poses[0])
    summary = rgbd_pose.solve(problem)
    assert summary.ok
    found = np.linalg.inv(rgbd_pose.pose_matrix(poses[1]))
    # The estimator ends where a step changes the cost by less than 1e-9 of it:
    # within about 1e-3 standard deviations.
    np.testing.assert_allclose(found, estimate.cur_from_prev, atol=5e-6)
    np.testing.assert_allclose(
        summary.final_cost, estimate.final_cost, rtol=1e-6
    )


def test_a_mounting_is_a_constant_or_a_block():
    body_from_cam = rigid([1.0, 0.2, 0.1], 0.3, [0.1, -0.2, 0.05])
    bodies = [np.eye(4)] + [
        rigid(axis, 0.3, axis) for axis in np.eye(3)[[0, 1, 2]]
    ]
    cams = [body @ body_from_cam for body in bodies]
    points = random_points(100)

    def solved(mounting, blocks, **arguments):
        poses = np.array([rgbd_pose.pose_block(body) for body in bodies])
        poses[1:, 4:] += 0.02
        problem = rgbd_pose.Problem()
        for i in range(3):
            problem.add_residual_block(
                rgbd_pose.PairFactor(
                    points, move(np.linalg.inv(cams[i + 1]) @ cams[0], points),
                    KINECT, loss="none", mounting=mounting, **arguments,
                ),
                None, [poses[0], poses[i + 1], *blocks],
            )
            # Otherwise the bodies may move with their cameras.
            problem.add_residual_block(
                rgbd_pose.AbsolutePoseFactor(bodies[i + 1], 1e-8 * np.eye(6)),
                None, [poses[i + 1]],
            )
        problem.set_parameter_block_constant(poses[0])
        assert rgbd_pose.solve(problem).ok
        return poses

    expected = np.array([rgbd_pose.pose_block(body) for body in bodies])
    found = solved("constant", [], body_from_ref_cam=body_from_cam,
                   body_from_cur_cam=body_from_cam)
    np.testing.assert_allclose(found, expected, atol=1e-7)
    mounting = rgbd_pose.pose_block(np.eye(4))
    found = solved("shared", [mounting])
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(
        rgbd_pose.pose_matrix(mounting), body_from_cam, atol=1e-6
    )
    each = [rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(np.eye(4))]
    solved("each", each)
    for mounting in each:
        np.testing.assert_allclose(
            rgbd_pose.pose_matrix(mounting), body_from_cam, atol=1e-6
        )


def test_cameras_of_a_pair_may_be_mounted_in_different_ways():
    body_from_ref_cam = rigid([1.0, 0.2, 0.1], 0.3, [0.1, -0.2, 0.05])
    body_from_cur_cam = rigid([0.0, 0.2, 1.0], 0.2, [-0.1, 0.1, 0.0])
    bodies = [np.eye(4), rigid([0.0, 1.0, 0.0], 0.2, [0.1, 0.0, 0.2])]
    cur_from_ref = (np.linalg.inv(bodies[1] @ body_from_cur_cam)
                    @ bodies[0] @ body_from_ref_cam)
    points = random_points(20)
    pair = rgbd_pose.PairFactor(
        points, move(cur_from_ref, points), KINECT,
        body_from_ref_cam=body_from_ref_cam,
        body_from_cur_cam=body_from_cur_cam,
    )
    residuals, _ = pair.evaluate([rgbd_pose.pose_block(body) for body in bodies])
    np.testing.assert_allclose(residuals, 0.0, atol=1e-9)


def test_pixels_and_points_give_the_same_pair():
    points = random_points(50)
    moved = move(motion(), points)
    pixels = [
        np.column_stack([525.0 * p[:, :2] / p[:, 2:] + [319.5, 239.5], p[:, 2]])
        for p in (points, moved)
    ]
    by_points = rgbd_pose.PairFactor(points, moved, KINECT, loss="none")
    by_pixels = rgbd_pose.PairFactor.from_pixels(*pixels, KINECT, loss="none")
    blocks = [rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(np.eye(4))]
    for a, b in zip(by_points.evaluate(blocks)[1], by_pixels.evaluate(blocks)[1]):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6 * np.abs(b).max())


def test_weights_are_those_of_the_association():
    points = random_points(50)
    moved = move(motion(), points)
    arguments = {"cost": "bidirectional_image", "loss": "none"}
    pair = rgbd_pose.PairFactor(points, moved, KINECT, **arguments)
    near = rgbd_pose.PairFactor(
        points, moved, KINECT, initial_guess=motion(), **arguments
    )
    blocks = [rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(np.eye(4))]
    assert (pair.evaluate(blocks)[0] != near.evaluate(blocks)[0]).any()
    pair.associate(motion())
    assert (pair.evaluate(blocks)[0] == near.evaluate(blocks)[0]).all()


# Every factor but PairFactor at a state without an error: its blocks, and the
# same blocks moved, where its residual is not 0.


BODY = rigid([0.3, -0.5, 1.0], 0.7, [0.4, -0.2, 1.0])
OTHER = rigid([1.0, 0.2, 0.1], 0.4, [1.0, 0.5, -0.3])
POINT = np.array([0.3, 0.1, 2.0])  # in the axes of BODY
IN_WORLD = BODY[:3, :3] @ POINT + BODY[:3, 3]
OTHER_FROM_BODY = np.linalg.inv(OTHER) @ BODY
IN_OTHER = OTHER_FROM_BODY[:3, :3] @ POINT + OTHER_FROM_BODY[:3, 3]
TWIST = np.array([0.1, -0.2, 0.3, 0.5, 0.2, -0.1])
SECONDS = 0.5


def coasted():
    """BODY after SECONDS with TWIST, and the twist in its axes there."""
    later = BODY.copy()
    turn = rotation(TWIST[:3], SECONDS * np.linalg.norm(TWIST[:3]))
    later[:3, 3] += BODY[:3, :3] @ TWIST[3:] * SECONDS
    later[:3, :3] = BODY[:3, :3] @ turn
    return later, np.concatenate([TWIST[:3], turn.T @ TWIST[3:]])


GRAVITY = 9.81 * DOWN
STAMPS = np.linspace(0.0, SECONDS, 51)
MEASURED = rgbd_pose.Preintegration(
    np.column_stack([STAMPS, np.sin(np.outer(STAMPS, np.arange(1.0, 7.0)))]),
    0.0, SECONDS, 0.01 * np.arange(6.0),
)


def measured():
    """BODY, a velocity and MEASURED.bias, and what they were after SECONDS."""
    later, R, v = BODY.copy(), BODY[:3, :3], TWIST[3:]
    later[:3, :3] = R @ MEASURED.start_from_end
    later[:3, 3] += (v * SECONDS + GRAVITY * SECONDS**2 / 2.0
                     + R @ MEASURED.position)
    return [rgbd_pose.pose_block(BODY), v.copy(), MEASURED.bias.copy(),
            rgbd_pose.pose_block(later),
            v + GRAVITY * SECONDS + R @ MEASURED.velocity, MEASURED.bias.copy()]


EXACT = {
    "AbsolutePoseFactor": (
        lambda: rgbd_pose.AbsolutePoseFactor(BODY, MOTION_COVARIANCE),
        lambda: [rgbd_pose.pose_block(BODY)]),
    "AbsolutePositionFactor": (
        lambda: rgbd_pose.AbsolutePositionFactor(
            IN_WORLD, 1e-4 * np.eye(3), POINT),
        lambda: [rgbd_pose.pose_block(BODY)]),
    "RelativePoseFactor": (
        lambda: rgbd_pose.RelativePoseFactor(
            OTHER_FROM_BODY, MOTION_COVARIANCE),
        lambda: [rgbd_pose.pose_block(BODY), rgbd_pose.pose_block(OTHER)]),
    "RelativeRotationFactor": (
        lambda: rgbd_pose.RelativeRotationFactor(
            OTHER_FROM_BODY[:3, :3], 1e-4 * np.eye(3)),
        lambda: [rgbd_pose.pose_block(BODY), rgbd_pose.pose_block(OTHER)]),
    "GravityFactor": (
        lambda: rgbd_pose.GravityFactor(BODY[:3, :3].T @ DOWN, 9.81 * DOWN),
        lambda: [rgbd_pose.pose_block(BODY)]),
    "CommonDirectionFactor": (
        lambda: rgbd_pose.CommonDirectionFactor(
            BODY[:3, :3].T @ DOWN, 2.0 * OTHER[:3, :3].T @ DOWN),
        lambda: [rgbd_pose.pose_block(BODY), rgbd_pose.pose_block(OTHER)]),
    "ConstantVelocityFactor": (
        lambda: rgbd_pose.ConstantVelocityFactor(SECONDS),
        lambda: [rgbd_pose.pose_block(BODY), TWIST.copy(),
                 rgbd_pose.pose_block(coasted()[0]), coasted()[1]]),
    "DistanceFactor": (
        lambda: rgbd_pose.DistanceFactor(
            np.linalg.norm(IN_WORLD - OTHER[:3, 3]), 0.01, in_a=POINT),
        lambda: [rgbd_pose.pose_block(BODY), rgbd_pose.pose_block(OTHER)]),
    "MapPlaneFactor": (
        lambda: rgbd_pose.MapPlaneFactor(POINT, DOWN, DOWN @ IN_WORLD),
        lambda: [rgbd_pose.pose_block(BODY)]),
    "LandmarkFactor": (
        lambda: rgbd_pose.LandmarkFactor(
            KINECT, POINT[:2] / POINT[2],
            525.0 * IN_OTHER[:2] / IN_OTHER[2] + [319.5, 239.5]),
        lambda: [rgbd_pose.pose_block(BODY), rgbd_pose.pose_block(OTHER),
                 np.array([0.5])]),
    "InertialFactor": (
        lambda: rgbd_pose.InertialFactor(MEASURED, GRAVITY), measured),
    "GyroscopeFactor": (
        lambda: rgbd_pose.GyroscopeFactor(MEASURED),
        lambda: [measured()[0], measured()[3], MEASURED.bias[:3].copy()]),
}


def test_all_factors_are_tested():
    kinds = {
        name for name in rgbd_pose.__all__
        if name.endswith("Factor") and name not in ("Factor", "PairFactor")
    }
    assert kinds == set(EXACT)


@pytest.mark.parametrize("name", EXACT)
def test_each_factor_measures_what_it_says(name):
    make_factor, make_blocks = EXACT[name]
    factor, blocks = make_factor(), make_blocks()
    residuals, jacobians = factor.evaluate(blocks)
    np.testing.assert_allclose(residuals, 0.0, atol=1e-9)
    assert [J.shape for J in jacobians] == [
        (len(residuals), 6 if b.size == 7 else b.size) for b in blocks
    ]
    assert repr(factor).startswith(f"{name}(pose")
    # A twist of 1e-7 in each direction changes residuals as derivatives say.
    for block, J in zip(blocks, jacobians):
        for k in range(J.shape[1]):
            before = block.copy()
            d = 1e-7 * np.eye(J.shape[1])[k]
            if block.size == 7:
                matrix = rgbd_pose.pose_matrix(block).copy()
                if k < 3:
                    matrix[:3, :3] = matrix[:3, :3] @ rotation(d[:3], 1e-7)
                matrix[:3, 3] += d[3:]
                block[:] = rgbd_pose.pose_block(matrix)
            else:
                block += d
            change = (factor.evaluate(blocks)[0] - residuals) / 1e-7
            block[:] = before
            np.testing.assert_allclose(
                change, J[:, k], atol=1e-5 * max(1.0, np.abs(J).max())
            )
    # A problem takes it, and is solved where it begins.
    problem = rgbd_pose.Problem()
    problem.add_residual_block(factor, "huber", blocks)
    assert rgbd_pose.solve(problem).final_cost < 1e-15


@pytest.mark.parametrize("make, message", [
    (lambda: rgbd_pose.RelativePoseFactor(np.eye(3), MOTION_COVARIANCE),
     r"cur_from_ref: has shape \(3, 3\); it needs \(4, 4\)"),
    (lambda: rgbd_pose.RelativePoseFactor(np.eye(4), np.zeros((6, 6))),
     "covariance: a covariance is not positive definite"),
    (lambda: rgbd_pose.RelativePoseFactor(np.eye(4), np.full((6, 6), np.nan)),
     "covariance: is not finite and symmetric"),
    (lambda: rgbd_pose.RelativeRotationFactor(2.0 * np.eye(3), np.eye(3)),
     "cur_from_ref: is not a rotation matrix"),
    (lambda: rgbd_pose.GravityFactor(np.zeros(3), DOWN),
     "in_body: has no length, so it is no direction"),
    (lambda: rgbd_pose.GravityFactor(DOWN, DOWN, 0.0),
     "sigma: must be a positive number"),
    (lambda: rgbd_pose.DistanceFactor(np.inf), "metres: is not finite"),
    (lambda: rgbd_pose.DistanceFactor(-1.0), "metres: must not be negative"),
    (lambda: rgbd_pose.MapPlaneFactor(DOWN, 2.0 * DOWN, 0.0),
     "normal: must be of length 1"),
    (lambda: rgbd_pose.PairFactor(random_points(9), random_points(8)),
     "points_ref has 9 rows and points_cur 8; .*"),
    (lambda: rgbd_pose.PairFactor(np.zeros((9, 3)), np.zeros((9, 3))),
     "points_ref: the cost bidirectional_point can use none of the 9 .*"),
    (lambda: rgbd_pose.PairFactor(
        random_points(9), random_points(9), cost="epipolar+motion_prior"),
     "cost: 'epipolar.motion_prior' is a sum; .*"),
    (lambda: rgbd_pose.PairFactor(
        random_points(9), random_points(9), mounting="on_top"),
     "unknown mounting 'on_top'.*"),
    (lambda: rgbd_pose.PairFactor(random_points(9), random_points(9), cost="a"),
     "unknown cost 'a'.*"),
    (lambda: rgbd_pose.RelativePoseFactor(np.eye(4), MOTION_COVARIANCE).evaluate(
        [np.zeros(7)]),
     r"evaluate: the factor is over 2 blocks \(pose, pose\), not 1"),
])
def test_wrong_measurements_are_refused(make, message):
    with raises_one_line(message):
        make()
