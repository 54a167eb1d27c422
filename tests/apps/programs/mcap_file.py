"""Takes an mcap file apart by mcap.dev/spec, for the tests of recordings for ROS 2.

Every record, offset, count and checksum has to be right. With --no_checksums
among the arguments, of a build without libdeflate, checksums have to be 0.
"""

import struct
import sys
import zlib

sys.dont_write_bytecode = True
from exported_files import check

MAGIC = b'\x89MCAP0\r\n'
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, DATA_END = 0x0b, 0x0f


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


def read_mcap(path, read_schema, read_message):
    """Topics with the names of their types, schema and messages: (ns, content)."""
    with open(path, 'rb') as file:
        data = file.read()
    check(data.startswith(MAGIC) and data.endswith(MAGIC), 'magic')
    everything = list(records(data, len(MAGIC), len(data) - len(MAGIC)))
    kinds = [record[0] for record in everything]
    end = kinds.index(DATA_END)
    check(kinds[0] == HEADER and kinds.count(HEADER) == 1, 'header')
    check(take(everything[0][1], 's')[0] == b'ros2', 'profile')
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
                check(encoding == b'cdr' and metadata == rest == b'', topic)
                _, name, encoding, text, rest = next(s for s in schemas if s[0] == schema)
                check(encoding == b'ros2msg' and rest == b'' and schema > 0, name)
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
