"""Exports, compared with those of the program rgbd_export."""

import filecmp
import os
import signal

import numpy as np
import pytest

import rgbd_pose
from conftest import run_program

COARSE = {"voxel": 0.04}


@pytest.fixture(scope="module")
def run(sequence, tmp_path_factory):
    """Folder of the results of rgbd_odometry."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    run_program(
        "rgbd_odometry", f"--dataset={sequence}", "--noreport",
        f"--output={folder}",
    )
    return folder


@pytest.fixture(scope="module")
def recording(sequence):
    return rgbd_pose.Recording(sequence)


def by_program(run, name, output):
    return run_program(
        "rgbd_export", f"--run={run}", f"--to={name}", f"--output={output}",
        "--voxel=0.04",
    )


def assert_same(one, other):
    if os.path.isfile(one):
        assert filecmp.cmp(one, other, shallow=False)
        return
    names = sorted(os.listdir(one))
    assert names == sorted(os.listdir(other)) and names
    for name in names:
        assert_same(os.path.join(one, name), os.path.join(other, name))


@pytest.mark.parametrize("name", rgbd_pose.export_formats())
def test_is_that_of_the_program(name, run, recording, tmp_path):
    ending = {"mesh": ".glb", "cloud": ".ply"}.get(name, "")
    theirs, ours = tmp_path / f"theirs{ending}", tmp_path / f"ours{ending}"
    said = by_program(run, name, theirs)
    written = rgbd_pose.export_run(run, name, ours, **COARSE)
    assert_same(ours, theirs)
    assert written.path == os.fspath(written) == str(ours)
    assert written.summary == said.replace(str(theirs), str(ours))
    assert repr(written) == f"Export({str(ours)!r})"
    if name in ("g2o", "mcap"):
        return  # a path has no graph and no covariances
    path = tmp_path / f"path{ending}"
    of_run = run / "trajectory.txt"
    rgbd_pose.export_path(recording, of_run, name, path, **COARSE)
    assert_same(path, theirs)


def test_a_path_that_was_tracked_here(recording, tmp_path, monkeypatch):
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    odometry = rgbd_pose.Odometry(recording.camera)
    for frame in recording:
        odometry.track(frame.gray, frame.depth, frame.timestamp)
    mesh = rgbd_pose.export_path(
        recording, odometry.trajectory, "mesh", tmp_path / "room.ply",
        min_distance=0, **COARSE,
    )
    assert "triangles of 8 frames" in mesh.summary
    with open(mesh, "rb") as file:
        assert file.read(3) == b"ply"
    stamps, poses = odometry.trajectory
    part = rgbd_pose.export_path(
        recording, (stamps[2:5], poses[2:5]), "mesh", tmp_path / "part.ply",
        min_distance=0, **COARSE,
    )
    assert "triangles of 3 frames" in part.summary
    assert not os.listdir(), "files that nobody asked for"


@pytest.mark.parametrize("name", ["mesh", "tum", "g2o"])
def test_a_map_is_exported_as_by_the_program(name, sequence, tmp_path):
    run_program(
        "rgbd_slam", f"--dataset={sequence}", "--noreport",
        f"--output={tmp_path / 'run'}", f"--save_map={tmp_path / 'map'}",
    )
    theirs, ours = tmp_path / "theirs.ply", tmp_path / "ours.ply"
    run_program(
        "rgbd_export", f"--map={tmp_path / 'map'}", f"--to={name}",
        f"--output={theirs}", "--voxel=0.04",
    )
    rgbd_pose.export_map(tmp_path / "map", name, ours, **COARSE)
    assert_same(ours, theirs)
    with pytest.raises(rgbd_pose.InputError, match="map's own folder"):
        rgbd_pose.export_map(tmp_path / "map", name, tmp_path / "map" / "x.ply")


def test_a_name_of_its_own(run):
    written = rgbd_pose.export_run(run, "tum")
    assert written.path == str(run / "trajectory_tum.txt")
    stamps, poses = rgbd_pose.read_trajectory(written)
    np.testing.assert_allclose(
        poses, rgbd_pose.read_trajectory(run / "trajectory.txt")[1], atol=1e-8
    )


def test_a_name_that_is_not_utf_8(run, tmp_path):
    output = tmp_path / os.fsdecode(b"caf\xe9.txt")
    written = rgbd_pose.export_run(run, "tum", output)
    assert written.path == str(output)
    assert "8 poses in" in written.summary


def test_says_what_is_wrong(run, recording, sequence, tmp_path):
    path = run / "trajectory.txt"

    def of_run(folder=run, to="tum", output=tmp_path / "out", **settings):
        rgbd_pose.export_run(folder, to, output, **settings)

    own = f"{sequence}/groundtruth.txt"

    def of_path(trajectory=path, to="mesh", output=tmp_path / "out.ply"):
        rgbd_pose.export_path(recording, trajectory, to, output)

    rgbd_pose.export_run(run, "kitti", tmp_path / "full")
    late = (np.array([1e6]), np.eye(4)[None])
    for match, export in [
        ("no such folder", lambda: of_run(tmp_path / "none")),
        ("has no frames.csv", lambda: of_run(sequence)),
        ("unknown format 'obj'", lambda: of_run(to="obj")),
        ("recording's own folder", lambda: of_path(to="tum", output=own)),
        ("max_points must be 8", lambda: of_run(max_points=1)),
        ("min_angle must not be negative", lambda: of_run(min_angle=-1.0)),
        ("max_depth must not be", lambda: of_run(to="mesh", max_depth=-1)),
        ("max_depth must not be", lambda: of_run(to="cloud", max_depth=np.nan)),
        ("is not empty", lambda: of_run(to="kitti", output=tmp_path / "full")),
        ("/none, does not exist",
         lambda: of_run(to="cloud", output=tmp_path / "a.ply", dataset="/none")),
        ("no measured motions", lambda: of_path(to="g2o")),
        ("output", lambda: of_path(to="tum", output="")),
        ("no frame at 1000000", lambda: of_path(late)),
        ("trajectory", lambda: of_path(np.eye(4))),
        ("no poses", lambda: of_path((np.zeros(0), np.zeros((0, 4, 4))))),
    ]:
        with pytest.raises(rgbd_pose.InputError, match=match) as error:
            export()
        assert "\n" not in str(error.value)
    with pytest.raises(TypeError, match=r"export_run\(\) got .* 'size'"):
        of_run(size=3)
    with pytest.raises(TypeError, match=r"voxel must be float"):
        of_run(voxel="fine")
    assert sorted(os.listdir(tmp_path)) == ["full"]


def test_can_be_interrupted(run, recording, tmp_path):
    def stop(number, frame):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        with pytest.raises(KeyboardInterrupt):
            rgbd_pose.export_run(
                run, "colmap", tmp_path / "out", min_distance=0
            )
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert not os.listdir(tmp_path)
