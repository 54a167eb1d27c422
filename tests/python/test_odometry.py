"""Odometry, compared with the program rgbd_odometry, and with bad frames."""

import csv
import warnings

import numpy as np
import pytest

import rgbd_pose
from conftest import run_program, track_all


@pytest.fixture(scope="module")
def dataset(sequence, camera):
    return rgbd_pose.Recording(sequence, camera)


# akaze and sift behave like orb here, but are slow.
@pytest.mark.parametrize("frontend", ["patch", "klt", "orb"])
def test_tracks_as_the_program_does(
    frontend, sequence, dataset, camera, tmp_path
):
    run_program(
        "rgbd_odometry", f"--dataset={sequence}", "--threads=1",
        f"--camera={sequence}/camera.yaml", f"--frontend={frontend}",
        f"--output={tmp_path}/run", "--noreport",
    )
    with open(tmp_path / "run/frames.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(dataset)

    odometry = rgbd_pose.Odometry(camera, frontend)
    # All images share one memory, as with cameras: nothing may be kept of it.
    gray = np.empty((camera.height, camera.width), np.uint8)
    depth = np.empty((camera.height, camera.width), np.uint16)
    for frame, row in zip(dataset, rows):
        gray[:], depth[:] = frame.gray, frame.depth
        tracked = odometry.track(gray, depth, frame.timestamp)
        gray[:], depth[:] = 0, 0
        assert tracked.index == frame.index
        assert f"{tracked.timestamp:.6f}" == row["timestamp"]
        assert f"{tracked.sigma:.4f}" == row["sigma"]
        for name in ("status", "reason", "segment", "reference", "matches",
                     "inliers", "iterations"):
            assert str(getattr(tracked, name)) == row[name], name
        assert str(int(tracked.is_reference)) == row["is_reference"]
        assert tracked.track_ms > 0.0
    odometry.save_trajectory(tmp_path / "trajectory.txt")
    assert (tmp_path / "trajectory.txt").read_bytes() == (
        tmp_path / "run/trajectory.txt"
    ).read_bytes()


def late_depth(folder, flag):
    """The camera and the frames of a sequence whose depth is 15 ms late."""
    run_program(
        "rgbd_simulate", "--path=handheld", "--frames=4", f"--{flag}=0.015",
        f"--output={folder}/late",
    )
    camera = rgbd_pose.Camera.load(folder / "late/camera.yaml")
    return camera, list(rgbd_pose.Recording(folder / "late", camera))


def last_pose(camera, frames, delay, **settings):
    odometry = rgbd_pose.Odometry(camera, **settings)
    for frame in frames:
        pose = odometry.track(
            frame.gray, frame.depth, frame.timestamp, depth_delay=delay
        ).world_from_cam
    return pose


def test_depth_of_another_time_is_moved(tmp_path):
    camera, frames = late_depth(tmp_path, "depth_delay")
    delays = [frame.depth_delay for frame in frames]
    assert delays == pytest.approx([0.015] * 4, abs=1e-6)
    as_it_comes = last_pose(camera, frames, 0.0)
    ignored = last_pose(camera, frames, 0.015, shutter="none")
    assert np.array_equal(ignored, as_it_comes)
    assert np.abs(last_pose(camera, frames, 0.015) - as_it_comes).max() > 1e-4


def test_arrays_are_exposed_as_the_camera_says(tmp_path):
    camera, frames = late_depth(tmp_path, "depth_time_offset")
    assert camera.depth_time_offset == 0.015
    unaware = rgbd_pose.Camera(
        camera.fx, camera.fy, camera.cx, camera.cy,
        depth_scale=camera.depth_scale,
    )
    assert [frame.depth_delay for frame in frames] == [0.0] * 4
    told = last_pose(camera, frames, 0.0)
    # A delay given by the camera or by the frame has the same effect.
    np.testing.assert_array_equal(told, last_pose(unaware, frames, 0.015))
    assert np.abs(told - last_pose(unaware, frames, 0.0)).max() > 1e-4


def test_settings_are_those_of_the_program(
    sequence, dataset, camera, tmp_path
):
    settings = {
        "tracker": "features",  # with pixel costs, some settings have no effect
        "cost": "reprojection_depth", "loss": "huber", "scale": "mad",
        "robust_schedule": "direct", "initial_guess": "ransac",
        "on_lost": "hold", "depth_noise": "nguyen", "assembly": "per_match",
        "max_features": 200,
    }
    run_program(
        "rgbd_odometry", f"--dataset={sequence}",
        f"--camera={sequence}/camera.yaml", f"--output={tmp_path}/run",
        "--noreport", *(f"--{key}={value}" for key, value in settings.items()),
    )
    odometry = rgbd_pose.Odometry(camera, **settings)
    track_all(odometry, dataset)
    odometry.save_trajectory(tmp_path / "trajectory.txt")
    expected = (tmp_path / "run/trajectory.txt").read_bytes()
    assert (tmp_path / "trajectory.txt").read_bytes() == expected
    # Each setting has an effect, except assembly, which is the same problem,
    # on_lost, since no frame is lost, and initial_guess: here it moves the start
    # of the solver, not its result.
    for key in settings.keys() - {"assembly", "on_lost", "initial_guess"}:
        other = {k: v for k, v in settings.items() if k != key}
        odometry = rgbd_pose.Odometry(camera, **other)
        track_all(odometry, dataset)
        odometry.save_trajectory(tmp_path / "other.txt")
        assert (tmp_path / "other.txt").read_bytes() != expected, key


def test_trajectory(dataset, camera):
    odometry = rgbd_pose.Odometry(camera)
    stamps, poses = odometry.trajectory
    assert stamps.shape == (0,) and poses.shape == (0, 4, 4)
    frames = track_all(odometry, dataset)
    stamps, poses = odometry.trajectory
    np.testing.assert_array_equal(stamps, [f.timestamp for f in frames])
    np.testing.assert_array_equal(poses, [f.world_from_cam for f in frames])
    np.testing.assert_array_equal(poses[0], np.eye(4))


def test_covariance(dataset, camera):
    frames = track_all(rgbd_pose.Odometry(camera), dataset)
    assert frames[0].covariance is None and frames[0].reference == -1
    for frame in frames[1:]:
        assert frame.covariance.shape == (6, 6)
        deviation = np.sqrt(np.diag(frame.covariance))
        assert (deviation > 1e-6).all() and (deviation < 0.01).all()
        np.linalg.cholesky(frame.covariance)
        edge = frame.edges[0]
        assert (edge.ref, edge.cur) == (frame.reference, frame.index)
        np.testing.assert_array_equal(edge.covariance, frame.covariance)
        np.testing.assert_allclose(
            edge.cur_from_ref,
            np.linalg.inv(frame.world_from_cam)
            @ frames[edge.ref].world_from_cam,
            atol=1e-12,
        )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_depth_in_metres_is_the_same(dataset, camera, dtype):
    raw = rgbd_pose.Odometry(camera)
    track_all(raw, dataset)
    metric = rgbd_pose.Odometry(camera)
    for f in dataset:
        metres = f.depth.astype(dtype) / dtype(camera.depth_scale)
        metres[f.depth == 0] = np.nan
        metres[0, :5] = [np.inf, -np.inf, -1.0, 20.0, 13.107]
        metric.track(f.gray, metres, f.timestamp)
    np.testing.assert_array_equal(metric.trajectory[1], raw.trajectory[1])


def test_depth_scale_is_the_cameras(dataset, camera):
    millimetres = rgbd_pose.Camera(
        camera.fx, camera.fy, camera.cx, camera.cy, depth_scale=1000.0
    )
    odometry = rgbd_pose.Odometry(millimetres)
    for f in dataset:
        depth = np.round(f.depth / 5.0).astype(np.uint16)
        odometry.track(f.gray, depth, f.timestamp)
    plain = rgbd_pose.Odometry(camera)
    track_all(plain, dataset)
    np.testing.assert_allclose(
        odometry.trajectory[1], plain.trajectory[1], atol=2e-3
    )
    assert (odometry.trajectory[1] != plain.trajectory[1]).any()


def colourful(gray):
    """An RGB image whose channels differ and vary over the image."""
    shift = np.arange(gray.shape[1]) % 64
    channels = [gray, np.roll(gray, 3, axis=0) // 2 + shift, 255 - gray]
    return np.stack(channels, axis=-1).astype(np.uint8)


def test_colour_is_red_green_blue(dataset, camera):
    def trajectory(image_of):
        odometry = rgbd_pose.Odometry(camera)
        for f in dataset:
            odometry.track(image_of(colourful(f.gray)), f.depth, f.timestamp)
        return odometry.trajectory[1]

    def gray(rgb):
        weighted = rgb.astype(np.int64) @ [9798, 19235, 3735]
        return ((weighted + (1 << 14)) >> 15).astype(np.uint8)

    expected = trajectory(gray)
    np.testing.assert_array_equal(trajectory(lambda rgb: rgb), expected)
    # BGR in reverse, a view with a negative stride.
    np.testing.assert_array_equal(
        trajectory(lambda rgb: rgb[..., ::-1].copy()[..., ::-1]), expected
    )
    assert (trajectory(lambda rgb: rgb[..., ::-1]) != expected).any()


def test_a_lost_frame_is_a_status(dataset, camera):
    odometry = rgbd_pose.Odometry(camera, on_lost="hold")
    first = dataset[0]
    odometry.track(first.gray, first.depth, 0.0)
    black, nothing = np.zeros_like(first.gray), np.zeros_like(first.depth)
    lost = odometry.track(black, nothing, 0.1)
    assert lost.status == "lost" and lost.reason != ""
    assert lost.covariance is None
    assert "lost" in repr(lost)
    again = odometry.track(first.gray, first.depth, 0.2)
    assert again.status == "ok"
    np.testing.assert_array_equal(odometry.trajectory[0], [0.0, 0.2])


def test_time_stamps(dataset, camera):
    odometry = rgbd_pose.Odometry(camera)
    f = dataset[0]
    assert odometry.track(f.gray, f.depth).timestamp == 0.0
    assert odometry.track(f.gray, f.depth).timestamp == 1.0 / 30.0
    assert odometry.track(f.gray, f.depth, 5).timestamp == 5.0
    for bad, words in (
        (5.0, "not after"),
        (4.0, "not after"),
        (np.nan, "not a finite"),
        (np.inf, "not a finite"),
    ):
        with pytest.raises(rgbd_pose.InputError, match=f"timestamp: .*{words}"):
            odometry.track(f.gray, f.depth, bad)
    for bad in (np.nan, np.inf):
        with pytest.raises(rgbd_pose.InputError, match="depth_delay: is not a"):
            odometry.track(f.gray, f.depth, 6.0, depth_delay=bad)
    assert odometry.track(f.gray, f.depth, 6.0).index == 3
    with pytest.raises(rgbd_pose.InputError, match="not a finite"):
        rgbd_pose.Odometry(camera).track(f.gray, f.depth, np.nan)


def test_depth_of_one_channel(dataset, camera):
    flat = rgbd_pose.Odometry(camera)
    deep = rgbd_pose.Odometry(camera)
    for k in (0, 1):
        f = dataset[k]
        a = flat.track(f.gray, f.depth)
        b = deep.track(f.gray[:, :, None], f.depth[:, :, None])
        assert np.array_equal(a.world_from_cam, b.world_from_cam)
        assert b.matches == a.matches


def test_depth_of_any_byte_order(dataset, camera):
    poses = []
    for dtype in ("<u2", ">u2"):
        odometry = rgbd_pose.Odometry(camera)
        for frame in (dataset[0], dataset[4]):
            tracked = odometry.track(frame.gray, frame.depth.astype(dtype))
        poses.append(tracked.world_from_cam)
    np.testing.assert_array_equal(*poses)


def test_motion_guess(dataset, camera):
    odometry = rgbd_pose.Odometry(camera)
    for f in (dataset[0], dataset[1]):
        tracked = odometry.track(f.gray, f.depth, motion_guess=np.eye(4))
        assert tracked.status == "ok"
    # An image that is sent again shows no motion.
    tracked = odometry.track(f.gray, f.depth)
    assert tracked.status == "degraded"
    assert tracked.reason == "an image of it is that of the frame before"
    with pytest.raises(rgbd_pose.InputError, match="motion_guess: has shape"):
        odometry.track(f.gray, f.depth, motion_guess=np.eye(3))


IMAGE = np.zeros((480, 640), np.uint8)
DEPTH = np.zeros((480, 640), np.uint16)


@pytest.mark.parametrize(
    "image, depth, words",
    [
        (IMAGE.T, DEPTH, r"image: is uint8 of shape \(640, 480\); .*480 x 640"),
        (IMAGE * 1.0, DEPTH, "image: is float64 of shape"),
        (np.zeros((480, 640, 4), np.uint8), DEPTH, "image: is uint8 of shape"),
        (IMAGE, DEPTH[:-1], r"depth: is uint16 of shape \(479, 640\)"),
        (IMAGE, DEPTH.astype(np.int32), "depth: is int32"),
        (IMAGE, np.zeros((480, 640, 2), np.uint16), "depth: is uint16"),
        (IMAGE, IMAGE, "depth: is uint8 of shape"),
        (None, DEPTH, "image: is object"),
    ],
)
def test_wrong_images_are_told_in_one_line(camera, image, depth, words):
    odometry = rgbd_pose.Odometry(camera)
    with pytest.raises(rgbd_pose.InputError, match=words) as error:
        odometry.track(image, depth)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("settings, words", [
    ({"frontend": "x"}, "unknown frontend 'x'"),
    ({"on_lost": "x"}, "unknown policy 'x'"),
])
def test_unknown_names(camera, settings, words):
    with pytest.raises(rgbd_pose.InputError, match=words):
        rgbd_pose.Odometry(camera, **settings)


def test_images_are_arrays_that_outlive_their_frame(dataset):
    gray = dataset[3].gray
    assert gray.shape == (480, 640) and gray.dtype == np.uint8
    assert gray.std() > 10.0
    assert dataset[3].depth.dtype == np.uint16


@pytest.mark.parametrize("type", ["uint16", "float32"])
def test_depth_in_wrong_units_is_said_once(type, dataset, camera):
    camera = rgbd_pose.Camera(
        camera.fx, camera.fy, camera.cx, camera.cy,
        width=camera.width, height=camera.height,
    )  # raw depth of 0.2 mm
    odometry = rgbd_pose.Odometry(camera)
    # Millimetres, of a scene nearer than 1.5 m.
    scale = 1000 * 1.2 / np.median(dataset[0].depth)
    frames = [(f.gray, (scale * f.depth).astype(type)) for f in list(dataset)[:2]]
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default")
        for gray, depth in frames:
            odometry.track(gray, depth)
    assert len(said) == 1 and said[0].filename == __file__
    assert "check the depth scale" in str(said[0].message)


def test_an_unusual_camera_is_said_once(dataset, camera):
    camera = rgbd_pose.Camera(
        camera.fx, 0.9 * camera.fy, camera.cx, camera.cy,
        width=camera.width, height=camera.height,
        depth_scale=camera.depth_scale,
    )
    odometry = rgbd_pose.Odometry(camera)
    with pytest.warns(UserWarning, match="fx .* and fy .* differ") as said:
        for frame in list(dataset)[:2]:
            odometry.track(frame.gray, frame.depth)
    assert len(said) == 1


def test_a_warning_as_an_error_changes_nothing(dataset, camera):
    odometry = rgbd_pose.Odometry(camera)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning, match="check the depth scale"):
            odometry.track(dataset[0].gray, dataset[0].depth // 20)
        assert odometry.track(dataset[0].gray, dataset[0].depth).index == 0
