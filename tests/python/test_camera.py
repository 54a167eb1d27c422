import os
import pathlib
import re

import numpy as np
import pytest

import rgbd_pose


def says_what_makes_it(camera):
    copy = eval(repr(camera), {"Camera": rgbd_pose.Camera})
    return repr(copy) == repr(camera)


def test_keeps_what_it_is_given():
    camera = rgbd_pose.Camera(
        500, 501, 320, 240, 641, 482, (0.1, -0.2, 0.003, 0.004), 1000
    )
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (500, 501, 320, 240)
    assert (camera.width, camera.height) == (641, 482)
    assert camera.distortion == (0.1, -0.2, 0.003, 0.004, 0.0)
    assert camera.lens == "rational"
    assert camera.depth_scale == 1000.0
    np.testing.assert_array_equal(
        camera.matrix, [[500, 0, 320], [0, 501, 240], [0, 0, 1]]
    )
    assert says_what_makes_it(camera)


def test_knows_lenses_of_eight_coefficients_and_fisheyes():
    eight = (0.4, -2.5, 0.001, -0.0003, 1.5, 0.3, -2.3, 1.4)
    rational = rgbd_pose.Camera(500, 500, 320, 240, distortion=eight)
    fisheye = rgbd_pose.Camera(
        285, 286, 320, 240, distortion=(1e-3, 2e-3, 3e-3, 4e-3),
        lens="equidistant",
    )
    assert rational.distortion == eight
    assert (fisheye.lens, len(fisheye.distortion)) == ("equidistant", 4)
    for camera in (rational, fisheye):
        assert says_what_makes_it(camera)


def test_says_when_rows_are_exposed():
    plain = rgbd_pose.Camera(500, 500, 320, 240)
    times = {
        "color_time_offset": -0.0075, "color_readout": 0.028,
        "depth_time_offset": 0.0125, "depth_readout": -0.027,
    }
    camera = rgbd_pose.Camera(500, 500, 320, 240, **times)
    for name, value in times.items():
        assert getattr(plain, name) == 0.0
        assert getattr(camera, name) == value
        assert f"{name}={value}" in repr(camera)
        with pytest.raises(AttributeError):
            setattr(camera, name, 0.0)
    assert says_what_makes_it(camera)


def test_does_not_change():
    camera = rgbd_pose.Camera.load("tum_fr1")
    with pytest.raises(AttributeError):
        camera.fx = 1.0


def test_loads_presets_and_files(tmp_path):
    assert "tum_fr1" in rgbd_pose.camera_presets()
    assert rgbd_pose.Camera.load("tum_fr1").fx == 517.306408
    assert rgbd_pose.Camera.load("tum_fr1", depth_scale=1.0).depth_scale == 1.0
    path = tmp_path / "camera.yaml"
    path.write_text(
        "Camera.width: 320\nCamera.height: 240\nCamera.fx: 262\n"
        "Camera.fy: 263\nCamera.cx: 160\nCamera.cy: 120\n"
        "DepthMapFactor: 1000\ncolor_readout: 0.02\n"
        "depth_time_offset: -0.01\n"
    )
    for name in (path, str(path)):
        camera = rgbd_pose.Camera.load(name)
        assert (camera.fy, camera.height) == (263, 240)
        assert camera.depth_scale == 1000.0
        assert (camera.color_time_offset, camera.color_readout) == (0, 0.02)
        assert (camera.depth_time_offset, camera.depth_readout) == (-0.01, 0)


def test_keys_of_a_file_that_are_not_read_are_told(tmp_path):
    path = tmp_path / "camera.yaml"
    text = "Camera.fx: 262\nCamera.fy: 263\nCamera.cx: 160\nCamera.cy: 120\n"
    text += "Camera.width: 320\nCamera.height: 240\n"
    path.write_text(text + "Camera.id: 3\ncolour_readout: 0.02\n")
    with pytest.warns(UserWarning, match="not read: Camera.id$"):
        assert rgbd_pose.Camera.load(path).color_readout == 0.02
    path.write_text(text + "DepthMapfactor: 1000\n")
    with pytest.raises(rgbd_pose.InputError, match="mean DepthMapFactor"):
        rgbd_pose.Camera.load(path)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: rgbd_pose.Camera(0, 500, 320, 240), "Camera: "),
        (lambda: rgbd_pose.Camera(np.nan, 500, 320, 240), "Camera: "),
        (
            lambda: rgbd_pose.Camera(5, 5, 1, 1, distortion=[0.1]),
            "1 distortion coefficients",
        ),
        (
            lambda: rgbd_pose.Camera(
                500, 500, 320, 240, distortion=[0.1] * 5, lens="equidistant"
            ),
            "equidistant lens has k1 k2 k3 k4",
        ),
        (
            lambda: rgbd_pose.Camera(500, 500, 320, 240, lens="wide"),
            "lens 'wide' is neither 'rational' nor 'equidistant'",
        ),
        (
            lambda: rgbd_pose.Camera(500, 500, 320, 240, depth_scale=0),
            "depth scale",
        ),
        (
            lambda: rgbd_pose.Camera(500, 500, 320, 240, color_readout=5),
            "color_readout must be at most 0.1 s",
        ),
        (
            lambda: rgbd_pose.Camera(
                500, 500, 320, 240, depth_time_offset=np.nan
            ),
            "depth_time_offset must be at most 0.5 s",
        ),
        (lambda: rgbd_pose.Camera.load("tum_fr9"), "tum_fr1, tum_fr2"),
    ],
)
def test_bad_values_are_told_in_one_line(make, words):
    with pytest.raises(rgbd_pose.InputError, match=words) as error:
        make()
    assert isinstance(error.value, ValueError)
    assert "\n" not in str(error.value)


def test_names():
    assert "bidirectional_point" in rgbd_pose.costs()
    assert "tukey" in rgbd_pose.losses()
    assert "patch" in rgbd_pose.frontends()
    assert rgbd_pose.Camera.__module__ == "rgbd_pose"
    assert rgbd_pose.InputError.__module__ == "rgbd_pose"


def test_version_is_that_of_the_project():
    text = pathlib.Path(
        os.environ["RGBD_POSE_SOURCES"], "CMakeLists.txt"
    ).read_text()
    version = re.search(r"project\(rgbd_pose VERSION ([\d.]+)", text).group(1)
    assert rgbd_pose.__version__ == version
