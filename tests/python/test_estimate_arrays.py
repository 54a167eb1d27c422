"""Arrays that estimate_motion accepts, and its errors for other arrays."""

import gc
import tracemalloc

import numpy as np
import pytest

import rgbd_pose
from conftest import motion, move, random_points

PREV = random_points(100)
CUR = move(motion(), PREV)


def strided(array):
    """The same numbers with a stride of three, in reverse order in memory."""
    room = np.full((3 * array.shape[0], 2 * array.shape[1]), np.nan)
    room = room.astype(array.dtype)
    view = room[::-3, ::2]
    view[:] = array
    return view


def unaligned(array):
    memory = np.empty(array.nbytes + 1, np.uint8)
    result = memory[1:].view(array.dtype).reshape(array.shape)
    result[:] = array
    return result


@pytest.mark.parametrize(
    "layout",
    [
        strided,
        unaligned,
        np.asfortranarray,
        np.ndarray.tolist,
        lambda a: a.astype(">f8"),
        lambda a: a.astype(np.longdouble),
    ],
)
def test_layouts_do_not_matter(layout):
    plain = rgbd_pose.estimate_motion(PREV, CUR)
    other = rgbd_pose.estimate_motion(layout(PREV), layout(CUR))
    np.testing.assert_array_equal(other.cur_from_prev, plain.cur_from_prev)
    np.testing.assert_array_equal(other.weights, plain.weights)


@pytest.mark.parametrize("layout", [np.asarray, strided])
def test_float32_is_what_it_says(layout):
    prev, cur = PREV.astype(np.float32), CUR.astype(np.float32)
    single = rgbd_pose.estimate_motion(layout(prev), layout(cur))
    double = rgbd_pose.estimate_motion(
        prev.astype(np.float64), cur.astype(np.float64)
    )
    np.testing.assert_array_equal(single.cur_from_prev, double.cur_from_prev)


def test_whole_numbers():
    rng = np.random.default_rng(5)
    points = rng.integers(1, 5, (50, 3))
    estimate = rgbd_pose.estimate_motion(points, points)
    assert estimate.ok
    np.testing.assert_allclose(estimate.cur_from_prev, np.eye(4), atol=1e-9)


def traced_peak(function):
    """Peak memory (bytes) of Python and NumPy during a call."""
    gc.collect()
    tracemalloc.start()
    try:
        function()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "layout", [np.asarray, strided, lambda a: a.astype(np.float32)]
)
def test_floats_are_not_copied(layout):
    prev = layout(random_points(100000))
    small = 100000  # bytes; a copy takes at least 12 times as much
    assert traced_peak(lambda: rgbd_pose.estimate_motion(prev, prev)) < small


def test_whole_numbers_are_copied():
    """Shows that the test above would detect a copy."""
    prev = np.ones((100000, 3), np.int64)
    assert traced_peak(
        lambda: rgbd_pose.estimate_motion(prev, prev)
    ) > prev.nbytes


def test_results_are_views_that_outlive_the_estimate():
    estimate = rgbd_pose.estimate_motion(PREV, CUR)
    for name in ("weights", "inliers", "residual_norms", "residual_degrees"):
        assert np.shares_memory(getattr(estimate, name),
                                getattr(estimate, name))
    weights = estimate.weights
    before = weights.copy()
    del estimate
    gc.collect()
    rgbd_pose.estimate_motion(CUR, PREV)
    np.testing.assert_array_equal(weights, before)


@pytest.mark.parametrize(
    "name", ["weights", "inliers", "cur_from_prev", "covariance"]
)
def test_results_are_not_to_be_written(name):
    array = getattr(rgbd_pose.estimate_motion(PREV, CUR), name)
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 0


def test_input_is_left_alone():
    prev, cur = PREV.copy(), CUR.copy()
    prev.setflags(write=False)
    rgbd_pose.estimate_motion(prev, cur)
    np.testing.assert_array_equal(cur, CUR)


@pytest.mark.parametrize(
    "arguments, options, words",
    [
        ((PREV.T, CUR.T), {}, r"points_prev: has shape \(3, 100\); .*\(N, 3\)"),
        ((PREV, CUR[0]), {}, r"points_cur: has shape \(3,\); .*\(N, 3\)"),
        ((PREV, CUR[:9]), {}, "points_prev has 100 rows and points_cur 9"),
        ((PREV.astype(str), CUR), {}, "points_prev: holds <U"),
        ((PREV, CUR * 1j), {}, "points_cur: holds complex128"),
        ((PREV > 0, CUR), {}, "points_prev: holds bool"),
        ((None, CUR), {}, "points_prev: holds object"),
        (([[1, 2, 3], [4]], CUR), {}, "points_prev: is not an array of"),
        ((PREV, CUR), {"cost": "x"}, "unknown cost 'x'; available: bidirec"),
        ((PREV, CUR), {"loss": "huber(x)"}, r"loss 'huber\(x\)': the width"),
        ((PREV, CUR), {"loss": "x"}, "unknown loss 'x'; available: none, "),
        ((PREV, CUR), {"loss": "tukey,none"}, "2 losses for 1 costs"),
        ((PREV, CUR), {"scale": "x"}, "unknown scale 'x'; available: fixed"),
        ((PREV, CUR), {"robust_schedule": "x"}, "unknown robust schedule"),
        ((PREV, CUR), {"assembly": "x"}, "unknown assembly"),
        ((PREV, CUR), {"depth_noise": "x"}, "unknown depth noise"),
        ((PREV, CUR), {"initial_guess": "x"}, "unknown initial guess 'x'"),
        ((PREV, CUR), {"initial_guess": np.eye(3)},
         r"initial_guess: has shape \(3, 3\)"),
        ((PREV, CUR), {"initial_guess": 2 * np.eye(4)},
         "initial_guess: is not a rigid motion"),
        ((PREV, CUR), {"initial_guess": np.diag([1, 1, -1, 1])},
         "initial_guess: is not a rigid motion"),
        ((PREV, CUR), {"initial_guess": np.full((4, 4), np.nan)},
         "initial_guess: is not a rigid motion"),
        ((PREV, CUR), {"sigma_px": 0.0}, "sigma_px must be a positive"),
        ((PREV, CUR), {"sigma_px": np.nan}, "sigma_px must be a positive"),
        ((PREV, CUR), {"normals_cur": PREV[:3]}, "normals_cur 3; row i"),
        ((PREV, CUR), {"prior": np.eye(4)}, "prior: must be a pair"),
        ((PREV, CUR), {"prior": (np.eye(4), np.eye(5))}, r"prior\[1\]: has"),
        ((PREV, CUR), {"prior": (np.eye(4), np.full((6, 6), np.nan))},
         r"prior\[1\]: is not finite and symmetric"),
        ((PREV, CUR), {"prior": (np.eye(4), np.tri(6))},
         r"prior\[1\]: is not finite and symmetric"),
        ((PREV, CUR), {"prior": (np.eye(4), -np.eye(6))},
         r"prior\[1\]: is not positive definite"),
        ((PREV, CUR), {"max_iterations": 0}, "max_iterations must be"),
        ((PREV, CUR), {"threads": 0}, "threads must be at least 1"),
        ((PREV, CUR), {"threads": 10**6}, "threads must not exceed 256"),
    ],
)
def test_bad_arguments_are_told_in_one_line(arguments, options, words):
    with pytest.raises(rgbd_pose.InputError, match=words) as error:
        rgbd_pose.estimate_motion(*arguments, **options)
    assert isinstance(error.value, ValueError)
    assert "\n" not in str(error.value)


def test_pixels_need_a_camera():
    with pytest.raises(TypeError):
        rgbd_pose.estimate_motion_pixels(PREV, CUR, None)
    with pytest.raises(TypeError):
        rgbd_pose.estimate_motion_pixels(PREV, CUR)
