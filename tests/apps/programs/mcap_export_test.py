"""A recording of ROS 2 with the results of simulated runs, taken apart.

usage: mcap_export_test.py BIN_FOLDER [--no_checksums]

The file has to be right as in mcap_file.py, and its messages as in ros2_files.py;
rgbd_odometry has to track the images again.
"""

import math
import os
import struct
import sys
import tempfile

sys.dont_write_bytecode = True
from export_test import (check, data_lines, fail, matrix_of, moved, numbers, product, read_lines,
                         read_ply, run, same)
from ros2_files import UPRIGHT, check_run, pose_of, read_topics, rows_of, simulate, time_of

LENSES = {
    'rational_polynomial': ('', ('k1', 'k2', 'p1', 'p2', 'k3', 'k4', 'k5', 'k6')),
    'equidistant': ('Camera.type: KannalaBrandt8\n', ('k1', 'k2', 'k3', 'k4')),
}
VALUES = [0.02, -0.03, 0.001, -0.002, 0.01, 0.03, 0.02, 0.01]


def write_lines(lines, *path):
    with open(os.path.join(*path), 'w', encoding='utf-8') as file:
        file.writelines(line + '\n' for line in lines)


def check_keyframes(message, result):
    rows = rows_of(result, 'keyframes.csv')
    check(len(rows) == len(message['poses']) > 1, 'keyframes')
    for row, pose in zip(rows, message['poses']):
        world_from_cam = matrix_of(*[float(row[k]) for k in
                                     ('qw', 'qx', 'qy', 'qz', 'tx', 'ty', 'tz')])
        check(time_of(pose['header']) == round(1e6 * float(row['timestamp'])) * 1000, row)
        check(same(product(UPRIGHT, world_from_cam), pose_of(*pose['pose'].values()), 1e-8), row)


def check_cloud(message, parent, ply):
    """The points of another export, upright, with colours as RViz takes them."""
    check(message['header']['frame_id'] == parent and message['height'] == 1 and
          message['point_step'] == 16 and message['is_dense'], message['header'])
    check([(f['name'], f['offset'], f['datatype'], f['count']) for f in message['fields']] ==
          [('x', 0, 7, 1), ('y', 4, 7, 1), ('z', 8, 7, 1), ('rgb', 12, 7, 1)], message['fields'])
    expected = read_ply(ply)[0]
    points = list(struct.iter_unpack('<3fI', message['data']))
    check(len(points) == len(expected) == message['width'] > 1000 and
          message['row_step'] == 16 * len(points), 'size of the cloud')
    for point, (*position, red, green, blue) in zip(points, expected):
        check(math.dist(point[:3], moved(UPRIGHT, position)) < 1e-5 and
              point[3] == (red << 16 | green << 8 | blue), point)


def check_lens(topics, model, values):
    for _, camera in topics['/camera/color/camera_info'][2]:
        check(camera['distortion_model'] == model and camera['d'] == values, camera)
        check(camera['p'] == [262, 0, 159.5, 0, 0, 263, 118, 0, 0, 0, 1, 0], camera)


def main(bin_folder, work):
    program = lambda name: os.path.join(bin_folder, name)
    sequence = simulate(bin_folder, work)
    run(program('rgbd_odometry'), *sequence, f'--output={work}/odometry')
    every = run(program('rgbd_export'), f'--run={work}/odometry', '--to=mcap', '--min_distance=0',
                '--min_angle=0')
    check('in the frame odom' in every, every)
    cloud = {'/cloud': 'sensor_msgs/msg/PointCloud2'}
    check_run(f'{work}/odometry', f'{work}/odometry/run.mcap', 'odom', 30, cloud)

    # The images are those of the run: its path again, but for JPEG and whole
    # millimetres.
    run(program('rgbd_odometry'), f'--dataset={work}/odometry/run.mcap', '--noreport',
        f'--output={work}/again')
    first, again = [[numbers(line) for line in data_lines(work, name, 'trajectory.txt')]
                    for name in ('odometry', 'again')]
    check([x[0] for x in first] == [x[0] for x in again], 'times of', len(again), 'poses')
    off = max(math.dist(a[1:4], b[1:4]) for a, b in zip(first, again))
    check(0 < off < 0.01, 'path again is off by', off)

    result = f'{work}/slam'
    run(program('rgbd_slam'), *sequence, f'--output={result}')

    def export(name, output, *flags):
        return run(program('rgbd_export'), f'--run={result}', f'--to={name}',
                   f'--output={work}/{output}', '--voxel=0.05', *flags)

    few = ('--min_distance=10', '--min_angle=100')
    export('mcap', 'slam.mcap', *few)
    said = check_run(result, f'{work}/slam.mcap', 'map', 1,
                     {**cloud, '/keyframes': 'nav_msgs/msg/Path'})
    check_keyframes(said['/keyframes'][0], result)
    export('nerfstudio', 'nerfstudio', *few)
    check_cloud(said['/cloud'][0], 'map', f'{work}/nerfstudio/points.ply')

    for model, (kind, names) in LENSES.items():
        write_lines(['Camera.fx: 262', 'Camera.fy: 263', 'Camera.cx: 159.5', 'Camera.cy: 118',
                     'Camera.width: 320', 'Camera.height: 240' + ('\n' + kind).rstrip()] +
                    [f'Camera.{name}: {x}' for name, x in zip(names, VALUES)],
                    work, f'{model}.yaml')
        camera = f'--camera={work}/{model}.yaml'
        export('mcap', 'lens.mcap', *few, camera)
        check_lens(read_topics(f'{work}/lens.mcap'), model, VALUES[:len(names)])
        export('mcap', 'lens.mcap', *few, camera, '--undistort')
        check_lens(read_topics(f'{work}/lens.mcap'), 'plumb_bob', [0] * 5)

    # Without a map, and with frames of which nobody knows where they were.
    for file in ('keyframes.csv', 'slam.csv'):
        os.remove(os.path.join(result, file))
    rows = [row.split(',') for row in read_lines(result, 'frames.csv')]
    for row in rows[-5:]:
        row[rows[0].index('segment')] = '1'
    write_lines([','.join(row) for row in rows], result, 'frames.csv')
    said = export('mcap', 'first.mcap')
    check('5 poses of other segments are left out' in said, said)
    check(len(read_topics(f'{work}/first.mcap')['/tf'][2]) == 25, 'poses of the first segment')

    poses = data_lines(result, 'trajectory.txt')
    write_lines(['-1 ' + poses[0].split(' ', 1)[1]] + poses[1:], result, 'trajectory.txt')
    said = fail(program('rgbd_export'), f'--run={result}', '--to=mcap')
    check('1970' in said and not any('mcap' in name for name in os.listdir(result)), said)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], folder)
    print('ok')
