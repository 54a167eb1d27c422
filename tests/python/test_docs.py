"""Runs the examples of docs/python.md unchanged, one after another."""

import os
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(os.environ["RGBD_POSE_SOURCES"], "docs/python.md")


def test_examples_run(sequence, tmp_path):
    (tmp_path / "sequence").symlink_to(sequence)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) == 11
    for block in blocks:
        run = subprocess.run(
            [sys.executable, "-c", block],
            cwd=tmp_path, capture_output=True, text=True,
        )
        if "is not installed" in run.stderr or "without cpp" in run.stderr:
            continue  # an optional part is missing
        assert run.returncode == 0, block + run.stderr
        # The expected output of a line is in the comment behind it.
        for expected in re.findall(r"# prints (.*)", block):
            assert expected in run.stdout, run.stdout
