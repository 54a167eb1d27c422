"""Problems of factors: solutions, covariances, and what is refused."""

import gc
import os
import signal
import threading

import numpy as np
import pytest

import rgbd_pose
from conftest import (
    DOWN, KINECT, MOTION_COVARIANCE,
    motion, move, raises_one_line, random_points, rigid, rotation,
)


class Loop:
    """Five poses round a room: measured motions, gravity and a distance."""

    def __init__(self, loss=None, wrong_edge=None, off=0.1):
        """`off`: how far poses begin from the truth, rad and m."""
        step = rigid([0.1, 1.0, -0.2], np.radians(70.0), [1.0, 0.1, 0.2])
        self.truth = [np.linalg.matrix_power(step, i) for i in range(5)]
        rng = np.random.default_rng(1)
        self.poses = np.array([
            rgbd_pose.pose_block(t if i == 0 else
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
            pose[:] = rgbd_pose.pose_block(matrix)
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
    np.testing.assert_array_equal(pose, rgbd_pose.pose_block(np.eye(4)))


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
    blocks = [rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(np.eye(4))]
    norm = np.linalg.norm(factor.evaluate(blocks)[0])
    assert norm > 10.0
    problem = rgbd_pose.Problem()
    problem.add_residual_block(factor, "huber", blocks)
    cost = rgbd_pose.solve(problem, max_iterations=1).initial_cost
    np.testing.assert_allclose(cost, width * norm - 0.5 * width**2, rtol=1e-9)


def test_blocks_outlive_the_names_of_the_caller():
    def make():
        problem = rgbd_pose.Problem()
        poses = np.tile(rgbd_pose.pose_block(np.eye(4)), (3, 1))
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
    factor = rgbd_pose.LandmarkFactor(KINECT, [0.0, 0.0], [319.5, 239.5])
    ahead = rigid([0, 1, 0], 0.0, [0, 0, 100])
    blocks = [
        rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(ahead),
        np.array([0.5]),
    ]
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
        [rgbd_pose.pose_block(np.eye(4)), rgbd_pose.pose_block(motion())],
    )
    assert rgbd_pose.solve(endless).status == "failed"
    lone = rgbd_pose.Problem()
    lone.add_residual_block(
        rgbd_pose.GravityFactor(DOWN, DOWN), None, [rgbd_pose.pose_block(np.eye(4))]
    )
    with pytest.raises(rgbd_pose.InputError):
        lone.covariance([])
    out, err = capfd.readouterr()
    assert out == "" and err == ""


def slow_problem(pairs):
    """A problem that takes 10 ms or more for each pair, and its poses."""
    points = random_points(50000)
    pair = rgbd_pose.PairFactor(
        points, move(motion(), points), KINECT, loss="fair"
    )
    problem = rgbd_pose.Problem()
    poses = np.tile(rgbd_pose.pose_block(np.eye(4)), (pairs + 1, 1))
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
    more = np.tile(rgbd_pose.pose_block(np.eye(4)), (100, 1))
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
    poses = np.tile(rgbd_pose.pose_block(np.eye(4)), (3, 1))
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
    assert rgbd_pose.solve(problem, max_iterations=2**31 - 1).ok
    poses[1] = 0.0
    with raises_one_line("block 1 of the problem, a pose: is not finite, or .*"):
        rgbd_pose.solve(problem)
    with raises_one_line("pose: is not finite, or .*"):
        rgbd_pose.pose_matrix(poses[1])


def test_an_array_that_has_changed_is_refused():
    first = rgbd_pose.pose_block(np.eye(4))
    second = rgbd_pose.pose_block(motion())
    problem = rgbd_pose.Problem()
    problem.add_residual_block(FACTOR, None, [first, second])
    second.setflags(write=False)
    with raises_one_line("block 1 of the problem, a pose: is read-only; .*"):
        rgbd_pose.solve(problem)
    second.setflags(write=True)
    first.resize(100_000, refcheck=False)
    with raises_one_line("block 0 of the problem, a pose: has another size now"):
        rgbd_pose.solve(problem)
