"""Slam, compared with the program rgbd_slam; maps; calls in wrong order."""

import csv

import numpy as np
import pytest

import rgbd_pose
from conftest import run_program, track_all


@pytest.fixture(scope="module")
def sequence(tmp_path_factory):
    """Eight frames, far enough apart for each to become a keyframe."""
    folder = tmp_path_factory.mktemp("data") / "steps"
    run_program(
        "rgbd_simulate", "--path=handheld", "--frames=8", "--rate=3",
        f"--output={folder}",
    )
    return folder


@pytest.fixture(scope="module")
def camera(sequence):
    return rgbd_pose.Camera.load(sequence / "camera.yaml")


@pytest.fixture(scope="module")
def frames(sequence, camera):
    return list(rgbd_pose.Recording(sequence, camera))


# The map's update for a keyframe is applied within these frames.
SETTINGS = {"update_delay": 1, "window": 4, "max_pairs": 6}


@pytest.fixture(scope="module")
def mapped(frames, camera, tmp_path_factory):
    """A finished Slam, its frames and the folder of its map."""
    slam = rgbd_pose.Slam(camera, **SETTINGS)
    tracked = track_all(slam, frames)
    slam.finish()
    folder = tmp_path_factory.mktemp("maps") / "map"
    slam.save_map(folder)
    return slam, tracked, folder


def test_maps_as_the_program_does(mapped, sequence, tmp_path):
    slam, tracked, folder = mapped
    run_program(
        "rgbd_slam", f"--dataset={sequence}", "--noreport",
        f"--camera={sequence}/camera.yaml", f"--output={tmp_path}/run",
        f"--save_map={tmp_path}/map",
        *(f"--{name}={value}" for name, value in SETTINGS.items()),
    )
    slam.save_trajectory(tmp_path / "trajectory.txt")
    assert (tmp_path / "trajectory.txt").read_bytes() == (
        tmp_path / "run/trajectory.txt"
    ).read_bytes()
    assert (folder / "map.txt").read_bytes() == (
        tmp_path / "map/map.txt"
    ).read_bytes()
    with open(tmp_path / "run/slam.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for row, frame in zip(rows, tracked, strict=True):
        for name in ("status", "segment", "pairs", "loops", "joined"):
            assert str(getattr(frame, name)) == row[name]
        for name in ("odom", "map"):
            pose = {"odom": frame.odom_from_cam, "map": frame.map_from_odom}
            position = [float(row[f"{name}_t{axis}"]) for axis in "xyz"]
            np.testing.assert_allclose(pose[name][:3, 3], position, atol=1e-8)
    assert sum(frame.pairs for frame in tracked) > 2
    with open(tmp_path / "run/keyframes.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for row, keyframe in zip(rows, slam.keyframes(), strict=True):
        assert str(keyframe.id) == row["keyframe"]
        assert f"{keyframe.covariance[5, 5]:.9g}" == row["cov_cz_cz"]


def test_poses_hang_together(mapped, frames):
    slam, tracked, _ = mapped
    for frame in tracked:
        assert isinstance(frame, rgbd_pose.TrackedFrame)
        np.testing.assert_allclose(
            frame.map_from_cam, frame.map_from_odom @ frame.odom_from_cam,
            atol=1e-12,
        )
        assert frame.segment == 0 and frame.error == ""
    stamps, poses = slam.trajectory
    np.testing.assert_array_equal(stamps, [f.timestamp for f in frames])
    keyframes = {k.id: k for k in slam.keyframes()}
    assert len(keyframes) > 2
    for index, keyframe in keyframes.items():
        assert tracked[index].is_reference
        assert keyframe.timestamp == frames[index].timestamp
        np.testing.assert_allclose(
            keyframe.map_from_cam, poses[index], atol=1e-9
        )
    edges = slam.edges()
    assert len(edges) >= len(keyframes)
    for edge in edges:
        between = np.linalg.inv(keyframes[edge.cur].map_from_cam)
        between = between @ keyframes[edge.ref].map_from_cam
        np.testing.assert_allclose(edge.cur_from_ref, between, atol=2e-3)
        np.linalg.cholesky(edge.covariance)


def test_results_say_what_they_are(mapped):
    slam, tracked, _ = mapped
    frame, keyframe, edge = tracked[-1], slam.keyframes()[-1], slam.edges()[0]
    assert repr(frame) == (
        f"SlamFrame({frame.index}: ok, {frame.inliers} of {frame.matches} "
        f"matches agree, pairs={frame.pairs}, loops={frame.loops})"
    )
    x, y, z = keyframe.map_from_cam[:3, 3]
    assert repr(keyframe) == (
        f"Keyframe({keyframe.id} at {keyframe.timestamp:.6f} s: segment 0, "
        f"centre {x:.3f} {y:.3f} {z:.3f} m)"
    )
    metres = np.linalg.norm(edge.cur_from_ref[:3, 3])
    assert repr(edge).startswith(
        f"RelativePose({edge.ref} to {edge.cur}: {metres:.4f} m, "
    )


def test_a_place_is_found_again(mapped, frames, camera):
    slam, _, folder = mapped
    before = (folder / "map.txt").read_bytes()
    again = rgbd_pose.Slam(camera, **SETTINGS)
    again.load_map(folder, localise_only=True)
    tracked = track_all(again, frames[3:6])
    again.finish()
    assert sum(frame.joined for frame in tracked) == 1
    np.testing.assert_allclose(
        again.trajectory[1], slam.trajectory[1][3:6], atol=2e-3
    )
    with pytest.raises(rgbd_pose.InputError, match="save_map: localise_only"):
        again.save_map(folder)
    assert (folder / "map.txt").read_bytes() == before


def test_a_map_is_gone_on_with(mapped, frames, camera, tmp_path):
    slam, _, folder = mapped
    again = rgbd_pose.Slam(camera, **SETTINGS)
    again.load_map(str(folder))
    track_all(again, frames[3:6])
    again.finish()
    again.save_map(tmp_path / "grown")
    third = rgbd_pose.Slam(camera)
    third.load_map(tmp_path / "grown")
    third.finish()
    names = [k.id for k in third.keyframes()]
    assert names == [k.id for k in again.keyframes()]
    assert set(names) >= {k.id for k in slam.keyframes()}
    assert {k.segment for k in third.keyframes()} == {0}


def test_calls_out_of_turn(frames, camera, tmp_path):
    slam = rgbd_pose.Slam(camera)
    slam.track(frames[0].gray, frames[0].depth)
    for call in (
        slam.keyframes, slam.edges, lambda: slam.save_map(tmp_path / "map")
    ):
        with pytest.raises(rgbd_pose.InputError, match=r"finish\(\)"):
            call()
    assert not (tmp_path / "map").exists()
    with pytest.raises(rgbd_pose.InputError, match="before the first frame"):
        slam.load_map(tmp_path)
    with pytest.raises(rgbd_pose.InputError, match="timestamp: .* after"):
        slam.track(frames[0].gray, frames[0].depth, 0.0)
    slam.finish()
    slam.finish()
    assert len(slam.trajectory[0]) == len(slam.keyframes()) == 1
    with pytest.raises(rgbd_pose.InputError, match=r"finish\(\) was called"):
        slam.track(frames[0].gray, frames[0].depth)


def test_a_map_that_does_not_fit(mapped, camera, tmp_path):
    with pytest.raises(rgbd_pose.InputError, match=str(tmp_path)):
        rgbd_pose.Slam(camera).load_map(tmp_path)
    other = rgbd_pose.Camera(500.0, 500.0, camera.cx, camera.cy)
    with pytest.raises(rgbd_pose.InputError, match="map: .*camera"):
        rgbd_pose.Slam(other).load_map(mapped[2])


def test_settings(camera):
    with pytest.raises(TypeError, match=r"Slam\(\) got an unexpected .*'tempo'"):
        rgbd_pose.Slam(camera, tempo=3)
    with pytest.raises(TypeError, match="max_pairs must be int"):
        rgbd_pose.Slam(camera, max_pairs="many")
    with pytest.raises(rgbd_pose.InputError, match="update_delay"):
        rgbd_pose.Slam(camera, update_delay=-1)
    with pytest.raises(rgbd_pose.InputError, match="frontend"):
        rgbd_pose.Slam(camera, "fast")
