"""endurance_test.py SOURCE: the frames made by scripts/endurance, and its
conditions for a failure. Nothing is tracked here, because that takes long."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile

script = str(pathlib.Path(sys.argv[1]) / "scripts" / "endurance")
loader = importlib.machinery.SourceFileLoader("endurance", script)
spec = importlib.util.spec_from_loader("endurance", loader)
endurance = importlib.util.module_from_spec(spec)
loader.exec_module(endurance)


def a_sequence_goes_to_and_fro():
    with tempfile.TemporaryDirectory() as folder:
        leg = pathlib.Path(folder) / "leg"
        leg.mkdir()
        for name in ("rgb.txt", "depth.txt", "groundtruth.txt"):
            (leg / name).write_text("# a comment\n1.0 a\n1.1 b\n1.2 c\n")
        (leg / "camera.yaml").write_text("fx: 500\n")
        sequence = pathlib.Path(folder) / "sequence"
        for _ in range(2):  # the second time, all files exist already
            endurance.go_to_and_fro(leg, sequence, 7)
        for name in ("rgb.txt", "depth.txt", "groundtruth.txt"):
            rows = [row.split() for row in
                    (sequence / name).read_text().splitlines()]
            assert [row[1] for row in rows] == list("abcbabc"), rows
            assert [row[0] for row in rows] == [
                f"{k / 30:.6f}" for k in range(7)], rows
        assert (sequence / "camera.yaml").read_text() == "fx: 500\n"


def frames(track_ms=5.0, status="ok"):
    rows = [{"track_ms": "5.0", "status": "ok"} for _ in range(10240)]
    rows[77] = {"track_ms": str(track_ms), "status": status}
    return rows


def problems(rows=None, code=0, last_mb=110.0):
    # Rows of the second half of the frames, 2 kB each, may take 10 MB.
    memory = [(1.0, 80.0), (49.0, 100.0), (99.0, last_mb)]
    return endurance.problems_of(rows or frames(), memory, 100.0, code)


def a_failure_is_said():
    assert problems() == []
    assert problems(frames(track_ms=49.9)) == []
    assert problems(frames(status="degraded")) == []
    (slow,) = problems(frames(track_ms=50.1))
    assert "1 frames took more than 50 ms" in slow
    (lost,) = problems(frames(status="lost"))
    assert "1 frames were lost" in lost
    (grown,) = problems(last_mb=116.0)
    assert "100 MB at half time, then 116 MB, including 10 MB of rows" in grown
    (ended,) = problems(code=3)
    assert "exit code 3" in ended


a_sequence_goes_to_and_fro()
a_failure_is_said()
print("ok")
