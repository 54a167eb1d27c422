"""A recording of ROS 2 with the results of simulated runs, taken apart.

usage: ros2_export_test.py BIN_FOLDER [--no_checksums]

The file has to be right as in mcap_export_test.py, and its messages as in
ros2_files.py; rgbd_odometry has to track the images again.
"""

import math
import os
import sys
import tempfile

sys.dont_write_bytecode = True
from export_test import check, data_lines, numbers, run
from mcap_export_test import fail
from ros2_files import check_run, simulate


def main(bin_folder, work):
    program = lambda name: os.path.join(bin_folder, name)
    sequence = simulate(bin_folder, work)
    run(program('rgbd_odometry'), *sequence, f'--output={work}/odometry')
    every = run(program('rgbd_export'), f'--run={work}/odometry', '--to=ros2', '--min_distance=0',
                '--min_angle=0')
    check('in the frame odom' in every, every)
    check_run(f'{work}/odometry', f'{work}/odometry/run_ros2.mcap', 'odom', 30)

    # The images are those of the run: its path again, but for JPEG and whole
    # millimetres.
    run(program('rgbd_odometry'), f'--dataset={work}/odometry/run_ros2.mcap', '--noreport',
        f'--output={work}/again')
    first, again = [[numbers(line) for line in data_lines(work, name, 'trajectory.txt')]
                    for name in ('odometry', 'again')]
    check([x[0] for x in first] == [x[0] for x in again], 'times of', len(again), 'poses')
    off = max(math.dist(a[1:4], b[1:4]) for a, b in zip(first, again))
    check(0 < off < 0.01, 'path again is off by', off)

    run(program('rgbd_slam'), *sequence, f'--output={work}/slam')
    run(program('rgbd_export'), f'--run={work}/slam', '--to=ros2', f'--output={work}/slam.mcap',
        '--min_distance=10', '--min_angle=100')
    check_run(f'{work}/slam', f'{work}/slam.mcap', 'map', 1)

    poses = data_lines(work, 'slam', 'trajectory.txt')
    with open(f'{work}/slam/trajectory.txt', 'w', encoding='utf-8') as file:
        file.write('\n'.join(['-1 ' + poses[0].split(' ', 1)[1]] + poses[1:]) + '\n')
    said = fail(program('rgbd_export'), f'--run={work}/slam', '--to=ros2')
    check('1970' in said and not any('mcap' in name for name in os.listdir(f'{work}/slam')), said)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], folder)
    print('ok')
