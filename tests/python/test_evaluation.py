"""Compares the evaluation with the program rgbd_evaluate."""

import json
import os
import warnings

import numpy as np
import pytest

import rgbd_pose
from conftest import rotation, run_program


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Paths of an estimate and its reference, 3 s at 30 and 50 Hz."""
    folder = tmp_path_factory.mktemp("trajectories")
    rng = np.random.default_rng(1)

    def write(name, stamps, noise):
        poses = np.tile(np.eye(4), (len(stamps), 1, 1))
        for pose, t in zip(poses, stamps):
            pose[:3, :3] = rotation([1, t, 2], 0.2 * t + noise * rng.normal())
            pose[:3, 3] = [0.5 * t, np.sin(t), 0.1]
            pose[:3, 3] += noise * rng.normal(size=3)
        path = folder / name
        rgbd_pose.write_trajectory(path, (stamps, poses))
        return path

    return (
        write("estimate.txt", 100.0 + np.arange(90) / 30.0, 0.01),
        write("truth.txt", 100.0 + np.arange(150) / 50.0, 0.0),
    )


def by_program(files, *flags):
    return json.loads(
        run_program(
            "rgbd_evaluate", f"--estimate={files[0]}",
            f"--groundtruth={files[1]}", "--json", *flags,
        )
    )


# The same sums in the same order: only the conversion of units may differ.
TOLERANCE = 1e-14


def assert_same(errors, count, expected, factor=1.0, tolerance=TOLERANCE):
    assert errors.count == count
    for name in ("rmse", "mean", "median", "max"):
        assert getattr(errors, name) * factor == pytest.approx(
            expected[name], rel=tolerance
        )


def as_arrays(path):
    return rgbd_pose.read_trajectory(path)


def as_quaternions(path):
    table = np.loadtxt(path)
    return table[:, 0], table[:, 1:]


def test_warns_of_poses_that_are_left_out(files, tmp_path):
    twice = tmp_path / "twice.txt"
    text = files[0].read_text()
    twice.write_text(text + text.splitlines(keepends=True)[-1])
    for read in (
        lambda: rgbd_pose.read_trajectory(os.fsencode(twice)),
        lambda: rgbd_pose.evaluate_ate(twice, files[1]),
    ):
        with pytest.warns(UserWarning, match="1 such pose is left out"):
            read()


@pytest.mark.parametrize("form", [str, lambda p: p, as_arrays, as_quaternions])
def test_same_as_the_program(files, form):
    expected = by_program(files)
    estimated, reference = map(form, files)
    ate = rgbd_pose.evaluate_ate(estimated, reference)
    rpe = rgbd_pose.evaluate_rpe(estimated, reference)
    assert ate.rmse > 0.005
    # Rotation matrices round the quaternions.
    tolerance = 1e-9 if form is as_arrays else TOLERANCE
    want = expected["ate"]
    assert_same(ate, want["count"], want["position_m"], 1.0, tolerance)
    want = expected["rpe_seconds"]
    for errors, name, factor in (
        (rpe.translation, "translation_m", 1.0),
        (rpe.rotation, "rotation_deg", 180.0 / np.pi),
    ):
        assert_same(errors, want["count"], want[name], factor, tolerance)


def test_options_are_those_of_the_program(files):
    expected = by_program(
        files, "--max_time_difference=0.004", "--rpe_delta_seconds=0.5"
    )
    ate = rgbd_pose.evaluate_ate(*files, max_time_difference=0.004)
    want = expected["ate"]
    assert want["count"] < 90
    assert_same(ate, want["count"], want["position_m"])
    rpe = rgbd_pose.evaluate_rpe(
        *files, delta_seconds=0.5, max_time_difference=0.004
    )
    want = expected["rpe_seconds"]
    assert_same(rpe.translation, want["count"], want["translation_m"])


def test_values_sum_up(files):
    ate = rgbd_pose.evaluate_ate(*files)
    rpe = rgbd_pose.evaluate_rpe(*files)
    for errors in (ate, rpe.translation, rpe.rotation):
        assert errors.values.shape == (errors.count,)
        assert errors.rmse == pytest.approx(np.sqrt(np.mean(errors.values**2)))
        assert errors.mean == pytest.approx(errors.values.mean())
        assert errors.median == pytest.approx(np.median(errors.values))
        assert errors.max == errors.values.max()
    assert ate.timestamps.shape == (ate.count,)
    assert rpe.timestamps.shape == (rpe.translation.count,)
    assert rpe.timestamps.max() < ate.timestamps.max() - 0.9


def test_alignment_is_found(files):
    stamps, poses = rgbd_pose.read_trajectory(files[1])
    move = np.eye(4)
    move[:3, :3] = rotation([1, 2, 3], 0.7)
    move[:3, 3] = [1.0, -2.0, 3.0]
    ate = rgbd_pose.evaluate_ate((stamps, move @ poses), (stamps, poses))
    assert ate.rmse < 1e-9
    np.testing.assert_allclose(
        ate.reference_from_estimated, np.linalg.inv(move), atol=1e-9
    )


def test_large_time_difference(files):
    ate = rgbd_pose.evaluate_ate(*files, max_time_difference=5.0)
    assert ate.count == rgbd_pose.evaluate_ate(*files).count


def test_read_and_write(files, tmp_path):
    stamps, poses = rgbd_pose.read_trajectory(files[0])
    assert stamps.shape == (90,) and poses.shape == (90, 4, 4)
    table = np.loadtxt(files[0])
    np.testing.assert_array_equal(stamps, table[:, 0])
    np.testing.assert_array_equal(poses[:, :3, 3], table[:, 1:4])
    rgbd_pose.write_trajectory(tmp_path / "copy.txt", files[0])
    # Nine decimals of normalised quaternions.
    np.testing.assert_allclose(
        np.loadtxt(tmp_path / "copy.txt"), table, rtol=0.0, atol=2e-9
    )


GOOD = (np.arange(3.0), np.tile(np.eye(4), (3, 1, 1)))


@pytest.mark.parametrize(
    "estimated, words",
    [
        ("/none.txt", "/none.txt"),
        (5, "estimated: must be the path of a trajectory or a pair"),
        ((GOOD[0], GOOD[1], 0), "estimated: must be the path"),
        ((GOOD[0][:2], GOOD[1]), "estimated: 2 time stamps for 3 poses"),
        ((GOOD[0][::-1], GOOD[1]), r"estimated\[0\]\[1\]: is not finite or not after"),
        ((GOOD[0] * np.nan, GOOD[1]), r"estimated\[0\]\[0\]: is not finite or not after"),
        ((GOOD[0], GOOD[1] * 2), r"estimated\[1\]\[0\]: is not a rigid motion"),
        ((GOOD[0], np.zeros((3, 7))), r"estimated\[1\]\[0\]: is not a pose"),
        ((GOOD[0], np.zeros((3, 6))), r"estimated\[1\]: has shape \(3, 6\)"),
        ((GOOD[0] + 50, GOOD[1]), "no pose of the estimate"),
    ],
)
def test_bad_trajectories_are_told_in_one_line(estimated, words):
    for evaluate in (rgbd_pose.evaluate_ate, rgbd_pose.evaluate_rpe):
        with pytest.raises(rgbd_pose.InputError, match=words) as error:
            evaluate(estimated, GOOD)
        assert "\n" not in str(error.value)


def test_errors_say_how_large_they_are(files):
    ate, rpe = rgbd_pose.evaluate_ate(*files), rgbd_pose.evaluate_rpe(*files)

    def words(name, errors):
        return (
            f"{name}(rmse={errors.rmse:.6g}, max={errors.max:.6g}, "
            f"count={errors.count})"
        )

    assert repr(ate) == words("AteResult", ate)
    assert repr(rpe) == (
        f"RpeResult(translation={words('Errors', rpe.translation)}, "
        f"rotation={words('Errors', rpe.rotation)})"
    )


def test_a_path_of_another_size_is_said(files):
    stamps, poses = rgbd_pose.read_trajectory(files[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rgbd_pose.evaluate_ate((stamps, poses), files[1])
    small = poses.copy()
    small[:, :3, 3] /= 5  # millimetres taken for units of 0.2 mm
    with pytest.warns(UserWarning, match="scaled by 5.*the depth scale") as said:
        rgbd_pose.evaluate_ate((stamps, small), files[1])
    assert len(said) == 1 and said[0].filename == __file__
