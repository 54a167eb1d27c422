"""Prints the keyframes and edges of a map: read_map.py FOLDER."""
import pathlib
import sys


def checksum(data):  # FNV-1a over the bytes and their number, 64 bits
    state = 0xCBF29CE484222325
    for byte in data + len(data).to_bytes(8, "little"):
        state = (state ^ byte) * 0x100000001B3 % 2**64
    return f"{state:016x}"


if len(sys.argv) != 2:
    sys.exit("usage: read_map.py FOLDER")
folder = pathlib.Path(sys.argv[1])
text = (folder / "map.txt").read_bytes()
above, last = text[:-26], text[-26:].decode()  # "checksum", 16 digits
assert text.startswith(b"rgbd_pose_map 1\n") and last == f"checksum {checksum(above)}\n"
for line in above.decode().splitlines()[1:]:
    kind, *words = line.split()
    if kind == "keyframe":
        gray, depth = (folder / f"{name}.png" for name in words[12:14])
        assert checksum(gray.read_bytes()) == gray.stem
        assert checksum(depth.read_bytes()) == depth.stem
        print("keyframe", words[0], "at", *words[5:8], gray, depth)
    elif kind == "edge":
        print("edge from", words[0], "to", words[1])
