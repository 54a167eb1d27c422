"""Exports of a simulated run, read with code other than the exporters'.

usage: export_test.py BIN_FOLDER [--colmap]

Points must be where the depth images show them, by each format's conventions.
Mesh files must contain what their formats require. With --colmap the model is
read by colmap; the exit code is 77 (test skipped) where colmap is missing.
"""

import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from exported_files import check, read_glb, read_ply, read_png

FRAMES = 12


def run(*command):
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f'{" ".join(command)}\n{result.stdout}{result.stderr}')
    return result.stdout + result.stderr


def fail(*command):
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    check(result.returncode == 2, result.stderr)
    return result.stderr


def read_lines(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read().splitlines()


def numbers(line):
    return [float(word) for word in line.split()]


def data_lines(*path):
    return [line for line in read_lines(*path) if not line.startswith('#')]


# Poses are converted to the rows of a 3 x 4 matrix.


def matrix_of(qw, qx, qy, qz, tx, ty, tz):
    check(abs(qw * qw + qx * qx + qy * qy + qz * qz - 1) < 1e-6, 'no unit quaternion')
    return [
        [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz),
         2 * (qx * qz + qw * qy), tx],
        [2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz),
         2 * (qy * qz - qw * qx), ty],
        [2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx),
         1 - 2 * (qx * qx + qy * qy), tz],
    ]


def moved(matrix, point):
    return [sum(row[k] * point[k] for k in range(3)) + row[3] for row in matrix]


def inverse(matrix):
    transposed = [[matrix[k][i] for k in range(3)] for i in range(3)]
    return [row + [-sum(row[k] * matrix[k][3] for k in range(3))] for row in transposed]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) + (a[i][3] if j == 3 else 0)
             for j in range(4)] for i in range(3)]


def same(a, b, tolerance=1e-6):
    return all(abs(x - y) < tolerance for r, s in zip(a, b) for x, y in zip(r, s))


def check_views(points, views, project):
    """World points must have the depth and colour of the pixels that show them.

    `views`: camera_from_world and the files of the depth image, in millimetres,
    and the colour image.
    """
    for cam_from_world, depth_file, color_file in views:
        depth = [[value / 1000 for value in row] for row in read_png(depth_file)]
        color = read_png(color_file)
        depth_errors, color_errors = [], []
        for point in points:
            x, y, z = moved(cam_from_world, point[:3])
            if z <= 0:
                continue
            u, v = project(x / z, y / z)
            # The pixel whose area contains it: coordinates start at its corner.
            row, column = math.floor(v), math.floor(u)
            if not (0 <= row < len(depth) and 0 <= column < len(depth[0])):
                continue
            if depth[row][column] == 0:
                continue
            depth_errors.append(abs(depth[row][column] - z))
            seen = color[row][3 * column:3 * column + 3]
            color_errors.append(max(abs(a - b) for a, b in zip(seen, point[3:])))
        check(len(depth_errors) > 500, 'only', len(depth_errors), 'points in a view')
        depth_errors.sort()
        color_errors.sort()
        middle = len(depth_errors) // 2
        check(depth_errors[middle] < 0.02, 'depth off by', depth_errors[middle])
        check(color_errors[middle] < 25, 'colour off by', color_errors[middle])


def check_colmap(folder, poses, depth_folder):
    camera = data_lines(folder, 'sparse/0/cameras.txt')[0].split()
    check(camera[1] == 'PINHOLE' and camera[2:4] == ['320', '240'], camera)
    fx, fy, cx, cy = [float(word) for word in camera[4:8]]
    check((cx, cy) == (160.0, 120.0), 'COLMAP counts from corners of pixels')
    lines = data_lines(folder, 'sparse/0/images.txt')
    check(all(line == '' for line in lines[1::2]), 'lines of features')
    points = [numbers(line)[1:7]
              for line in data_lines(folder, 'sparse/0/points3D.txt')]
    with open(os.path.join(folder, 'sparse/0/points3D.bin'), 'rb') as file:
        packed = file.read()
    count, = struct.unpack_from('<Q', packed)
    check(count == len(points) and len(packed) == 8 + 51 * count, count)
    for i in range(0, count, 97):
        same_point = struct.unpack_from('<Q3d3BdQ', packed, 8 + 51 * i)
        check(same_point[0] == i + 1 and same_point[-1] == 0, same_point)
        check(all(abs(a - b) < 1e-4 for a, b in zip(same_point[1:7], points[i])),
              same_point, points[i])
    views = []
    for line in lines[::2]:
        words = line.split()
        name = words[9]
        cam_from_world = matrix_of(*[float(word) for word in words[1:8]])
        frame = int(name.split('.')[0])
        check(same(inverse(cam_from_world), poses[frame]), 'pose of', name)
        views.append((cam_from_world, os.path.join(depth_folder, name),
                      os.path.join(folder, 'images', name)))
    check(len(views) == FRAMES, len(views), 'images')
    check_views(points[::7], views[::6], lambda x, y: (fx * x + cx, fy * y + cy))


def check_nerfstudio(folder, poses):
    with open(os.path.join(folder, 'transforms.json'), encoding='utf-8') as file:
        scene = json.load(file)
    check(len(scene['frames']) == FRAMES, 'frames')
    check((scene['w'], scene['h'], scene['cx'], scene['k1']) == (320, 240, 160, 0), scene)
    check(scene['depth_unit_scale_factor'] == 0.001, 'unit of depth')
    points, _ = read_ply(os.path.join(folder, scene['ply_file_path']))
    views = []
    for frame in scene['frames']:
        matrix = frame['transform_matrix']
        check(matrix[3] == [0, 0, 0, 1], matrix)
        # OpenGL's axes: y up, z backwards.
        world_from_cam = [[row[0], -row[1], -row[2], row[3]] for row in matrix[:3]]
        number = int(os.path.basename(frame['file_path']).split('.')[0])
        check(same(world_from_cam, poses[number]), 'pose of', frame['file_path'])
        views.append((inverse(world_from_cam),
                      os.path.join(folder, frame['depth_file_path']),
                      os.path.join(folder, frame['file_path'])))
    check_views(points[::7], views[2:8:5],
                lambda x, y: (scene['fl_x'] * x + scene['cx'],
                              scene['fl_y'] * y + scene['cy']))


def check_meshes(ply, glb):
    vertices, faces = read_ply(ply)
    positions, colors, glb_faces = read_glb(glb)
    check(len(faces) > 10000 and faces == glb_faces, 'faces of', ply, glb)
    check(max(max(face) for face in faces) < len(vertices), 'corners')
    for (x, y, z, *rgb), position, color in zip(vertices, positions, colors):
        check(max(abs(a - b) for a, b in zip((x, -y, -z), position)) < 1e-6,
              'y and z of glTF point up and back')
        for value, linear in zip(rgb, color):
            c = value / 255
            c = c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
            check(abs(c - linear) < 1e-4, 'colours of glTF are linear')
        check(color[3] == 1, 'opaque')
    return vertices


def check_g2o(path, poses):
    vertices, edges = {}, 0
    for line in read_lines(path):
        words = line.split()
        if words[0] == 'VERTEX_SE3:QUAT':
            x = [float(word) for word in words[2:9]]
            vertices[int(words[1])] = matrix_of(x[6], *x[3:6], *x[:3])
        if words[0] == 'EDGE_SE3:QUAT':
            edges += 1
            check(len(words) == 3 + 7 + 21, line)
            x = [float(word) for word in words[3:10]]
            measured = matrix_of(x[6], *x[3:6], *x[:3])
            of_poses = product(inverse(vertices[int(words[1])]), vertices[int(words[2])])
            check(same(measured, of_poses, 0.01), line)
    check(len(vertices) == FRAMES and edges >= FRAMES - 1, len(vertices), edges)
    check(all(same(vertices[i], poses[i]) for i in vertices), 'vertices')


def check_lenses(program, work):
    """Each lens has the name and parameter order that other programs use."""
    lenses = {
        'OPENCV_FISHEYE': ('Camera.type: KannalaBrandt8\n', (0.01, 0.02, 0.03, 0.04),
                           ('k1', 'k2', 'k3', 'k4')),
        'FULL_OPENCV': ('', (0.4, -2.5, 0.001, -0.0003, 1.5, 0.3, -2.3, 1.4),
                        ('k1', 'k2', 'p1', 'p2', 'k3', 'k4', 'k5', 'k6')),
    }
    for model, (camera_type, values, names) in lenses.items():
        base = os.path.join(work, model)
        with open(f'{base}.yaml', 'w', encoding='utf-8') as file:
            file.write('Camera.fx: 130\nCamera.fy: 131\nCamera.cx: 79.5\n'
                       'Camera.cy: 59.5\nCamera.width: 160\nCamera.height: 120\n'
                       + camera_type)
            file.writelines(f'Camera.{name}: {value}\n'
                            for name, value in zip(names, values))
        run(program('rgbd_simulate'), '--frames=3', f'--camera={base}.yaml',
            f'--output={base}')
        run(program('rgbd_odometry'), f'--dataset={base}', '--noreport',
            f'--camera={base}/camera.yaml', f'--output={base}.run')

        def export(name, *flags):
            command = [program('rgbd_export'), f'--run={base}.run', f'--to={name}',
                       f'--output={base}.{name}', '--overwrite', *flags]
            return subprocess.run(command, capture_output=True, text=True, check=False)

        check(export('colmap').returncode == 0, 'colmap', model)
        camera = data_lines(f'{base}.colmap', 'sparse/0/cameras.txt')[0].split()
        check(camera[1] == model, camera)
        check(tuple(map(float, camera[8:])) == values, camera)
        nerfstudio = export('nerfstudio')
        if model == 'FULL_OPENCV':
            check(nerfstudio.returncode == 2 and '--undistort' in nerfstudio.stderr,
                  nerfstudio.stderr)
            check(not os.path.exists(f'{base}.nerfstudio'), 'half written')
            check(export('nerfstudio', '--undistort').returncode == 0, 'undistort')
        with open(f'{base}.nerfstudio/transforms.json', encoding='utf-8') as file:
            scene = json.load(file)
        expected = ('OPENCV', 0) if model == 'FULL_OPENCV' else (model, values[3])
        check((scene['camera_model'], scene['k4']) == expected, scene['camera_model'])


def check_overwriting(export, folder):
    """Only what an export wrote is replaced."""
    beside = folder + '.partial'
    os.mkdir(beside)
    export('kitti', folder, '--overwrite')
    check(os.path.exists(beside), 'a folder of the user is lost')
    mine = os.path.join(folder, 'mine.txt')
    with open(mine, 'w', encoding='utf-8') as file:
        file.write('mine')
    refused = export('kitti', folder, '--overwrite')
    check(refused.returncode == 2 and 'other files, such as mine.txt' in refused.stderr,
          refused.stderr)
    check(os.path.exists(mine), 'mine.txt is lost')
    os.remove(mine)
    # An export was killed between moving the old folder away and the new one in.
    os.rename(folder, folder + '.replaced_by_export')
    refused = export('kitti', folder)
    check(refused.returncode == 2 and 'is not empty' in refused.stderr, refused.stderr)
    check(export('kitti', folder, '--overwrite').returncode == 0, 'overwrite')
    check(not os.path.exists(folder + '.replaced_by_export'), 'the old folder stays')


def main(bin_folder, work, colmap):
    program = lambda name: os.path.join(bin_folder, name)
    with open(os.path.join(work, 'half.yaml'), 'w', encoding='utf-8') as file:
        file.write('Camera.fx: 262.5\nCamera.fy: 262.5\nCamera.cx: 159.5\n'
                   'Camera.cy: 119.5\nCamera.width: 320\nCamera.height: 240\n')
    sequence, result = os.path.join(work, 'sequence'), os.path.join(work, 'run')
    run(program('rgbd_simulate'), '--path=handheld', f'--frames={FRAMES}',
        '--rate=10', f'--camera={work}/half.yaml', f'--output={sequence}')
    run(program('rgbd_odometry'), f'--dataset={sequence}',
        f'--camera={sequence}/camera.yaml', f'--output={result}', '--noreport',
        f'--save_mesh={work}/of_run.ply', '--voxel=0.02')
    poses = [matrix_of(x[7], *x[4:7], *x[1:4])
             for x in map(numbers, data_lines(result, 'trajectory.txt'))]
    check(len(poses) == FRAMES, 'lost frames')

    exported = set()

    def export(name, output, *flags):
        exported.add(name)
        run(program('rgbd_export'), f'--run={result}', f'--to={name}',
            f'--output={work}/{output}', *flags)
        return os.path.join(work, output)

    if colmap:
        model = os.path.join(export('colmap', 'model'), 'sparse/0')
        # To stdout, or since version 3.9 to stderr.
        said = run('colmap', 'model_analyzer', '--path', model)
        points = len(data_lines(model, 'points3D.txt'))
        images = len(data_lines(model, 'images.txt')) // 2
        check(f'Registered images: {images}\n' in said, said)
        check(f'Points: {points}\n' in said, said)
        return

    every = '--min_distance=0'
    nerfstudio = export('nerfstudio', 'nerfstudio', every)
    check_nerfstudio(nerfstudio, poses)
    check_colmap(export('colmap', 'colmap', every), poses,
                 os.path.join(nerfstudio, 'depth'))
    vertices = check_meshes(export('mesh', 'mesh.ply', '--voxel=0.02'),
                            export('mesh', 'mesh.glb', '--voxel=0.02'))
    with open(os.path.join(work, 'of_run.ply'), 'rb') as of_run:
        with open(os.path.join(work, 'mesh.ply'), 'rb') as mesh:
            check(of_run.read() == mesh.read(), '--save_mesh is another mesh')
    cloud, no_faces = read_ply(export('cloud', 'cloud.ply'))
    check(len(cloud) > len(vertices) // 2 and not no_faces, 'cloud')
    kitti = export('kitti', 'kitti')
    for line, pose in zip(read_lines(kitti, 'poses.txt'), poses):
        check(same([numbers(line)[4 * i:4 * i + 4] for i in range(3)], pose), line)
    check(len(read_lines(kitti, 'times.txt')) == FRAMES, 'times')
    check_overwriting(
        lambda name, output, *flags: subprocess.run(
            [program('rgbd_export'), f'--run={result}', f'--to={name}',
             f'--output={output}', *flags], capture_output=True, text=True, check=False),
        kitti)
    tum = export('tum', 'tum.txt')
    # Quaternions are normalised when read: the last digit may change.
    for line, of_run in zip(data_lines(tum), data_lines(result, 'trajectory.txt')):
        check(max(abs(a - b) for a, b in zip(numbers(line), numbers(of_run))) < 2e-9,
              f'TUM: {line}')
    check(len(data_lines(tum)) == FRAMES, 'TUM')
    check_g2o(export('g2o', 'graph.g2o'), poses)
    check_lenses(program, work)
    # mcap files are read by mcap_export_test.py.
    choices = re.search(r'--to .*\n.*\n *one of: (.*)', run(program('rgbd_export'), '--help'))
    unchecked = set(choices.group(1).split()) - exported - {'mcap'}
    check(not unchecked, 'no check of', *unchecked)


if __name__ == '__main__':
    if '--colmap' in sys.argv and shutil.which('colmap') is None:
        print('skipped: needs colmap')
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], folder, '--colmap' in sys.argv)
    print('ok')
