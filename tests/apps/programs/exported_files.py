"""Readers of images, meshes and clouds, written from their formats alone."""

import json
import struct
import sys
import zlib


def check(condition, *what):
    if not condition:
        sys.exit('FAILED: ' + ' '.join(str(word) for word in what))


def read_png(path):
    """Rows of a PNG of 8 or 16 bits without a palette, each a list of numbers."""
    with open(path, 'rb') as file:
        data = file.read()
    check(data[:8] == b'\x89PNG\r\n\x1a\n', path, 'is no PNG')
    at, packed = 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            width, height, bits, color = struct.unpack('>IIBB', data[at + 8:at + 18])
        if kind == b'IDAT':
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    pixel = {0: 1, 2: 3}[color] * bits // 8
    raw, above, rows = zlib.decompress(packed), bytes(width * pixel), []
    for y in range(height):
        begin = y * (width * pixel + 1)
        method, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * pixel])
        for i in range(len(line)):
            left = line[i - pixel] if i >= pixel else 0
            corner = above[i - pixel] if i >= pixel else 0
            if method == 4:
                guess = left + above[i] - corner
                nearest = min((abs(guess - left), 0, left),
                              (abs(guess - above[i]), 1, above[i]),
                              (abs(guess - corner), 2, corner))[2]
            else:
                nearest = [0, left, above[i], (left + above[i]) // 2][method]
            line[i] = (line[i] + nearest) & 255
        above = bytes(line)
        if bits == 16:
            rows.append(struct.unpack(f'>{len(line) // 2}H', above))
        else:
            rows.append(above)
    return rows


def read_ply(path):
    """Vertices (x, y, z, red, green, blue) and faces of a binary PLY."""
    with open(path, 'rb') as file:
        header, body = file.read().split(b'end_header\n', 1)
    counts = {line.split()[1]: int(line.split()[2])
              for line in header.decode().splitlines() if line.startswith('element')}
    check(header.startswith(b'ply\nformat binary_little_endian 1.0\n'), header)
    vertices = list(struct.iter_unpack('<3f3B', body[:15 * counts['vertex']]))
    faces = list(struct.iter_unpack('<B3i', body[15 * counts['vertex']:]))
    check(len(faces) == counts.get('face', 0), path, 'faces')
    check(all(face[0] == 3 for face in faces), path, 'is not of triangles')
    return vertices, [face[1:] for face in faces]


def read_glb(path):
    """Positions, colours (0..1, linear) and faces, by the accessors of the file."""
    with open(path, 'rb') as file:
        data = file.read()
    magic, version, total = struct.unpack('<4sII', data[:12])
    check((magic, version, total) == (b'glTF', 2, len(data)), 'header of', path)
    size, kind = struct.unpack('<I4s', data[12:20])
    check(kind == b'JSON' and size % 4 == 0, 'first chunk')
    scene = json.loads(data[20:20 + size])
    binary_size, kind = struct.unpack('<I4s', data[20 + size:28 + size])
    binary = data[28 + size:]
    check(kind == b'BIN\0' and binary_size == len(binary) and binary_size % 4 == 0,
          'second chunk')
    check(scene['buffers'][0]['byteLength'] == len(binary), 'buffer')
    mesh = scene['meshes'][scene['nodes'][scene['scenes'][0]['nodes'][0]]['mesh']]
    (primitive,) = mesh['primitives']

    def values(index):
        accessor = scene['accessors'][index]
        view = scene['bufferViews'][accessor['bufferView']]
        code, largest = {5126: ('f', 1), 5123: ('H', 65535), 5125: ('I', 1)}[
            accessor['componentType']]
        count = {'SCALAR': 1, 'VEC3': 3, 'VEC4': 4}[accessor['type']]
        begin = view.get('byteOffset', 0)
        check(begin % 4 == 0, 'alignment')
        rows = list(struct.iter_unpack(f'<{count}{code}',
                                       binary[begin:begin + view['byteLength']]))
        check(len(rows) == accessor['count'], 'count')
        if 'min' in accessor:
            for k in range(count):
                check(abs(min(row[k] for row in rows) - accessor['min'][k]) < 1e-5 and
                      abs(max(row[k] for row in rows) - accessor['max'][k]) < 1e-5,
                      'bounds')
        return [[value / largest for value in row] for row in rows]

    indices = [int(row[0]) for row in values(primitive['indices'])]
    faces = list(zip(indices[::3], indices[1::3], indices[2::3]))
    return (values(primitive['attributes']['POSITION']),
            values(primitive['attributes']['COLOR_0']), faces)
