"""tum_benchmark_test.py SOURCE BIN: the table of a rendered sequence that has the name of a real one."""
import pathlib
import subprocess
import sys
import tempfile

SOURCE, BIN = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
FRAMES = 50


def check(condition, *what):
    if not condition:
        sys.exit('FAILED: ' + ' '.join(map(str, what)))


def benchmark(folder, *names):
    return subprocess.run([SOURCE / 'scripts/tum_benchmark', f'--bin={BIN}', f'--folder={folder}',
                           *names], capture_output=True, text=True)


def main():
    with tempfile.TemporaryDirectory() as folder:
        empty = benchmark(folder)
        check(empty.returncode != 0 and 'has no sequence' in empty.stderr, empty)
        unknown = benchmark(folder, 'freiburg9_desk')
        check(unknown.returncode == 2 and "unknown sequence 'freiburg9_desk'" in unknown.stderr,
              unknown)

        subprocess.run([BIN / 'rgbd_simulate', '--path=handheld', f'--frames={FRAMES}',
                        f'--output={folder}/rgbd_dataset_freiburg1_desk'],
                       check=True, stdout=subprocess.DEVNULL)
        done = benchmark(folder)
        check(done.returncode == 0, done.stderr)
        rows = [[cell.strip() for cell in line.strip('|').split('|')]
                for line in done.stdout.splitlines()]
        check([len(row) for row in rows] == [10] * 4, done.stdout)
        for row, program in zip(rows[2:], ['rgbd_odometry', 'rgbd_slam']):
            check(row[:4] == ['freiburg1_desk', program, str(FRAMES), '0'], row)
            check(row[-1] == 'DVO SLAM 21, ORB-SLAM2 16', row)
        rigid, scaled = float(rows[3][6]), float(rows[3][7])
        # The camera of the preset is not the rendered one.
        check(0 < rigid < 100, rows[3])
        check(0 < scaled < rigid, 'a scale must make the error smaller:', rows[3])
        keyframes = pathlib.Path(folder, 'runs/freiburg1_desk-rgbd_slam/keyframes.txt')
        check(1 < len(keyframes.read_text().splitlines()) < FRAMES, 'not keyframes alone')
    print('ok')


if __name__ == '__main__':
    main()
