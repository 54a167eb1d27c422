"""An mcap file of a simulated run, taken apart by mcap.dev/spec.

usage: mcap_export_test.py BIN_FOLDER [--no_checksums]

Every record, offset, count and checksum has to be right; messages have to say
what trajectory.txt, keyframes.csv and other exports do, the camera and the
images what they were. With --no_checksums, of a build without libdeflate,
checksums have to be 0.
"""

import base64
import csv
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

sys.dont_write_bytecode = True
from export_test import (check, data_lines, matrix_of, moved, numbers, read_lines,
                         read_ply, read_png, run, same)

MAGIC = b'\x89MCAP0\r\n'
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, DATA_END = 0x0b, 0x0f
FRAMES = 30
LENSES = {
    'plumb_bob': ('', ('k1', 'k2', 'p1', 'p2', 'k3')),
    'rational_polynomial': ('', ('k1', 'k2', 'p1', 'p2', 'k3', 'k4', 'k5', 'k6')),
    'kannala_brandt': ('Camera.type: KannalaBrandt8\n', ('k1', 'k2', 'k3', 'k4')),
}


def checksum(data):
    return 0 if '--no_checksums' in sys.argv else zlib.crc32(data)


def records(data, begin, end):
    """Kind, content, offset and size of each record of a part of the file."""
    while begin < end:
        kind, size = struct.unpack_from('<BQ', data, begin)
        check(begin + 9 + size <= end, 'record at', begin)
        yield kind, data[begin + 9:begin + 9 + size], begin, 9 + size
        begin += 9 + size


def take(content, layout):
    """Fields that end with the record; s: what comes after its length."""
    fields, at = [], 0
    for letter in layout:
        if letter == 's':
            size, = struct.unpack_from('<I', content, at)
            fields.append(content[at + 4:at + 4 + size])
            check(len(fields[-1]) == size, 'text')
            at += 4 + size
        else:
            fields.append(struct.unpack_from('<' + letter, content, at)[0])
            at += struct.calcsize('<' + letter)
    return (*fields, content[at:])


def read_mcap(path, profile=b'', encodings=(b'json', b'jsonschema'), read_schema=json.loads,
              read_message=lambda text, schema: json.loads(text)):
    """Topics with the names of their schemas, schema and messages: (ns, content)."""
    with open(path, 'rb') as file:
        data = file.read()
    check(data.startswith(MAGIC) and data.endswith(MAGIC), 'magic')
    everything = list(records(data, len(MAGIC), len(data) - len(MAGIC)))
    kinds = [record[0] for record in everything]
    end = kinds.index(DATA_END)
    check(kinds[0] == HEADER and kinds.count(HEADER) == 1, 'header')
    check(take(everything[0][1], 's')[0] == profile, 'profile')
    check(set(kinds[1:end]) == {CHUNK, INDEX}, 'data section', kinds)

    topics, schemas, seen, indexes, last, waiting = {}, [], [], [], 0, {}
    for kind, content, offset, size in everything[1:end]:
        if kind == INDEX:
            channel, entries, rest = take(content, 'Hs')
            check(not rest and entries == waiting.pop(channel), 'index of messages')
            indexes[-1][4] += struct.pack('<HQ', channel, offset)
            indexes[-1][5] += size
            continue
        check(not waiting, 'channels without index', waiting)
        first, final, unpacked, crc, codec, packed, chunk = take(content, 'QQQIsQ')
        check(codec == b'' and unpacked == packed == len(chunk), 'chunk')
        check(crc == checksum(chunk), 'checksum of chunk')
        times = []
        for inner, record, at, _ in records(chunk, 0, len(chunk)):
            if inner == MESSAGE:
                channel, number, log, published, text = take(record, 'HIQQ')
                check(log == published and log >= last, 'times')
                schema, messages = topics[channel][2:]
                check(number == len(messages), 'number of message')
                messages.append((log, read_message(text, schema)))
                last = log
                times.append(log)
                waiting[channel] = waiting.get(channel, b'') + struct.pack('<QQ', log, at)
            elif inner == SCHEMA:
                schemas.append(take(record, 'Hsss'))
            else:
                check(inner == CHANNEL, 'in chunk', inner)
                channel, schema, topic, encoding, metadata, rest = take(record, 'HHsss')
                check(encoding == encodings[0] and metadata == rest == b'', topic)
                _, name, encoding, text, rest = next(s for s in schemas if s[0] == schema)
                check(encoding == encodings[1] and rest == b'' and schema > 0, name)
                topics[channel] = (topic.decode(), name.decode(), read_schema(text), [])
            if inner != MESSAGE:
                seen.append((inner, record))
        check((first, final) == (times[0], times[-1]), 'times of chunk')
        indexes.append([first, final, offset, size, b'', 0, b'', packed, unpacked])
    check(not waiting, 'channels without index', waiting)

    start = everything[end][2] + everything[end][3]
    crc, = struct.unpack('<I', everything[end][1])
    check(crc == checksum(data[:everything[end][2]]), 'checksum of data')
    summary = everything[end + 1:]
    kinds = [record[0] for record in summary]
    check(kinds == sorted(kinds[:-2]) + [STATISTICS, FOOTER], 'summary', kinds)
    check(sorted(seen) == sorted(r[:2] for r in summary if r[0] in (SCHEMA, CHANNEL)),
          'schemas and channels of the summary')
    check(indexes == [list(take(r[1], 'QQQQsQsQQ')[:-1])
                      for r in summary if r[0] == CHUNK_INDEX], 'indexes of chunks')
    total = sum(len(topic[3]) for topic in topics.values())
    counts = b''.join(struct.pack('<HQ', c, len(topics[c][3])) for c in
                      sorted(topics, key=lambda c: topics[c][0]))
    check(take(summary[-2][1], 'QHIIIIQQs') ==
          (total, len(schemas), len(topics), 0, 0, len(indexes), indexes[0][0],
           indexes[-1][1], counts, b''), 'statistics')
    check(struct.unpack('<QQI', summary[-1][1]) ==
          (start, 0, checksum(data[start:-len(MAGIC) - 4])), 'footer')
    return {topic[0]: topic[1:] for topic in topics.values()}


def check_schema(schema, value, name):
    if isinstance(value, dict):
        check(schema['type'] == 'object' and schema['properties'].keys() == value.keys(),
              'schema of', name)
        for key, field in value.items():
            check_schema(schema['properties'][key], field, key)
    elif isinstance(value, list):
        check(schema['type'] == 'array', 'schema of', name)
        for item in value:
            check_schema(schema['items'], item, name)
    else:
        kind = 'string' if isinstance(value, str) else 'number'
        check(schema['type'] == kind, 'schema of', name)
        check((schema.get('contentEncoding') == 'base64') == (name == 'data'), name)


def pose_of(translation, rotation):
    return matrix_of(*[rotation[k] for k in 'wxyz'], *[translation[k] for k in 'xyz'])


def check_messages(topics, path, keyframes):
    """Against poses by their times (ns); returns what each topic says."""
    expected = {
        '/tf_static': 'FrameTransform', '/tf': 'FrameTransform', '/path': 'PosesInFrame',
        '/cloud': 'PointCloud', '/camera/calibration': 'CameraCalibration',
        '/camera/image': 'CompressedImage'}
    if keyframes:
        expected['/keyframes'] = 'PosesInFrame'
    check({topic: value[0] for topic, value in topics.items()} ==
          {topic: 'foxglove.' + name for topic, name in expected.items()}, *topics)
    said = {topic: [message for _, message in value[2]] for topic, value in topics.items()}
    for topic, (_, schema, messages) in topics.items():
        for time, message in messages:
            check_schema(schema, message, topic)
            check(time == message['timestamp']['sec'] * 10**9 +
                  message['timestamp']['nsec'], 'time in', topic)
    check([time for time, _ in topics['/tf'][2]] == list(path), 'times of transforms')
    for pose, message in zip(path.values(), said['/tf']):
        check((message['parent_frame_id'], message['child_frame_id']) ==
              ('world', 'camera'), message)
        check(same(pose, pose_of(message['translation'], message['rotation']), 1e-8), message)
    for topic, poses in (('/path', path.values()), ('/keyframes', keyframes)):
        for message in said.get(topic, []):
            check(message['frame_id'] == 'world' and len(message['poses']) == len(poses), topic)
            check(all(same(pose, pose_of(p['position'], p['orientation']), 1e-8)
                      for pose, p in zip(poses, message['poses'])), topic)
    upright, = said['/tf_static']
    check((upright['parent_frame_id'], upright['child_frame_id']) == ('map', 'world'), 'map')
    up = pose_of(upright['translation'], upright['rotation'])
    check(moved(up, [0, -1, 0]) == [0, 0, 1] and moved(up, [0, 0, 1]) == [1, 0, 0], 'map')
    return said


def check_cloud(message, ply):
    data, names = base64.b64decode(message['data']), 'x y z red green blue alpha'.split()
    check(message['fields'] ==
          [{'name': name, 'offset': 4 * i, 'type': 7} if i < 3 else
           {'name': name, 'offset': 9 + i, 'type': 1} for i, name in enumerate(names)] and
          message['point_stride'] == 16, message['fields'])
    points = list(struct.iter_unpack('<3f4B', data))
    check([(*p, 255) for p in read_ply(ply)[0]] == points and len(points) > 1000, 'cloud')


def check_calibration(said, model, values):
    check(len(said['/camera/calibration']) == len(said['/camera/image']), 'calibrations')
    for camera in said['/camera/calibration']:
        check(camera['distortion_model'] == model and
              camera['D'] == list(values[:len(LENSES[model][1])]), camera)
        check(camera['K'] == [262, 0, 159.5, 0, 263, 118, 0, 0, 1], camera)
        check(camera['P'] == [262, 0, 159.5, 0, 0, 263, 118, 0, 0, 0, 1, 0], camera)
        check((camera['width'], camera['height'], camera['frame_id']) ==
              (320, 240, 'camera'), camera)


def fail(*command):
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    check(result.returncode == 2, result.stderr)
    return result.stderr


def write_lines(lines, *path):
    with open(os.path.join(*path), 'w', encoding='utf-8') as file:
        file.writelines(line + '\n' for line in lines)


def main(bin_folder, work):
    program = lambda name: os.path.join(bin_folder, name)
    values = (0.02, -0.03, 0.001, -0.002, 0.01, 0.03, 0.02, 0.01)
    for model, (kind, names) in LENSES.items():
        with open(f'{work}/{model}.yaml', 'w', encoding='utf-8') as file:
            file.write('Camera.fx: 262\nCamera.fy: 263\nCamera.cx: 159.5\nCamera.cy: 118\n'
                       'Camera.width: 320\nCamera.height: 240\n' + kind)
            file.writelines(f'Camera.{n}: {v}\n' for n, v in zip(names, values))
    sequence, result = os.path.join(work, 'sequence'), os.path.join(work, 'run')
    run(program('rgbd_simulate'), '--path=table', f'--frames={FRAMES}', '--rate=5',
        f'--camera={work}/plumb_bob.yaml', f'--output={sequence}')
    run(program('rgbd_slam'), f'--dataset={sequence}', f'--camera={sequence}/camera.yaml',
        f'--output={result}', '--noreport')

    path = {round(1e6 * x[0]) * 1000: matrix_of(x[7], *x[4:7], *x[1:4])
            for x in map(numbers, data_lines(result, 'trajectory.txt'))}
    with open(os.path.join(result, 'keyframes.csv'), encoding='utf-8') as file:
        keyframes = [matrix_of(*[float(row[k]) for k in
                                 ('qw', 'qx', 'qy', 'qz', 'tx', 'ty', 'tz')])
                     for row in csv.DictReader(file)]
    check(len(path) == FRAMES and len(keyframes) > 1, 'frames and keyframes')

    def export(name, output, *flags):
        run(program('rgbd_export'), f'--run={result}', f'--to={name}',
            f'--output={work}/{output}', '--voxel=0.05', *flags)
        return os.path.join(work, output)

    topics = read_mcap(export('mcap', 'run.mcap'))
    said = check_messages(topics, path, keyframes)
    nerfstudio = export('nerfstudio', 'nerfstudio')
    check_cloud(said['/cloud'][0], f'{nerfstudio}/points.ply')

    # Images by what this project reads them with: in place of those of the recording.
    images = sorted(os.listdir(f'{nerfstudio}/images'))
    check(1 < len(images) == len(said['/camera/image']) < FRAMES, 'images')
    stamps = data_lines(sequence, 'rgb.txt')
    copy = shutil.copytree(sequence, f'{work}/copy')
    for name, (time, image) in zip(images, topics['/camera/image'][2]):
        stamp, file = stamps[int(name.split('.')[0])].split()
        check(abs(float(stamp) - time / 1e9) < 1e-6 and image['format'] == 'jpeg', name)
        with open(os.path.join(copy, file), 'wb') as place:
            place.write(base64.b64decode(image['data']))
    decoded = export('nerfstudio', 'decoded', f'--dataset={copy}')
    for name in images[1::10]:
        off = [abs(a - b) for rows in zip(read_png(f'{nerfstudio}/images/{name}'),
                                          read_png(f'{decoded}/images/{name}'))
               for a, b in zip(*rows)]
        check(0 < sum(off) / len(off) < 4, name, 'is off by', sum(off) / len(off))

    check_calibration(said, 'plumb_bob', values)
    for model, flags in (('rational_polynomial', ()), ('kannala_brandt', ()),
                         ('kannala_brandt', ('--undistort',))):
        said = check_messages(read_mcap(export(
            'mcap', 'run.mcap', '--min_distance=0.5', f'--camera={work}/{model}.yaml',
            *flags)), path, keyframes)
        check_calibration(said, *(('plumb_bob', [0] * 8) if flags else (model, values)))

    # Our own reader takes it for what it is.
    said = fail(program('rgbd_odometry'), f'--dataset={work}/run.mcap', f'--output={work}/no')
    check('messages encoded as json' in said, said)

    # Without a map, and with frames of which nobody knows where they were.
    for file in ('keyframes.csv', 'slam.csv'):
        os.remove(os.path.join(result, file))
    rows = [row.split(',') for row in read_lines(result, 'frames.csv')]
    for row in rows[-5:]:
        row[rows[0].index('segment')] = '1'
    write_lines([','.join(row) for row in rows], result, 'frames.csv')
    first = dict(list(path.items())[:-5])
    check_messages(read_mcap(export('mcap', 'run.mcap')), first, [])
    poses = [line.split() for line in data_lines(result, 'trajectory.txt')]
    poses[0][0] = '-1'
    write_lines([' '.join(pose) for pose in poses], result, 'trajectory.txt')
    said = fail(program('rgbd_export'), f'--run={result}', '--to=mcap')
    check('1970' in said and not any('mcap' in name for name in os.listdir(result)), said)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], folder)
    print('ok')
