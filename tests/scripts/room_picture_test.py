"""room_picture_test.py SOURCE: draws a floor, a ceiling and two paths."""
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
    from PIL import Image
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

SCRIPT = pathlib.Path(sys.argv[1]) / "scripts" / "room_picture"
SIDE = 400  # vertices along a side of 4 m
FLOOR, CEILING = (40, 160, 40), (250, 250, 0)
CAMERA_DOWN, CEILING_DOWN = 1.2, -1.3  # m below the camera's height


def plane(down, colour, seen_from_above):
    """Vertices and triangles of a square; x right, y down, z forward."""
    at = np.linspace(-2.0, 2.0, SIDE)
    x, z = np.meshgrid(at, at)
    vertices = np.zeros(SIDE * SIDE, [("p", "<f4", 3), ("c", "u1", 3)])
    vertices["p"] = np.stack([x, np.full_like(x, down), z], -1).reshape(-1, 3)
    vertices["c"] = colour
    first = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    right, further = first + 1, first + SIDE
    triangles = np.concatenate([
        np.stack([first, right, further], 1),
        np.stack([right, further + 1, further], 1)])
    # x cross z points down.
    return vertices, triangles[:, ::-1] if not seen_from_above else triangles


def write_mesh(path):
    floor, of_floor = plane(CAMERA_DOWN, FLOOR, True)
    ceiling, of_ceiling = plane(CEILING_DOWN, CEILING, False)
    vertices = np.concatenate([floor, ceiling])
    triangles = np.concatenate([of_floor, of_ceiling + len(floor)])
    faces = np.zeros(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    path.write_bytes(
        ("ply\nformat binary_little_endian 1.0\n"
         f"element vertex {len(vertices)}\n"
         "property float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         f"element face {len(faces)}\n"
         "property list uchar int vertex_indices\nend_header\n").encode()
        + vertices.tobytes() + faces.tobytes())


def write_path(path, z):
    path.write_text("".join(
        f"{k} {-1.5 + 0.3 * k} 0 {z} 0 0 0 1\n" for k in range(11)))


def like(image, colour, most=40):
    return np.abs(image.astype(int) - colour).max(-1) < most


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    write_mesh(folder / "mesh.ply")
    write_path(folder / "red.txt", -1.0)
    write_path(folder / "blue.txt", 1.0)
    picture = folder / "room.png"
    done = subprocess.run(
        [sys.executable, SCRIPT, picture, folder / "mesh.ply",
         folder / "red.txt", folder / "blue.txt"],
        capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert str(picture) in done.stdout, done.stdout
    image = np.array(Image.open(picture).convert("RGB"))
    assert image.shape == (520, 1000, 3), image.shape
    red, blue = like(image, (214, 39, 40)), like(image, (31, 90, 220))
    green = (image[..., 1] > image[..., 0] + 30) & (
        image[..., 1] > image[..., 2] + 30)
    yellow = (image[..., 2] < 100) & (image[..., 0] > 200) & (
        image[..., 1] > 200)
    assert green.mean() > 0.3, green.mean()
    assert not yellow.any(), "the ceiling hides the room"
    assert red.sum() > 500 and blue.sum() > 500, (red.sum(), blue.sum())
    # The view is nearly along x: points further in z are further to one side.
    assert abs(np.nonzero(red)[1].mean() - np.nonzero(blue)[1].mean()) > 100

    few = subprocess.run([sys.executable, SCRIPT, picture],
                         capture_output=True, text=True)
    assert few.returncode == 1 and "room_picture OUT.png" in few.stderr
print("ok")
