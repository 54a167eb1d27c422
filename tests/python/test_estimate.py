"""Motions, statuses and covariances of estimate_motion."""

import numpy as np
import pytest

import rgbd_pose
from conftest import (
    KINECT, add_kinect_noise, motion, move, random_points, rotation,
)


def noisy_matches(count, outlier_share, seed):
    """Points of both frames and which matches are right."""
    rng = np.random.default_rng(seed)
    points = random_points(count, seed)
    prev = add_kinect_noise(points, rng, KINECT)
    cur = add_kinect_noise(move(motion(), points), rng, KINECT)
    wrong = int(outlier_share * count)
    cur[:wrong] = random_points(wrong, seed + 1)
    return prev, cur, np.arange(count) >= wrong


def error_of(estimate):
    """[omega C] of the estimate against motion(), as in the covariance."""
    R, true_R = estimate.cur_from_prev[:3, :3], motion()[:3, :3]
    W = true_R @ R.T
    omega = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0],
                            W[1, 0] - W[0, 1]])
    C = -R.T @ estimate.cur_from_prev[:3, 3]
    true_C = -true_R.T @ motion()[:3, 3]
    return np.concatenate([omega, true_C - C])


@pytest.mark.parametrize("cost", ["bidirectional_point", "reprojection_depth"])
@pytest.mark.parametrize("loss", ["none", "huber", "tukey"])
def test_recovers_an_exact_motion(cost, loss):
    prev = random_points(300)
    estimate = rgbd_pose.estimate_motion(
        prev, move(motion(), prev), KINECT, cost=cost, loss=loss
    )
    assert estimate.ok and estimate.status == "ok" and estimate.reason == ""
    # Limited by the solver's tolerance of 1e-9.
    np.testing.assert_allclose(estimate.cur_from_prev, motion(), atol=1e-7)
    assert estimate.num_used == estimate.num_inliers == 300
    assert estimate.inliers.all()
    assert estimate.iterations > 0
    assert estimate.final_cost < 1e-6 < estimate.initial_cost
    assert estimate.raise_if_failed() is estimate


def test_wrong_matches_are_found():
    prev, cur, right = noisy_matches(500, 0.4, seed=3)
    estimate = rgbd_pose.estimate_motion(prev, cur, KINECT)
    assert estimate.ok
    # 1 % of right matches are outliers by definition; three times as many have
    # a probability of 1e-4. Wrong matches agree by chance about as rarely.
    assert np.mean(estimate.inliers[right]) > 0.97
    assert np.mean(estimate.inliers[~right]) < 0.03
    assert estimate.weights[~right].mean() < 0.02 < 0.5
    assert estimate.weights[right].mean() > 0.7
    assert 0.9 < estimate.sigma < 1.5
    squares = rgbd_pose.estimate_motion(prev, cur, KINECT, loss="none")
    assert (np.linalg.norm(error_of(squares))
            > 10.0 * np.linalg.norm(error_of(estimate)))


def test_errors_fit_the_covariance():
    squares = []
    for seed in range(40):
        prev, cur, _ = noisy_matches(200, 0.2, seed)
        estimate = rgbd_pose.estimate_motion(prev, cur, KINECT)
        error = error_of(estimate)
        squares.append(error @ np.linalg.solve(estimate.covariance, error))
    # The mean of 40 chi^2 of 6 degrees has a standard deviation of 0.55.
    assert 4.3 < np.mean(squares) < 7.7


def test_point_and_pixel_input_agree():
    camera = rgbd_pose.Camera.load("tum_fr1")  # with distortion
    prev, cur, _ = noisy_matches(100, 0.2, seed=5)
    by_point = rgbd_pose.estimate_motion(prev, cur, camera)
    pixels = [np.column_stack([project(camera, p), p[:, 2]])
              for p in (prev, cur)]
    by_pixel = rgbd_pose.estimate_motion_pixels(*pixels, camera)
    np.testing.assert_allclose(
        by_pixel.cur_from_prev, by_point.cur_from_prev, atol=1e-8
    )
    np.testing.assert_array_equal(by_pixel.inliers, by_point.inliers)


def project(camera, points):
    """OpenCV's plumb bob, implemented independently."""
    k1, k2, p1, p2, k3 = camera.distortion
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.column_stack([camera.fx * u + camera.cx,
                            camera.fy * v + camera.cy])


@pytest.mark.parametrize("estimate", [rgbd_pose.estimate_motion,
                                      rgbd_pose.estimate_motion_pixels])
def test_rows_that_are_no_match_keep_their_place(estimate):
    prev, cur, _ = noisy_matches(60, 0.0, seed=7)
    if estimate is rgbd_pose.estimate_motion_pixels:
        prev, cur = (np.column_stack([project(KINECT, p), p[:, 2]])
                     for p in (prev, cur))
    whole = estimate(prev[10:], cur[10:], KINECT)
    prev[:10:2, 1] = np.nan
    cur[1:10:4] = np.inf
    cur[3:10:4, 2] = -1.0
    holed = estimate(prev, cur, KINECT)
    assert holed.num_rejected == 10
    for name in ("weights", "inliers", "residual_norms", "residual_degrees"):
        values = getattr(holed, name)
        assert values.shape == (60,)
        assert not values[:10].any()
        np.testing.assert_array_equal(values[10:], getattr(whole, name))
    np.testing.assert_array_equal(holed.cur_from_prev, whole.cur_from_prev)


def test_depth_of_zero():
    prev, cur, _ = noisy_matches(60, 0.0, seed=8)
    prev[:20] = 0.0  # cameras give 0 where they measure nothing
    assert rgbd_pose.estimate_motion(prev, cur, KINECT).num_rejected == 20
    pixels = [np.column_stack([project(KINECT, p + [0, 0, 1e-9]), p[:, 2]])
              for p in (prev, cur)]
    estimate = rgbd_pose.estimate_motion_pixels(
        *pixels, KINECT, cost="bidirectional_image"
    )
    assert estimate.num_rejected == 0
    assert estimate.num_used == 60
    np.testing.assert_array_equal(
        estimate.residual_degrees, [2] * 20 + [3] * 40
    )


def test_too_few_matches():
    points = random_points(2)
    estimate = rgbd_pose.estimate_motion(points, points)
    assert not estimate.ok
    assert estimate.status == "too_few_matches"
    assert estimate.reason == "2 usable matches, 3 are needed"
    assert not estimate.covariance.any()
    with pytest.raises(
        rgbd_pose.EstimateError,
        match="^too_few_matches: 2 usable matches, 3 are needed$",
    ) as error:
        estimate.raise_if_failed()
    assert error.value.estimate is estimate
    nothing = rgbd_pose.estimate_motion(np.empty((0, 3)), np.empty((0, 3)))
    assert nothing.status == "too_few_matches"
    assert nothing.weights.shape == (0,)


def test_degenerate_and_inconsistent():
    line = np.outer(np.linspace(1.0, 3.0, 50), [0.1, 0.2, 1.0])
    estimate = rgbd_pose.estimate_motion(line, line)
    assert estimate.status == "degenerate"
    assert "rotation" in estimate.reason
    prev, cur, _ = noisy_matches(300, 0.9, seed=1)
    estimate = rgbd_pose.estimate_motion(prev, cur)
    assert estimate.status == "inconsistent"
    assert "agree with one motion" in estimate.reason
    assert "inconsistent" in repr(estimate)


@pytest.mark.parametrize("guess", ["ransac", "clique", motion()])
def test_initial_guess(guess):
    prev, cur, _ = noisy_matches(200, 0.3, seed=11)
    estimate = rgbd_pose.estimate_motion(
        prev, cur, KINECT, robust_schedule="direct", initial_guess=guess
    )
    # Ten standard deviations. No motion is too poor a guess (docs/losses.md).
    assert estimate.ok
    deviation = np.sqrt(np.diag(estimate.covariance))
    assert (np.abs(error_of(estimate)) < 10.0 * deviation).all()
    lost = rgbd_pose.estimate_motion(
        prev, cur, KINECT, robust_schedule="direct"
    )
    assert not lost.ok or (np.abs(error_of(lost)) > 10.0 * deviation).any()


def test_normals_are_for_point_to_plane():
    rng = np.random.default_rng(13)
    prev = random_points(200)
    cur = move(motion(), prev)
    without = rgbd_pose.estimate_motion(prev, cur, cost="point_to_plane")
    assert without.status == "too_few_matches"
    normals = rng.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    estimate = rgbd_pose.estimate_motion(
        prev, cur, cost="point_to_plane", normals_cur=normals
    )
    assert estimate.ok
    np.testing.assert_allclose(estimate.cur_from_prev, motion(), atol=1e-7)


def test_a_prior_decides_what_matches_leave_open():
    line = np.outer(np.linspace(1.0, 3.0, 50), [0.1, 0.2, 1.0])
    turn = np.eye(4)
    turn[:3, :3] = rotation(line[0], 0.1)  # does not change the line
    estimate = rgbd_pose.estimate_motion(
        line,
        line,
        cost="bidirectional_point+motion_prior",
        loss="tukey,none",
        prior=(turn, 1e-4 * np.eye(6)),
    )
    assert estimate.ok
    np.testing.assert_allclose(estimate.cur_from_prev, turn, atol=1e-3)


def test_a_prior_of_a_failed_estimate_says_nothing():
    points = random_points(50)
    failed = rgbd_pose.estimate_motion(points[:2], points[:2])
    estimates = [
        rgbd_pose.estimate_motion(
            points,
            move(motion(), points),
            cost="bidirectional_point+motion_prior",
            prior=prior,
        ).cur_from_prev
        for prior in (None, (failed.cur_from_prev, failed.covariance))
    ]
    np.testing.assert_array_equal(*estimates)


def test_pieces_are_passed_on():
    prev, cur, _ = noisy_matches(300, 0.2, seed=17)
    default = rgbd_pose.estimate_motion(prev, cur, KINECT)
    for pieces in (
        {"assembly": "autodiff"},
        {"assembly": "per_match"},
        {"threads": 2},
    ):
        same = rgbd_pose.estimate_motion(prev, cur, KINECT, **pieces)
        np.testing.assert_allclose(
            same.cur_from_prev, default.cur_from_prev, atol=1e-9
        )
    for pieces in (
        {"loss": "huber"},
        {"scale": "mad"},
        {"sigma_px": 2.0},
        {"depth_noise": "constant"},
        {"max_iterations": 1},
    ):
        other = rgbd_pose.estimate_motion(prev, cur, KINECT, **pieces)
        assert (other.cur_from_prev != default.cur_from_prev).any(), pieces


def test_depth_noise_is_that_of_the_camera_unless_one_is_chosen():
    prev = random_points(300)
    cur = move(motion(), prev)
    camera = rgbd_pose.Camera.load("tum_fr1")  # states kinect
    covariances = [
        rgbd_pose.estimate_motion(prev, cur, camera, **noise).covariance
        for noise in ({}, {"depth_noise": "kinect"}, {"depth_noise": "khoshelham"})
    ]
    np.testing.assert_array_equal(covariances[0], covariances[1])
    assert (covariances[0] != covariances[2]).any()
    estimate = rgbd_pose.estimate_motion(prev, cur, KINECT)  # states none
    other = rgbd_pose.estimate_motion(prev, cur, KINECT, depth_noise="khoshelham")
    np.testing.assert_array_equal(estimate.covariance, other.covariance)
