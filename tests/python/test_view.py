"""The live page of a tracker."""

import json
import os
import signal
import threading
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

import rgbd_pose
from conftest import track_all

PATIENCE = 20.0  # s; longer than any answer takes on a busy machine


def open_view(tracker, **arguments):
    try:
        return tracker.view(**arguments)
    except rgbd_pose.InputError as error:
        if "without cpp-httplib" in str(error):
            pytest.skip(str(error))
        raise


def press(page, button):
    urllib.request.urlopen(
        urllib.request.Request(page.address + button, method="POST"), timeout=PATIENCE
    )


@pytest.fixture(scope="module")
def frames(sequence):
    return list(rgbd_pose.Recording(sequence))


class Reader:
    """An open page: reads its events in a thread."""

    def __init__(self, page):
        self.frames = []
        self.keyframes = []
        self.has_ended = False
        self.stream = urllib.request.urlopen(page.address + "events", timeout=PATIENCE)
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        event = ""
        for line in self.stream:
            field, _, value = line.decode().rstrip("\n").partition(": ")
            if field == "event":
                event = value
            elif field == "data" and event == "news":
                news = json.loads(value)
                self.frames += news["frames"]
                self.keyframes += news["keyframes"]
            elif field == "data" and event == "end":
                self.has_ended = True

    def waits_for(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition(self) and time.monotonic() < end:
            time.sleep(0.01)
        return condition(self)


@pytest.mark.parametrize("kind", [rgbd_pose.Odometry, rgbd_pose.Slam])
def test_shows_all_frames_and_changes_nothing(kind, camera, frames):
    alone, seen = kind(camera), kind(camera)
    track_all(alone, frames)
    track_all(seen, frames[:3])
    page = open_view(seen)
    reader = Reader(page)
    track_all(seen, frames[3:])
    assert reader.waits_for(lambda r: len(r.frames) == len(frames))
    assert len(reader.keyframes) > 0
    for one, other in zip(alone.trajectory, seen.trajectory):
        assert np.array_equal(one, other)
    assert page.address in page._repr_html_() and page.address in repr(page)
    page.close()
    assert reader.waits_for(lambda r: r.has_ended)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(page.address, timeout=PATIENCE)


def test_finish_ends_the_page(camera, frames):
    slam = rgbd_pose.Slam(camera)
    reader = Reader(open_view(slam))
    track_all(slam, frames[:3])
    slam.finish()
    assert reader.waits_for(lambda r: r.has_ended)


def test_a_pause_holds_the_next_frame_until_ctrl_c(camera, frames):
    odometry = rgbd_pose.Odometry(camera)
    page = open_view(odometry)
    reader = Reader(page)  # without a page, a pause ends
    press(page, "pause")
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        track_all(odometry, frames[:1])
    press(page, "resume")
    track_all(odometry, frames[1:2])  # the frame before was tracked
    assert reader.waits_for(lambda r: len(r.frames) == 2)


def test_stop_is_for_the_caller_to_see(camera, frames):
    odometry = rgbd_pose.Odometry(camera)
    page = open_view(odometry)
    assert not page.is_stopped
    press(page, "stop")
    assert page.is_stopped
    track_all(odometry, frames[:2])
    assert len(odometry.trajectory[0]) == 2


def test_the_page_keeps_its_tracker(camera, frames):
    page = open_view(rgbd_pose.Odometry(camera))
    with urllib.request.urlopen(page.address, timeout=PATIENCE) as answer:
        assert b"rgbd_pose" in answer.read()


def test_another_page_takes_the_place_of_the_first(camera, frames):
    odometry = rgbd_pose.Odometry(camera)
    port = int(open_view(odometry).address.rstrip("/").split(":")[-1])
    assert open_view(odometry, port=port).address.endswith(f":{port}/")


def test_bad_arguments(camera, frames):
    odometry = rgbd_pose.Odometry(camera)
    page = open_view(odometry)
    port = int(page.address.rstrip("/").split(":")[-1])
    with pytest.raises(rgbd_pose.InputError, match=f"view_port={port}: cannot listen"):
        rgbd_pose.Odometry(camera).view(port=port)
    with pytest.raises(rgbd_pose.InputError, match="view_port must be"):
        odometry.view(port=70000)
    with pytest.raises(rgbd_pose.InputError, match="view_speed must not"):
        odometry.view(speed=-1.0)
