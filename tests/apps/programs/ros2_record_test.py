"""Recordings for ROS 2 that rgbd_odometry and rgbd_slam write while they track.

usage: ros2_record_test.py BIN_FOLDER [--no_checksums]

Files and messages have to be right as in ros2_files.py, the images those of
rgbd_export, and the results of a run the same as without --record. A run that
is stopped leaves a whole file, one that is killed what was written so far.
"""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from export_test import (check, data_lines, fail, matrix_of, numbers, product, read_lines, run,
                         same)
from ros2_files import (COLOR, DEPTH, UPRIGHT, check_run, pose_of, read_topics, rows_of, simulate,
                        time_of)

STALLED = 20  # the frame at which a camera waits


def check_same_results(work, one, other, names):
    for name in names:
        check(read_lines(work, one, name) == read_lines(work, other, name), name, 'with --record')


def check_poses(topics, result, name):
    """Transforms are the poses of a file."""
    poses = [numbers(line) for line in data_lines(result, name)]
    transforms = [m['transforms'][0] for _, m in topics['/tf'][2]]
    check(len(poses) == len(transforms) == len(topics['/odom'][2]) > 0, 'poses', len(poses))
    for x, transform in zip(poses, transforms):
        pose = product(UPRIGHT, matrix_of(x[7], *x[4:7], *x[1:4]))
        check(time_of(transform['header']) == round(1e6 * x[0]) * 1000, transform['header'])
        check(transform['header']['frame_id'] == 'odom', transform['header'])
        check(same(pose, pose_of(*transform['transform'].values()), 1e-8), transform)


def check_whole_run(program, sequence, work):
    run(program('rgbd_odometry'), *sequence, f'--output={work}/plain')
    said = run(program('rgbd_odometry'), *sequence, f'--output={work}/odometry',
               f'--record={work}/odometry.mcap')
    check(f'recorded in {work}/odometry.mcap: 30 poses in the frame odom, 30 images' in said, said)
    check_same_results(work, 'plain', 'odometry', ('trajectory.txt', 'edges.csv'))
    check_run(f'{work}/odometry', f'{work}/odometry.mcap', 'odom', 30)

    # What rgbd_export says later, but for its poses, which are rounded.
    run(program('rgbd_export'), f'--run={work}/odometry', '--to=mcap', '--min_distance=0',
        '--min_angle=0')
    recorded = read_topics(f'{work}/odometry.mcap')
    exported = read_topics(f'{work}/odometry/run.mcap')
    del exported['/cloud']
    for topic, value in exported.items():
        check(recorded[topic][:2] == value[:2], 'type of', topic)
        if topic.startswith('/camera'):
            check(recorded[topic][2] == value[2], 'messages of', topic)
    (at, path), = recorded['/path'][2]
    check(at == time_of(path['header']) == recorded['/odom'][2][-1][0], 'time of path')

    run(program('rgbd_slam'), *sequence, f'--output={work}/plain_slam')
    run(program('rgbd_slam'), *sequence, f'--output={work}/slam', f'--record={work}/slam.mcap')
    check_same_results(work, 'plain_slam', 'slam',
                       ('trajectory.txt', 'edges.csv', 'keyframes.csv', 'graph.g2o'))
    check_poses(read_topics(f'{work}/slam.mcap'), f'{work}/slam', 'trajectory_odometry.txt')


def check_lost_frames(bin_folder, program, work):
    """All images are there; poses as far as they are known."""
    os.mkdir(work)
    sequence = simulate(bin_folder, work, '--black=1')
    run(program('rgbd_odometry'), *sequence, '--tracker=features', f'--output={work}/run',
        f'--record={work}/run.mcap')
    frames = rows_of(work, 'run', 'frames.csv')
    lost = [frame['status'] == 'lost' for frame in frames]
    check(2 < sum(lost) < 8 and not any(frame['segment'] != '0' for frame in frames), lost)
    topics = read_topics(f'{work}/run.mcap')
    check_poses(topics, f'{work}/run', 'trajectory.txt')
    times = [round(1e6 * float(frame['timestamp'])) * 1000 for frame in frames]
    for topic in (COLOR, DEPTH):
        check([at for at, _ in topics[topic][2]] == times, 'times of', topic)


def wait_for(condition):
    """Its result once it is true."""
    for _ in range(6000):
        result = condition()
        if result:
            return result
        time.sleep(0.01)
    sys.exit('FAILED: what is waited for does not come')


def open_for_reader(pipe):
    """The end to write to; None while nobody reads."""
    try:
        end = os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
    except OSError:
        return None
    os.set_blocking(end, True)
    return end


def run_stalled(program, sequence, work, send):
    """The exit code of a recording run that gets a signal while it waits for its camera."""
    image = data_lines(work, 'sequence', 'depth.txt')[STALLED].split()[1]
    place = os.path.join(work, 'sequence', image)
    shutil.move(place, f'{work}/image.png')
    os.mkfifo(place)
    with subprocess.Popen([program('rgbd_odometry'), *sequence, '--threads=1',
                           f'--output={work}/stopped', f'--record={work}/stopped.mcap'],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        pipe = wait_for(lambda: open_for_reader(place))
        wait_for(lambda: os.path.getsize(f'{work}/stopped.mcap.partial') > 2**20)
        process.send_signal(send)
        with open(f'{work}/image.png', 'rb') as image, open(pipe, 'wb') as end:
            if send != signal.SIGKILL:
                shutil.copyfileobj(image, end)
        process.communicate(timeout=60)
    os.remove(place)
    shutil.move(f'{work}/image.png', place)
    return process.returncode


def check_stopped(program, sequence, work):
    check(run_stalled(program, sequence, work, signal.SIGINT) == 6, 'exit code')
    topics = read_topics(f'{work}/stopped.mcap')
    check_poses(topics, f'{work}/stopped', 'trajectory.txt')
    check(0 < len(topics[COLOR][2]) <= STALLED + 1 and len(topics['/path'][2]) == 1, 'images')
    check(not os.path.exists(f'{work}/stopped.mcap.partial'), 'unfinished file')

    os.remove(f'{work}/stopped.mcap')
    check(run_stalled(program, sequence, work, signal.SIGKILL) == -signal.SIGKILL, 'exit code')
    check(not os.path.exists(f'{work}/stopped.mcap'), 'file of a killed run')
    command = (program('rgbd_odometry'), *sequence, f'--output={work}/next',
               f'--record={work}/stopped.mcap')
    said = fail(*command)
    check('stopped.mcap.partial: another program is writing it, or a killed' in said, said)
    os.rename(f'{work}/stopped.mcap.partial', f'{work}/killed.mcap')
    said = subprocess.run([program('rgbd_odometry'), f'--dataset={work}/killed.mcap', '--noreport',
                           f'--output={work}/killed'], capture_output=True, text=True, check=False)
    check(said.returncode == 6 and 'is cut off' in said.stderr, said.stderr)
    check(0 < len(data_lines(work, 'killed', 'trajectory.txt')) <= STALLED, 'poses')


def check_times(program, sequence, work):
    for name in ('rgb.txt', 'depth.txt'):
        rows = [line.split(' ', 1) for line in data_lines(work, 'sequence', name)]
        with open(f'{work}/sequence/{name}', 'w', encoding='utf-8') as file:
            file.writelines(f'{float(time) + 4e9:.6f} {rest}\n' for time, rest in rows)
    said = fail(program('rgbd_odometry'), *sequence, '--groundtruth=none', f'--output={work}/late',
                f'--record={work}/late.mcap')
    check('1970 to 2038' in said and not any('late' in name for name in os.listdir(work)), said)


def main(bin_folder, work):
    program = lambda name: os.path.join(bin_folder, name)
    sequence = simulate(bin_folder, work)
    check_whole_run(program, sequence, work)
    check_lost_frames(bin_folder, program, f'{work}/lost')
    check_stopped(program, sequence, work)
    check_times(program, sequence, work)


if __name__ == '__main__':
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], folder)
    print('ok')
