"""Commands that tests/docs/docs_commands.py does not run as written on a page.

All other commands are run. A listed command that is no longer on its page fails
the test.
"""

import collections

# The reason, the command that is run instead (empty: none), and whether the
# command is run as written with --slow.
Instead = collections.namedtuple('Instead', 'why run is_slow', defaults=[False])


def left_out(why):
    return Instead(why, '')


def slow(why):
    return Instead(why, '', True)


def in_place(run, why):
    return Instead(why, run)


def simulated(folder, options='', frames=4):
    return (f'rgbd_simulate --frames={frames} {options} --output={folder}'
            ' >/dev/null\n')


# By page: commands that prepare its files.
BEFORE = {
    'docs/batch.md':
        'mkdir simulated\n' +
        simulated('rgbd_dataset_freiburg1_xyz', '--camera=tum_fr1', 10) +
        simulated('simulated/xyz', '--path=xyz', 10) +
        simulated('simulated/pan_tilt', '--path=pan_tilt', 10),
    'docs/view.md': simulated('table', '--path=handheld', 30),
    'docs/thesis_experiments.md':
        simulated('rgbd_dataset_freiburg2_xyz', '--camera=tum_fr2'),
}

SLURM = 'needs a cluster; tests/apps/programs/slurm_test.sh runs a job array on one'

# By page and command (on one line, without its comment).
EXCEPTIONS = {
    'docs/calibration.md': {
        'rgbd_simulate --path=handheld --frames=600 --output=room':
            in_place(simulated('room', '--path=handheld', 40),
                     'renders for a minute'),
        'rgbd_calibrate --dataset=room --camera=wrong.yaml --output=calibration':
            in_place('rgbd_calibrate --dataset=room --camera=wrong.yaml '
                     '--output=calibration --max_views=5000',
                     'solves for more than so few frames need'),
        'rgbd_slam --dataset=room --camera=wrong.yaml --calibrate --output=runs/both':
            left_out('tests/apps/programs/calibrate_program_test.cc runs it'),
    },
    'docs/slam.md': {
        'rgbd_simulate --scene=table --path=table --frames=1800 --output=table':
            in_place(simulated('table', '--path=handheld', 30),
                     'renders for two minutes'),
    },
    'CONTRIBUTING.md': {
        'scripts/test': left_out('it runs this test'),
        'ctest --test-dir build -R costs': left_out('runs as part of all'),
        'scripts/check_format': left_out('needs a checkout; CI runs it'),
        'scripts/check': left_out('takes over an hour; it runs this test'),
        'scripts/fuzz': left_out('takes minutes'),
        'scripts/coverage': left_out('takes minutes'),
        'scripts/mutants': left_out('takes minutes'),
        'scripts/endurance': left_out('takes an hour'),
        'scripts/check_packages': left_out('takes minutes and needs root'),
        'scripts/check_dockerfile': left_out('takes half an hour and needs root'),
        'scripts/check_platforms': left_out('takes 40 minutes and needs root'),
        'scripts/benchmark --quick':
            left_out('takes minutes; tests/benchmarks/benchmark_programs_test.cc runs '
                     'the programs'),
        'scripts/benchmark --write': left_out('takes minutes, as above'),
        'scripts/accuracy': left_out('takes minutes'),
        'scripts/cost_accuracy': left_out('takes minutes'),
        'scripts/frontends': left_out('takes minutes'),
        'scripts/tum_benchmark freiburg1_desk':
            left_out('downloads; tests/scripts/tum_benchmark_test.py runs it'),
    },
    'README.md': {
        'scripts/demo': slow('renders and tracks for minutes'),
        'scripts/test': left_out('it runs this test'),
        'scripts/download_tum freiburg1_xyz':
            in_place(
                simulated('rgbd_dataset_freiburg1_xyz', '--camera=tum_fr1', 10),
                'needs the network; tests/scripts/download_tum_test.sh runs it '
                'against a server of its own'),
    },
    'docs/batch.md': {
        'seq 0 7 | parallel rgbd_batch --flagfile=plan.flags --resume '
        '--jobs=1 --shard={}/8':
            in_place(
                'for i in $(seq 0 7); do rgbd_batch --flagfile=plan.flags '
                '--resume --jobs=1 --shard=$i/8; done',
                'GNU parallel may be missing'),
        'job=$(sbatch --parsable batch.sh)': left_out(SLURM),
        'sbatch --dependency=afterany:$job --wrap "rgbd_batch '
        '--flagfile=plan.flags --merge"': left_out(SLURM),
    },
    'docs/sources.md': {
        'rgbd_odometry --dataset=fr1_xyz.bag --output=runs/bag':
            left_out('needs a bag; tests/frontend/bags/ros1_bag_test.cc '
                     'writes some'),
        'rgbd_convert --dataset=recording_folder '
        '--topics=/camera/color/image_raw,/camera/depth/image_raw '
        '--output=tum':
            left_out('needs a bag; tests/frontend/bags/bag_files_test.cc '
                     'writes some'),
        'rgbd_odometry --source=openni2 --dataset=any --frames=0s-60s '
        '--output=runs/live':
            left_out('needs a camera'),
    },
    'docs/python.md': {
        'apt-get install pybind11-dev python3-dev python3-numpy':
            left_out('needs root; scripts/install_dependencies does it'),
        'python3 -m venv --system-site-packages venv':
            left_out('tests/python/pip_test.sh does it'),
        'venv/bin/pip wheel --no-deps --wheel-dir=wheels .':
            left_out('tests/python/pip_test.sh does it'),
        'venv/bin/pip install wheels/rgbd_pose-*.whl':
            left_out('tests/python/pip_test.sh does it'),
    },
}
