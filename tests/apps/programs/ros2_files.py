"""Reads recordings of ROS 2 for the tests of rgbd_export and of --record.

Messages are read by the definitions in the file itself, to their last byte, and
compared with trajectory.txt, edges.csv and keyframes.csv of a run.
"""

import csv
import math
import os
import struct
import sys

sys.dont_write_bytecode = True
from export_test import check, data_lines, inverse, matrix_of, numbers, product, run, same
from mcap_file import read_mcap

CAMERA = 'camera_color_optical_frame'
UPRIGHT = [[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0]]  # from x right, y down
SIZES = {'bool': '?', 'uint8': 'B', 'int32': 'i', 'uint32': 'I', 'float64': 'd'}
COLOR = '/camera/color/image_raw/compressed'
DEPTH = '/camera/aligned_depth_to_color/image_raw/compressedDepth'


def read_definitions(text):
    """Name of each message, '' for that of the file: its fields."""
    definitions = {}
    for part in text.decode().split('=' * 80 + '\n'):
        lines = part.splitlines()
        name = lines.pop(0).split()[1] if lines[0].startswith('MSG: ') else ''
        definitions[name] = [line.split() for line in lines]
    return definitions


class Cdr:
    def __init__(self, message, definitions):
        check(message[:4] == b'\0\1\0\0', 'little-endian CDR')
        self.bytes, self.at, self.definitions = message[4:], 0, definitions

    def number(self, kind):
        size = struct.calcsize('<' + kind)
        self.at += -self.at % size
        self.at += size
        return struct.unpack_from('<' + kind, self.bytes, self.at - size)[0]

    def one(self, kind):
        if kind in SIZES:
            return self.number(SIZES[kind])
        if kind == 'string':
            text = self.take(self.number('I'))
            check(text.endswith(b'\0'), 'end of text')
            return text[:-1].decode()
        return {name: self.field(inner) for inner, name in self.definitions[kind]}

    def take(self, size):
        self.at += size
        return self.bytes[self.at - size:self.at]

    def field(self, kind):
        if not kind.endswith(']'):
            return self.one(kind)
        kind, length = kind[:-1].split('[')
        count = int(length) if length else self.number('I')
        return self.take(count) if kind == 'uint8' else [self.one(kind) for _ in range(count)]


def read_message(bytes_, definitions):
    cdr = Cdr(bytes_, definitions)
    message = cdr.one('')
    check(cdr.at == len(cdr.bytes), 'bytes after the message')
    return message


def read_topics(file):
    """Topics with the names of their types, definitions and messages: (ns, content)."""
    return read_mcap(file, read_definitions, read_message)


def time_of(header):
    return header['stamp']['sec'] * 10**9 + header['stamp']['nanosec']


def vector(xyz):
    return [xyz[axis] for axis in 'xyz']


def pose_of(position, rotation):
    return matrix_of(*[rotation[k] for k in 'wxyz'], *vector(position))


def rotated(matrix, v):
    return [sum(row[k] * v[k] for k in range(3)) for row in matrix]


def covariance_of(row):
    """The 6 x 6 matrix of a row of edges.csv or keyframes.csv."""
    names = ['wx', 'wy', 'wz', 'cx', 'cy', 'cz']
    return [[float(row[f'cov_{names[min(i, j)]}_{names[max(i, j)]}']) for j in range(6)]
            for i in range(6)]


def as_ros(covariance, world_from_cam):
    """Of [w C] as that of [position, rotation about the parent's axes]."""
    turned = [[-x for x in row[:3]] for row in product(UPRIGHT, world_from_cam)]
    J = [[0, 0, 0] + [UPRIGHT[i][j] for j in range(3)] for i in range(3)]
    J += [turned[i] + [0, 0, 0] for i in range(3)]
    return [[sum(J[i][k] * covariance[k][m] * J[j][m] for k in range(6) for m in range(6))
             for j in range(6)] for i in range(6)]


def is_near(a, b):
    """Whether two covariances are equal."""
    scale = [math.sqrt(b[i][i]) for i in range(6)]
    return all(abs(a[i][j] - b[i][j]) < 1e-6 * scale[i] * scale[j]
               for i in range(6) for j in range(6))


def rows_of(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return list(csv.DictReader(file))


def check_velocity(before, state, after, seconds):
    """A twist is the mean velocity from the pose before to the one after."""
    turn = product(inverse(before), after)
    axis = [turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1]]
    sine, cosine = math.hypot(*axis) / 2, (turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2
    angular = [x / 2 * math.atan2(sine, cosine) / sine for x in axis]
    cam_from_world = inverse(state['pose'])
    linear = rotated(cam_from_world, [after[i][3] - before[i][3] for i in range(3)])
    for name, expected in (('linear', linear), ('angular', angular)):
        said = vector(state['twist'][name])
        check(max(abs(a * seconds - b) for a, b in zip(said, expected)) < 1e-8, name, said)


def check_run(result, file, parent, images, also=()):
    """Against the run in a folder; `also`: further topics and their types. Returns what
    each topic says."""
    topics = read_topics(file)
    expected = {
        **dict(also), '/path': 'nav_msgs/msg/Path', '/tf': 'tf2_msgs/msg/TFMessage',
        '/odom': 'nav_msgs/msg/Odometry', COLOR: 'sensor_msgs/msg/CompressedImage',
        DEPTH: 'sensor_msgs/msg/CompressedImage'}
    for topic in (COLOR, DEPTH):
        expected[topic.split('image_raw')[0] + 'camera_info'] = 'sensor_msgs/msg/CameraInfo'
    check({topic: value[0] for topic, value in topics.items()} == expected, *topics)
    said = {topic: [message for _, message in value[2]] for topic, value in topics.items()}
    path = {round(1e6 * x[0]) * 1000: matrix_of(x[7], *x[4:7], *x[1:4])
            for x in map(numbers, data_lines(result, 'trajectory.txt'))}
    poses = [product(UPRIGHT, pose) for pose in path.values()]
    for topic in ('/tf', '/odom'):
        check([time for time, _ in topics[topic][2]] == list(path), 'times of', topic)

    for time, pose, message in zip(path, poses, said['/tf']):
        transform, = message['transforms']
        check(time_of(transform['header']) == time and
              transform['header']['frame_id'] == parent and
              transform['child_frame_id'] == CAMERA, transform['header'])
        check(same(pose, pose_of(*transform['transform'].values()), 1e-8), transform)
    track, = said['/path']
    check([time_of(p['header']) for p in track['poses']] == list(path), 'times of path')
    check(all(same(pose, pose_of(*p['pose'].values()), 1e-8)
              for pose, p in zip(poses, track['poses'])), 'path')

    states = [{'pose': pose_of(*m['pose']['pose'].values()), 'twist': m['twist']['twist'],
               'covariance': [m['pose']['covariance'][6 * i:6 * i + 6] for i in range(6)],
               'of_twist': m['twist']['covariance'][::7]} for m in said['/odom']]
    times = list(path)
    for i, (message, state) in enumerate(zip(said['/odom'], states)):
        check(message['header']['frame_id'] == parent and message['child_frame_id'] == CAMERA,
              message['header'])
        check(same(poses[i], state['pose'], 1e-8), 'pose of odometry')
        before, after = max(i - 1, 0), min(i + 1, len(poses) - 1)
        check_velocity(poses[before], state, poses[after], (times[after] - times[before]) / 1e9)
        check(min(state['of_twist']) > 0, 'covariance of velocity')
    check_covariances(result, list(path.values()), states)
    check_images(said, images)
    return said


def check_covariances(result, path, states):
    check(not any(map(any, states[0]['covariance'])), 'the first pose is exact')
    known = [round(1e6 * float(row['timestamp'])) for row in rows_of(result, 'frames.csv')]
    if os.path.exists(os.path.join(result, 'keyframes.csv')):
        rows = rows_of(result, 'keyframes.csv')[1:]
        check(len(rows) > 1, 'keyframes')
        for row in rows:
            frame = known.index(round(1e6 * float(row['timestamp'])))
            check(is_near(states[frame]['covariance'],
                          as_ros(covariance_of(row), path[frame])), 'covariance of', frame)
        return
    later = 0
    for row in rows_of(result, 'edges.csv'):
        ref, cur = int(row['ref']), int(row['cur'])
        if ref > cur:
            continue
        if ref == 0:
            check(is_near(states[cur]['covariance'], as_ros(covariance_of(row), path[cur])),
                  'covariance of', cur)
        else:
            later += 1
            check(all(states[cur]['covariance'][i][i] > states[ref]['covariance'][i][i]
                      for i in range(3, 6)), 'of', cur, 'is that of', ref, 'and more')
    check(later > 0, 'one reference')


def check_images(said, images):
    for topic, form, start in ((COLOR, 'bgr8; jpeg compressed bgr8', b'\xff\xd8\xff'),
                               (DEPTH, '16UC1; compressedDepth png', bytes(12) + b'\x89PNG')):
        check(len(said[topic]) == images, len(said[topic]), 'images of', topic)
        cameras = said[topic.split('image_raw')[0] + 'camera_info']
        for message, camera in zip(said[topic], cameras):
            check(message['format'] == form and message['data'].startswith(start), topic)
            check(message['header'] == camera['header'] and
                  camera['header']['frame_id'] == CAMERA, camera['header'])
            check(camera['k'] == [262, 0, 159.5, 0, 263, 118, 0, 0, 1] and
                  camera['d'] == [0.02, -0.03, 0.001, -0.002, 0.01] and
                  camera['distortion_model'] == 'plumb_bob' and
                  (camera['width'], camera['height']) == (320, 240), camera)


def simulate(bin_folder, work, *flags):
    """Renders 30 frames; returns what programs need to read them."""
    with open(f'{work}/camera.yaml', 'w', encoding='utf-8') as file:
        file.write('Camera.fx: 262\nCamera.fy: 263\nCamera.cx: 159.5\nCamera.cy: 118\n'
                   'Camera.width: 320\nCamera.height: 240\nCamera.k1: 0.02\n'
                   'Camera.k2: -0.03\nCamera.p1: 0.001\nCamera.p2: -0.002\nCamera.k3: 0.01\n')
    run(os.path.join(bin_folder, 'rgbd_simulate'), '--path=table', '--frames=30', '--rate=5',
        f'--camera={work}/camera.yaml', f'--output={work}/sequence', *flags)
    return f'--dataset={work}/sequence', f'--camera={work}/sequence/camera.yaml', '--noreport'
