"""Runs the examples of docs/python.md, and those in docs/examples."""

import os
import pathlib
import re
import subprocess
import sys

DOCS = pathlib.Path(os.environ["RGBD_POSE_SOURCES"], "docs")


def test_examples_run(sequence, tmp_path):
    (tmp_path / "sequence").symlink_to(sequence)
    page = (DOCS / "python.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 7
    for name in ("own_problem.py", "slam.py"):
        blocks.append((DOCS / "examples" / name).read_text())
    for block in blocks:
        run = subprocess.run(
            [sys.executable, "-c", block],
            cwd=tmp_path, capture_output=True, text=True,
        )
        if "without cpp" in run.stderr:
            continue  # an optional part is missing
        assert run.returncode == 0, block + run.stderr
        # The expected output of a line is in the comment behind it.
        for expected in re.findall(r"# prints (.*)", block):
            assert expected in run.stdout, run.stdout
