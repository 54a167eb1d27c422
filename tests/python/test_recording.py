"""Recordings of all kinds as sequences of frames."""

import contextlib
import os
import shutil
import sqlite3
import struct
import warnings

import numpy as np
import pytest

import rgbd_pose


@pytest.fixture(scope="module")
def whole(sequence):
    return list(rgbd_pose.Recording(sequence))


def test_brings_its_camera_and_its_path(sequence, camera, whole):
    recording = rgbd_pose.Recording(sequence)
    assert recording.camera.fx == camera.fx
    assert recording.camera.depth_scale == camera.depth_scale
    stamps, poses = recording.ground_truth()
    assert poses.shape == (len(whole), 4, 4)
    np.testing.assert_allclose(stamps, recording.timestamps, atol=1e-6)
    np.testing.assert_array_equal(
        recording.timestamps, [frame.timestamp for frame in whole]
    )
    for array in (recording.timestamps, stamps, poses, whole[0].gray):
        assert not array.flags.writeable


def test_each_loop_reads_it_anew(sequence):
    recording = rgbd_pose.Recording(sequence, frames="1-3")
    first = [frame.timestamp for frame in recording]
    again = [frame.timestamp for frame in recording]
    assert first == again and len(first) == 3


def test_parts_are_numbered_from_zero(sequence, whole):
    part = list(rgbd_pose.Recording(sequence, frames="2-6:2"))
    assert [frame.index for frame in part] == [0, 1, 2]
    assert [frame.timestamp for frame in part] == [
        whole[i].timestamp for i in (2, 4, 6)
    ]


def test_undoes_what_a_calibration_found(sequence, whole, tmp_path):
    text = (sequence / "camera.yaml").read_text()
    calibrated = tmp_path / "camera.yaml"
    calibrated.write_text(text + "inverse_depth_offset: 0.05\n")
    raw = whole[0].depth
    scale = rgbd_pose.Camera.load(calibrated).depth_scale
    seen = (raw > 0) & (raw < 65535)
    expected = 1 / (scale / raw[seen] + 0.05) * scale
    camera = rgbd_pose.Camera.load(calibrated)
    for frame in (
        next(iter(rgbd_pose.Recording(sequence, calibrated))),
        rgbd_pose.Recording(sequence, camera)[0],
    ):
        np.testing.assert_allclose(frame.depth[seen], expected, atol=0.51)


def test_finds_out_what_kind_it_is(sequence, camera, whole, tmp_path):
    for kind, name in (("rgb", "color"), ("depth", "depth")):
        images = sorted((sequence / kind).iterdir())
        for i, image in enumerate(images[:3]):
            shutil.copy(image, tmp_path / f"frame-{i:06}.{name}.png")
    with pytest.warns(UserWarning, match="30 frames per second are assumed"):
        recording = rgbd_pose.Recording(tmp_path, camera)
    frames = list(recording)
    np.testing.assert_allclose(recording.timestamps, np.arange(3) / 30)
    np.testing.assert_array_equal(frames[1].gray, whole[1].gray)
    assert len(recording.ground_truth()[0]) == 0
    with pytest.warns(UserWarning, match="frames per second"):
        scaled = rgbd_pose.Recording(tmp_path, "ros_default")
    assert scaled.camera.depth_scale == 1000


def test_warns_once_and_of_any_name(sequence, camera, tmp_path):
    folder = os.fsencode(tmp_path) + b"/caf\xe9"  # not UTF-8
    os.mkdir(folder)
    for kind, name in (("rgb", b"color"), ("depth", b"depth")):
        image = sorted((sequence / kind).iterdir())[0]
        shutil.copy(image, folder + b"/frame-000000.%s.png" % name)
    with pytest.warns(UserWarning) as said:
        recording = rgbd_pose.Recording(folder, camera)
        list(recording), list(recording), recording[0]
    assert len(said) == 1 and said[0].filename == __file__
    assert "/caf\ufffd: has no timestamps" in str(said[0].message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rgbd_pose.Recording(sequence)  # nothing to say


def test_warns_of_colour_without_depth(sequence, tmp_path):
    folder = tmp_path / "gaps"
    shutil.copytree(sequence, folder)
    lines = (folder / "depth.txt").read_text().splitlines(keepends=True)
    (folder / "depth.txt").write_text("".join(lines[:-2]))
    with pytest.warns(UserWarning, match="2 colour images have no depth"):
        rgbd_pose.Recording(folder)


def write_bag(path, seconds):
    """Writes a bag of ROS 2 with black images."""
    width, height = 48, 32
    little_endian = b"\0\1\0\0"

    def image(second, encoding, size):
        return struct.pack(
            "<4siII4sIII6sBxII", little_endian, second, 0, 4, b"cam", height,
            width, 6, encoding, 0, size * width, size * width * height,
        ) + bytes(size * width * height)

    def info(second):
        matrix = [40, 0, width / 2, 0, 40, height / 2, 0, 0, 1]
        return struct.pack(
            "<4siII4sIII10s2xI4x35d6IB", little_endian, second, 0, 4, b"cam",
            height, width, 10, b"plumb_bob", 5, *[0] * 5, *matrix, *[0] * 21,
            *[0] * 7,
        )

    with contextlib.closing(sqlite3.connect(path)) as bag, bag:
        bag.execute("CREATE TABLE topics (id INTEGER, name, type, "
                    "serialization_format, offered_qos_profiles)")
        bag.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, "
                    "topic_id INTEGER, timestamp INTEGER, data BLOB)")
        for topic, name in enumerate(("image", "depth", "camera_info")):
            kind = "CameraInfo" if name == "camera_info" else "Image"
            bag.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')",
                        (topic, f"/cam/{name}", f"sensor_msgs/msg/{kind}"))
        for second in seconds:
            for topic, message in enumerate((
                image(second, b"mono8", 1), image(second, b"16UC1", 2),
                info(second),
            )):
                bag.execute(
                    "INSERT INTO messages (topic_id, timestamp, data) "
                    "VALUES (?, ?, ?)", (topic, second * 10**9, message))


def test_warns_at_the_end_of_what_a_bag_has_shown(tmp_path):
    bag = tmp_path / "room.db3"
    write_bag(bag, [1, 2, 2, 3])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        frames = iter(rgbd_pose.Recording(bag))
        assert [next(frames).timestamp for _ in range(3)] == [1, 2, 3]
    with pytest.warns(UserWarning, match="2 images have the same time stamp"):
        assert next(frames, None) is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert next(frames, None) is None  # nothing twice


def test_refuses_what_it_cannot_read(sequence, tmp_path):
    for match, path, settings in [
        ("no such file or folder", tmp_path / "none", {}),
        ("not a supported recording", tmp_path, {}),
        ("unknown source 'lidar'", sequence, {"source": "lidar"}),
        ("frames", sequence, {"frames": "all"}),
        ("none of them", sequence, {"frames": "9999-"}),
        ("pairs.txt", sequence, {"associations": tmp_path / "pairs.txt"}),
        ("camera 'kinnect'", sequence, {"camera": "kinnect"}),
        ("depth_camera 'cam1': needs", sequence, {"depth_camera": "cam1"}),
    ]:
        with pytest.raises(rgbd_pose.InputError, match=match):
            rgbd_pose.Recording(path, **settings)


def test_says_which_path_is_wrong_whatever_its_name(tmp_path):
    missing = os.fsdecode(b"caf\xe9")  # not UTF-8
    with pytest.raises(rgbd_pose.InputError, match="caf.*: no such"):
        rgbd_pose.Recording(tmp_path / missing)
    with pytest.raises(rgbd_pose.InputError, match="null character"):
        rgbd_pose.write_trajectory(
            f"{tmp_path}/path\0.txt", ([0.0], [np.eye(4)])
        )
    assert os.listdir(tmp_path) == []


def test_has_a_length_and_frames_by_number(sequence, whole):
    recording = rgbd_pose.Recording(sequence, frames="2-6:2")
    assert len(recording) == 3
    for i, frame in ((1, whole[4]), (-1, whole[6]), (0, whole[2])):
        np.testing.assert_array_equal(recording[i].gray, frame.gray)
        assert recording[i].timestamp == frame.timestamp
    for index in (3, -4):
        with pytest.raises(IndexError, match=f"{index}: there are 3 frames"):
            recording[index]
    for part, numbers in (
        (recording[1:], [4, 6]), (recording[::2], [2, 6]), (recording[-1:], [6]),
        (recording[1:][:1], [4]),
    ):
        assert len(part) == len(numbers)
        for i, (frame, number) in enumerate(zip(part, numbers)):
            np.testing.assert_array_equal(frame.gray, whole[number].gray)
            assert frame.index == i and frame.timestamp == whole[number].timestamp
    for part, error in ((slice(None, None, -1), "forward"), (slice(3, 3), "no frames")):
        with pytest.raises(IndexError, match=error):
            recording[part]
    # A loop is not disturbed.
    loop = iter(recording)
    assert next(loop).index == 0 and recording[2].index == 2
    assert next(loop).index == 1


def test_frames_say_what_they_are(whole):
    frame = whole[3]
    height, width = frame.gray.shape
    assert repr(frame) == f"Frame(3 at {frame.timestamp:.6f} s, {width} x {height})"


def test_says_what_it_is(sequence, camera):
    size = f"{camera.width} x {camera.height}"
    recording = rgbd_pose.Recording(sequence, frames="2-6:2")
    assert repr(recording) == f"Recording({str(sequence)!r}, 3 frames, {size})"


def test_brings_its_inertial_samples(sequence, tmp_path):
    recording = rgbd_pose.Recording(sequence)
    imu = recording.imu()
    assert imu.shape[1] == 7
    np.testing.assert_allclose(np.diff(imu[:, 0]), 1 / 200, atol=1e-6)
    rows = np.loadtxt(sequence / "imu.csv", delimiter=",")
    np.testing.assert_allclose(imu, rows, atol=1e-9)
    np.testing.assert_allclose(
        np.linalg.norm(imu[:, 4:], axis=1).mean(), 9.81, atol=1.0
    )
    np.testing.assert_array_equal(recording.imu(), imu)
    assert len(list(recording)) == len(recording), "frames are not used up"
    known = recording.imu_calibration()
    assert known["has_gyro"] and known["delay"] == 0.0
    np.testing.assert_array_equal(known["cam_from_imu"], np.eye(4))
    assert known["noise"]["accel"] == 0.002


def test_a_calibration_may_be_given_and_the_sensor_left_out(sequence, tmp_path):
    given = tmp_path / "given.yaml"
    given.write_text("timeshift_cam_imu: 0.004\n")
    known = rgbd_pose.Recording(sequence, imu=given).imu_calibration()
    assert known["delay"] == 0.004
    without = rgbd_pose.Recording(sequence, imu="none")
    assert without.imu().shape == (0, 7)
    assert without.imu_calibration() is None
    given.write_text("timeshift_cam_im: 0.004\n")
    with pytest.raises(rgbd_pose.InputError, match="did you mean"):
        rgbd_pose.Recording(sequence, imu=given)
