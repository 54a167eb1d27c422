"""Problems of factors: solutions, covariances, and what is refused."""

import gc
import os
import signal
import threading

import numpy as np
import pytest

import rgbd_pose
from conftest import add_kinect_noise, motion, move, random_points, rotation

CAMERA = rgbd_pose.Camera(525.0, 525.0, 319.5, 239.5)
DOWN = np.array([0.0, 1.0, 0.0])
MOTION_COVARIANCE = np.diag([1e-4, 1e-4, 2e-4, 1e-6, 1e-6, 4e-6])


def rigid(axis, angle, translation):
    result = np.eye(4)
    result[:3, :3] = rotation(axis, angle)
    result[:3, 3] = translation
    return result


def block_row(world_from_body):
    return rgbd_pose.pose_block(world_from_body)


class Loop:
    """Five poses round a room: measured motions, gravity and a distance."""

    def __init__(self, loss=None, wrong_edge=None, off=0.1):
        """`off`: how far poses begin from the truth, rad and m."""
        step = rigid([0.1, 1.0, -0.2], np.radians(70.0), [1.0, 0.1, 0.2])
        self.truth = [np.linalg.matrix_power(step, i) for i in range(5)]
        rng = np.random.default_rng(1)
        self.poses = np.array([
            block_row(t if i == 0 else
                      t @ rigid(rng.normal(size=3), off, rng.normal(0, off, 3)))
            for i, t in enumerate(self.truth)
        ])
        self.problem = rgbd_pose.Problem()
        self.terms = []
        edges = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 2), (1, 4)]
        for ref, cur in edges:
            cur_from_ref = np.linalg.inv(self.truth[cur]) @ self.truth[ref]
            if (ref, cur) == wrong_edge:
                cur_from_ref = rigid([0, 0, 1], 0.0, [0.3, 0, 0]) @ cur_from_ref
            self.add(
                rgbd_pose.RelativePoseFactor(cur_from_ref, MOTION_COVARIANCE),
                [ref, cur], loss,
            )
        for i in range(5):
            measured = self.truth[i][:3, :3].T @ DOWN
            self.add(rgbd_pose.GravityFactor(measured, DOWN, 0.02), [i])
        distance = np.linalg.norm(self.truth[0][:3, 3] - self.truth[3][:3, 3])
        self.add(rgbd_pose.DistanceFactor(distance, 0.001), [0, 3])
        self.problem.set_parameter_block_constant(self.poses[0])

    def add(self, factor, indices, loss=None):
        self.terms.append((factor, indices))
        self.problem.add_residual_block(
            factor, loss, [self.poses[i] for i in indices]
        )

    def errors(self):
        """Of all poses, m and matrix elements."""
        return [np.abs(rgbd_pose.pose_matrix(pose) - truth).max()
                for pose, truth in zip(self.poses, self.truth)]

    def residuals(self, tangent):
        """All residuals with poses 1 to 4 moved by `tangent` (24,)."""
        moved = self.poses.copy()
        for pose, (wx, wy, wz, *p) in zip(moved[1:], tangent.reshape(4, 6)):
            matrix = rgbd_pose.pose_matrix(pose).copy()
            angle = np.linalg.norm([wx, wy, wz])
            if angle > 0.0:
                matrix[:3, :3] = matrix[:3, :3] @ rotation([wx, wy, wz], angle)
            matrix[:3, 3] += p
            pose[:] = block_row(matrix)
        return np.concatenate([
            factor.evaluate(list(moved[indices]))[0]
            for factor, indices in self.terms
        ])


def test_a_loop_is_solved_and_has_a_covariance():
    loop = Loop()
    assert max(loop.errors()) > 0.05
    summary = rgbd_pose.solve(loop.problem)
    assert summary.ok and summary.status == "ok" and summary.reason == ""
    assert summary.final_cost < 1e-15 < 1.0 < summary.initial_cost
    assert 2 < summary.iterations < 20
    assert repr(summary).startswith("SolverSummary(ok, cost ")
    assert max(loop.errors()) < 1e-9
    assert repr(loop.problem) == (
        "Problem(13 factors over 5 blocks, 1 constant)"
    )
    np.testing.assert_allclose(np.linalg.norm(loop.poses[:, :4], axis=1), 1.0)

    step = 1e-5  # m and rad: errors of the differences are about 1e-9
    J = np.column_stack([
        (loop.residuals(d) - loop.residuals(-d)) / (2.0 * step)
        for d in step * np.eye(24)
    ])
    expected = np.linalg.inv(J.T @ J)
    covariance = loop.problem.covariance(list(loop.poses[1:]))
    largest = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        covariance / np.outer(largest, largest),
        expected / np.outer(largest, largest), atol=1e-6,
    )
    # Blocks in any order, and one that is held.
    some = loop.problem.covariance([loop.poses[3], loop.poses[0]])
    np.testing.assert_allclose(some[:6, :6], covariance[12:18, 12:18])
    assert some.shape == (12, 12) and not some[6:].any() and not some[:, 6:].any()


def test_quaternions_of_any_length_stand_for_rotations():
    loop, scaled = Loop(), Loop()
    scaled.poses[:, :4] *= [[2.0], [0.5], [3.0], [-1.0], [0.1]]
    for each in (loop, scaled):
        each.covariance = each.problem.covariance(list(each.poses))
        rgbd_pose.solve(each.problem)
    np.testing.assert_allclose(scaled.covariance, loop.covariance, rtol=1e-9)
    assert max(scaled.errors()) < 1e-9
    np.testing.assert_allclose(
        np.linalg.norm(scaled.poses[1:, :4], axis=1), 1.0, rtol=1e-12
    )
    pose = np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0])  # needs no step
    problem = rgbd_pose.Problem()
    problem.add_residual_block(
        rgbd_pose.AbsolutePoseFactor(np.eye(4), np.eye(6)), None, [pose]
    )
    assert rgbd_pose.solve(problem).iterations == 0
    np.testing.assert_array_equal(pose, block_row(np.eye(4)))


def test_a_loss_decides_about_a_wrong_edge():
    # From farther away a redescending loss may leave out the right edges.
    begin = {"wrong_edge": (1, 4), "off": 0.005}
    plain = Loop(**begin)
    assert rgbd_pose.solve(plain.problem).ok
    robust = Loop(loss="cauchy", **begin)
    assert rgbd_pose.solve(robust.problem).ok
    assert max(plain.errors()) > 0.05
    assert max(robust.errors()) < 0.002
    narrow = Loop(loss="cauchy(0.5)", **begin)
    assert rgbd_pose.solve(narrow.problem).ok
    assert max(narrow.errors()) < max(robust.errors())
    # The wrong edge has no weight, which is less information.
    assert (np.trace(robust.problem.covariance([robust.poses[4]]))
            > np.trace(plain.problem.covariance([plain.poses[4]])))


@pytest.mark.parametrize("factor, width", [
    (rgbd_pose.DistanceFactor(10.0, 0.1), 1.3450),
    (rgbd_pose.CommonDirectionFactor(DOWN, -DOWN, 0.01), 1.5011),
    (rgbd_pose.RelativeRotationFactor(
        rotation(DOWN, 1.0), 1e-4 * np.eye(3)), 1.6280),
    (rgbd_pose.RelativePoseFactor(
        rigid(DOWN, 1.0, DOWN), MOTION_COVARIANCE), 1.8693),
])
def test_the_width_of_a_loss_is_that_of_the_independent_rows(factor, width):
    blocks = [block_row(np.eye(4)), block_row(np.eye(4))]
    norm = np.linalg.norm(factor.evaluate(blocks)[0])
    assert norm > 10.0
    problem = rgbd_pose.Problem()
    problem.add_residual_block(factor, "huber", blocks)
    cost = rgbd_pose.solve(problem, max_iterations=1).initial_cost
    np.testing.assert_allclose(cost, width * norm - 0.5 * width**2, rtol=1e-9)


@pytest.mark.parametrize("cost", ["bidirectional_point", "point_to_point"])
@pytest.mark.parametrize("loss", ["none", "huber", "tukey"])
def test_a_pair_moves_as_estimate_motion_does(cost, loss):
    rng = np.random.default_rng(3)
    points = random_points(300)
    ref = add_kinect_noise(points, rng, CAMERA)
    cur = add_kinect_noise(move(motion(), points), rng, CAMERA)
    if loss != "none":
        cur[:30] = random_points(30, seed=5)
    # So near that the estimator chooses its weights there, and never again.
    guess = motion() @ rigid([1.0, 1.0, 0.0], 0.004, [0.002, 0.0, -0.002])
    estimate = rgbd_pose.estimate_motion(
        ref, cur, CAMERA, cost=cost, loss=loss, initial_guess=guess,
        robust_schedule="direct",
    )
    factor = rgbd_pose.PairFactor(
        ref, cur, CAMERA, cost=cost, loss=loss, initial_guess=guess
    )
    poses = np.array([block_row(np.eye(4)),
                      block_row(np.linalg.inv(guess))])
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
        poses = np.array([block_row(body) for body in bodies])
        poses[1:, 4:] += 0.02
        problem = rgbd_pose.Problem()
        for i in range(3):
            problem.add_residual_block(
                rgbd_pose.PairFactor(
                    points, move(np.linalg.inv(cams[i + 1]) @ cams[0], points),
                    CAMERA, loss="none", mounting=mounting, **arguments,
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

    expected = np.array([block_row(body) for body in bodies])
    found = solved("constant", [], body_from_ref_cam=body_from_cam,
                   body_from_cur_cam=body_from_cam)
    np.testing.assert_allclose(found, expected, atol=1e-7)
    mounting = block_row(np.eye(4))
    found = solved("shared", [mounting])
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(
        rgbd_pose.pose_matrix(mounting), body_from_cam, atol=1e-6
    )
    each = [block_row(np.eye(4)), block_row(np.eye(4))]
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
        points, move(cur_from_ref, points), CAMERA,
        body_from_ref_cam=body_from_ref_cam,
        body_from_cur_cam=body_from_cur_cam,
    )
    residuals, _ = pair.evaluate([block_row(body) for body in bodies])
    np.testing.assert_allclose(residuals, 0.0, atol=1e-9)


def test_pixels_and_points_give_the_same_pair():
    points = random_points(50)
    moved = move(motion(), points)
    pixels = [
        np.column_stack([525.0 * p[:, :2] / p[:, 2:] + [319.5, 239.5], p[:, 2]])
        for p in (points, moved)
    ]
    by_points = rgbd_pose.PairFactor(points, moved, CAMERA, loss="none")
    by_pixels = rgbd_pose.PairFactor.from_pixels(*pixels, CAMERA, loss="none")
    blocks = [block_row(np.eye(4)), block_row(np.eye(4))]
    for a, b in zip(by_points.evaluate(blocks)[1], by_pixels.evaluate(blocks)[1]):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6 * np.abs(b).max())


def test_weights_are_those_of_the_association():
    points = random_points(50)
    moved = move(motion(), points)
    arguments = {"cost": "bidirectional_image", "loss": "none"}
    pair = rgbd_pose.PairFactor(points, moved, CAMERA, **arguments)
    near = rgbd_pose.PairFactor(
        points, moved, CAMERA, initial_guess=motion(), **arguments
    )
    blocks = [block_row(np.eye(4)), block_row(np.eye(4))]
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
    return [block_row(BODY), v.copy(), MEASURED.bias.copy(), block_row(later),
            v + GRAVITY * SECONDS + R @ MEASURED.velocity, MEASURED.bias.copy()]


EXACT = {
    "AbsolutePoseFactor": (
        lambda: rgbd_pose.AbsolutePoseFactor(BODY, MOTION_COVARIANCE),
        lambda: [block_row(BODY)]),
    "AbsolutePositionFactor": (
        lambda: rgbd_pose.AbsolutePositionFactor(
            IN_WORLD, 1e-4 * np.eye(3), POINT),
        lambda: [block_row(BODY)]),
    "RelativePoseFactor": (
        lambda: rgbd_pose.RelativePoseFactor(
            OTHER_FROM_BODY, MOTION_COVARIANCE),
        lambda: [block_row(BODY), block_row(OTHER)]),
    "RelativeRotationFactor": (
        lambda: rgbd_pose.RelativeRotationFactor(
            OTHER_FROM_BODY[:3, :3], 1e-4 * np.eye(3)),
        lambda: [block_row(BODY), block_row(OTHER)]),
    "GravityFactor": (
        lambda: rgbd_pose.GravityFactor(BODY[:3, :3].T @ DOWN, 9.81 * DOWN),
        lambda: [block_row(BODY)]),
    "CommonDirectionFactor": (
        lambda: rgbd_pose.CommonDirectionFactor(
            BODY[:3, :3].T @ DOWN, 2.0 * OTHER[:3, :3].T @ DOWN),
        lambda: [block_row(BODY), block_row(OTHER)]),
    "ConstantVelocityFactor": (
        lambda: rgbd_pose.ConstantVelocityFactor(SECONDS),
        lambda: [block_row(BODY), TWIST.copy(),
                 block_row(coasted()[0]), coasted()[1]]),
    "DistanceFactor": (
        lambda: rgbd_pose.DistanceFactor(
            np.linalg.norm(IN_WORLD - OTHER[:3, 3]), 0.01, in_a=POINT),
        lambda: [block_row(BODY), block_row(OTHER)]),
    "MapPlaneFactor": (
        lambda: rgbd_pose.MapPlaneFactor(POINT, DOWN, DOWN @ IN_WORLD),
        lambda: [block_row(BODY)]),
    "LandmarkFactor": (
        lambda: rgbd_pose.LandmarkFactor(
            CAMERA, POINT[:2] / POINT[2],
            525.0 * IN_OTHER[:2] / IN_OTHER[2] + [319.5, 239.5]),
        lambda: [block_row(BODY), block_row(OTHER), np.array([0.5])]),
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
                block[:] = block_row(matrix)
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


def test_blocks_outlive_the_names_of_the_caller():
    def make():
        problem = rgbd_pose.Problem()
        poses = np.tile(block_row(np.eye(4)), (3, 1))
        for i in range(2):
            problem.add_residual_block(
                rgbd_pose.RelativePoseFactor(motion(), MOTION_COVARIANCE),
                None, [poses[i], poses[i + 1]],
            )
        problem.set_parameter_block_constant(poses[0])
        return problem, poses[2]

    problem, last = make()
    gc.collect()
    rubbish = [np.full((3, 7), np.nan) for _ in range(100)]
    assert rgbd_pose.solve(problem).ok
    del rubbish
    np.testing.assert_allclose(
        rgbd_pose.pose_matrix(last),
        np.linalg.inv(motion() @ motion()), atol=1e-9,
    )
    del last
    gc.collect()
    assert rgbd_pose.solve(problem).ok


def test_a_held_block_stays_and_moves_again():
    loop = Loop()
    before = loop.poses[2].copy()
    loop.problem.set_parameter_block_constant(loop.poses[2])
    rgbd_pose.solve(loop.problem)
    np.testing.assert_array_equal(loop.poses[2], before)
    loop.problem.set_parameter_block_variable(loop.poses[2])
    rgbd_pose.solve(loop.problem)
    assert max(loop.errors()) < 1e-9


def test_statuses_of_a_solve():
    loop = Loop()
    summary = rgbd_pose.solve(loop.problem, max_iterations=1)
    assert summary.status == "not_converged" and not summary.ok
    assert summary.reason == "the cost still fell in iteration 1, the last one"
    # A landmark behind the view has no residual.
    factor, blocks = (make() for make in EXACT["LandmarkFactor"])
    blocks[1][:] = block_row(rigid([0, 1, 0], 0.0, [0, 0, 100]))
    before = [block.copy() for block in blocks]
    problem = rgbd_pose.Problem()
    problem.add_residual_block(factor, None, blocks)
    summary = rgbd_pose.solve(problem)
    assert summary.status == "failed"
    assert summary.reason == "a factor cannot be evaluated at the start"
    assert np.isnan(summary.initial_cost)
    for block, same in zip(blocks, before):
        np.testing.assert_array_equal(block, same)
    with pytest.raises(rgbd_pose.InputError, match="no residual"):
        factor.evaluate(blocks)
    with pytest.raises(rgbd_pose.InputError, match="cannot be evaluated"):
        problem.covariance(blocks)
    assert rgbd_pose.solve(rgbd_pose.Problem()).ok


def test_nothing_is_printed(capfd):
    loop = Loop()
    free = Loop()
    free.problem.set_parameter_block_variable(free.poses[0])
    far = Loop()
    far.poses[1, 4:] = 1e200  # its squared residual is infinite
    rgbd_pose.solve(loop.problem)
    rgbd_pose.solve(loop.problem, max_iterations=1)
    rgbd_pose.solve(free.problem)
    assert rgbd_pose.solve(far.problem).status == "failed"
    endless = rgbd_pose.Problem()  # its residual is infinite
    endless.add_residual_block(
        rgbd_pose.DistanceFactor(1e308, 1e-9), None,
        [block_row(np.eye(4)), block_row(motion())],
    )
    assert rgbd_pose.solve(endless).status == "failed"
    lone = rgbd_pose.Problem()
    lone.add_residual_block(
        rgbd_pose.GravityFactor(DOWN, DOWN), None, [block_row(np.eye(4))]
    )
    with pytest.raises(rgbd_pose.InputError):
        lone.covariance([])
    out, err = capfd.readouterr()
    assert out == "" and err == ""


def slow_problem(pairs):
    """A problem that takes 10 ms or more for each pair, and its poses."""
    points = random_points(50000)
    pair = rgbd_pose.PairFactor(
        points, move(motion(), points), CAMERA, loss="fair"
    )
    problem = rgbd_pose.Problem()
    poses = np.tile(block_row(np.eye(4)), (pairs + 1, 1))
    for i in range(pairs):
        problem.add_residual_block(pair, None, [poses[i], poses[i + 1]])
    problem.set_parameter_block_constant(poses[0])
    return problem, poses


def test_ctrl_c_ends_a_solve_and_changes_nothing():
    problem, poses = slow_problem(300)
    before = poses.copy()
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        rgbd_pose.solve(problem)
    np.testing.assert_array_equal(poses, before)


def test_threads_may_share_a_problem():
    problem, poses = slow_problem(9)
    more = np.tile(block_row(np.eye(4)), (100, 1))
    summaries = []

    def work():
        summaries.append(rgbd_pose.solve(problem, max_iterations=3))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for pose in more:  # meanwhile
        problem.add_residual_block(
            rgbd_pose.AbsolutePoseFactor(np.eye(4), np.eye(6)), None, [pose]
        )
    for thread in threads:
        thread.join()
    assert [summary.iterations for summary in summaries] == [3] * 3
    assert np.isfinite(poses).all()


def raises_one_line(pattern):
    """InputError of a single line that matches from its start to its end."""
    return pytest.raises(rgbd_pose.InputError, match=f"^{pattern}$")


READ_ONLY = np.zeros(7)
READ_ONLY.setflags(write=False)
FACTOR = rgbd_pose.RelativePoseFactor(np.eye(4), MOTION_COVARIANCE)


@pytest.mark.parametrize("block, message", [
    (np.zeros(6), r"blocks\[1\]: has shape \(6,\); a pose needs \(7,\)"),
    (np.zeros((1, 7)), r"blocks\[1\]: has shape \(1, 7\); .*"),
    (READ_ONLY, r"blocks\[1\]: is read-only; .* pass a copy"),
    (np.zeros(7, np.float32), r"blocks\[1\]: holds float32; .* float64, .*"),
    (np.zeros(7, ">f8"), r"blocks\[1\]: holds >f8; .*"),
    (np.zeros(14)[::2], r"blocks\[1\]: is not contiguous; .*"),
    ([0.0] * 7, r"blocks\[1\]: is a list; a block is a numpy array, .*"),
])
def test_wrong_blocks_are_refused(block, message):
    problem = rgbd_pose.Problem()
    with raises_one_line(message):
        problem.add_residual_block(FACTOR, None, [np.zeros(7), block])
    # Nothing of it remains.
    assert repr(problem) == "Problem(0 factors over 0 blocks, 0 constant)"


def test_wrong_arguments_are_refused():
    problem = rgbd_pose.Problem()
    poses = np.tile(block_row(np.eye(4)), (3, 1))
    add = problem.add_residual_block
    two = [poses[0], poses[1]]
    with raises_one_line("factor: is a str; it needs a factor, .*"):
        add("relative_pose", None, two)
    with raises_one_line("unknown loss 'hubert'.*"):
        add(FACTOR, "hubert", two)
    with raises_one_line("loss: is a float; .*"):
        add(FACTOR, 1.5, two)
    with raises_one_line("loss: must be None, as a PairFactor has its own"):
        add(rgbd_pose.PairFactor(random_points(9), random_points(9)), "huber", two)
    with raises_one_line(
        r"blocks: the factor is over 2 blocks \(pose, pose\), not 1"
    ):
        add(FACTOR, None, two[:1])
    with raises_one_line(r"blocks: the factor is over 1 block \(pose\), not 7"):
        add(rgbd_pose.GravityFactor(DOWN, DOWN), None, poses[0])
    with raises_one_line(r"blocks\[1\]: is blocks\[0\] again; .*"):
        add(FACTOR, None, [poses[0], poses[0]])
    with raises_one_line(r"blocks\[1\]: overlaps another block .*"):
        add(FACTOR, None, [poses[0], poses.reshape(-1)[3:10]])
    with raises_one_line("block: is not in the problem; .*"):
        problem.set_parameter_block_constant(poses[0])
    add(FACTOR, None, two)
    for other in (poses, poses[2], poses.reshape(-1)[:6]):
        with raises_one_line("block: is not in the problem; .*"):
            problem.set_parameter_block_constant(other)
    with raises_one_line("covariance: is singular: .* add a factor .*"):
        problem.covariance(two)
    with raises_one_line("max_iterations: .*"):
        rgbd_pose.solve(problem, max_iterations=0)
    poses[1] = 0.0
    with raises_one_line("block 1 of the problem, a pose: is not finite, or .*"):
        rgbd_pose.solve(problem)
    with raises_one_line("pose: is not finite, or .*"):
        rgbd_pose.pose_matrix(poses[1])


def test_an_array_that_has_changed_is_refused():
    first, second = block_row(np.eye(4)), block_row(motion())
    problem = rgbd_pose.Problem()
    problem.add_residual_block(FACTOR, None, [first, second])
    second.setflags(write=False)
    with raises_one_line("block 1 of the problem, a pose: is read-only; .*"):
        rgbd_pose.solve(problem)
    second.setflags(write=True)
    first.resize(100_000, refcheck=False)
    with raises_one_line("block 0 of the problem, a pose: has another size now"):
        rgbd_pose.solve(problem)


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
    (lambda: FACTOR.evaluate([np.zeros(7)]),
     r"evaluate: the factor is over 2 blocks \(pose, pose\), not 1"),
])
def test_wrong_measurements_are_refused(make, message):
    with raises_one_line(message):
        make()
