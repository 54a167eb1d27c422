"""Runs the code cells of docs/examples/camera_path.ipynb without Jupyter."""

import ast
import json
import os
import pathlib
import re

import pytest

FILE = pathlib.Path(
    os.environ["RGBD_POSE_SOURCES"], "docs/examples/camera_path.ipynb"
)
CELLS = json.loads(FILE.read_text())["cells"]


def run(source, names):
    """Runs a cell; the value of its last expression is what Jupyter shows."""
    body = ast.parse(source).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), FILE.name, "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), FILE.name, "eval"), names)


@pytest.fixture(scope="module")
def notebook(tmp_path_factory):
    """The names that all cells define, and what each of them shows."""
    patch = pytest.MonkeyPatch()
    patch.chdir(tmp_path_factory.mktemp("notebook"))
    programs = os.environ["RGBD_POSE_BIN"]
    patch.setenv("PATH", programs + os.pathsep + os.environ["PATH"])
    names = {}
    shown = [
        run("".join(cell["source"]), names)
        for cell in CELLS
        if cell["cell_type"] == "code"
    ]
    yield names, shown
    patch.undo()


def test_tracks_all_frames(notebook):
    names, shown = notebook
    assert repr(shown[0]) == "Recording('circle', 60 frames, 640 x 480)"
    assert repr(shown[1]).startswith("TrackedFrame(59: ok, ")
    assert len(names["stamps"]) == 60
    assert names["ate"].count == 60 and names["ate"].rmse < 0.002


def test_draws_the_path_on_the_truth(notebook):
    names, shown = notebook
    drawings = [s for s in shown if hasattr(s, "_repr_svg_")]
    assert len(drawings) == 1
    svg = drawings[0]._repr_svg_()
    lines = {
        colour: [tuple(map(float, p.split(","))) for p in points.split()]
        for points, colour in re.findall(
            r'points="(.*?)".*?stroke="(\w+)"', svg
        )
    }
    assert list(lines) == ["lightgray", "red"]
    x, y, w, h = map(float, re.search(r'viewBox="(.*?)"', svg)[1].split())
    for true, found in zip(lines["lightgray"], lines["red"], strict=True):
        assert x < found[0] < x + w and y < found[1] < y + h
        assert found == pytest.approx(true, abs=0.005)
    assert max(w, h) > 0.5, "the camera does not move"


def test_writes_a_mesh(notebook):
    names, _ = notebook
    with open(names["mesh"], "rb") as file:
        assert file.read(4) == b"glTF"


def test_has_no_output():
    for cell in CELLS:
        assert not cell.get("outputs") and not cell.get("execution_count")
