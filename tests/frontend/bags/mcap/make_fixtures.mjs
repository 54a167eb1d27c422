// Writes the recordings of mcap_file_test.cc with the format's own library:
//   npm i @mcap/core @foxglove/rosmsg @foxglove/rosmsg-msgs-common \
//     @foxglove/rosmsg-serialization @foxglove/rosmsg2-serialization \
//     lz4js zstd-codec
//   NODE_PATH=node_modules node make_fixtures.mjs FOLDER
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const require = createRequire(path.join(process.cwd(), 'x.js'));
const { McapWriter } = require('@mcap/core');
const { parse } = require('@foxglove/rosmsg');
const common = require('@foxglove/rosmsg-msgs-common');
const ros1 = require('@foxglove/rosmsg-serialization');
const ros2 = require('@foxglove/rosmsg2-serialization');
const lz4 = require('lz4js');
const { ZstdCodec } = require('zstd-codec');

const zstd = await new Promise((done) => ZstdCodec.run((z) => done(new z.Simple())));
const codecs = {
  none: undefined,
  lz4: (bytes) => ({ compression: 'lz4', compressedData: lz4.compress(bytes) }),
  zstd: (bytes) => ({ compression: 'zstd', compressedData: zstd.compress(bytes) }),
};

const width = 32, height = 24, frames = 12, start = 1000;
const optical = 'camera_color_optical_frame';

// The definition of a type and all types that it contains, in the spelling of
// the ROS version.
function definitions(types, names, root) {
  const all = [];
  const add = (name) => {
    const short = name.replace('/msg/', '/');
    const found = types[name] ?? types[short];
    all.push({ ...found, name });
    for (const field of found.definitions) {
      if (field.isComplex && !all.some((d) => d.name === field.type)) add(field.type);
    }
  };
  add(root);
  return [{ definitions: all[0].definitions }, ...all.slice(1)];
}

async function write(file, version, codec, { chunks = true, summary = true } = {}) {
  const types = version === 1 ? common.ros1 : common.ros2humble;
  const part = version === 1 ? '' : 'msg/';
  const writers = {};
  const channels = {};
  const bytes = [];
  let size = 0n;
  const writable = {
    position: () => size,
    write: async (data) => { bytes.push(Buffer.from(data)); size += BigInt(data.length); },
  };
  const mcap = new McapWriter({
    writable, chunkSize: 20000, useChunks: chunks, compressChunk: codecs[codec],
    repeatSchemas: summary, repeatChannels: summary, useSummaryOffsets: summary,
    useStatistics: summary, useMessageIndex: summary, useChunkIndex: summary,
  });
  await mcap.start({ profile: `ros${version}`, library: '' });
  const nanoseconds = (time) => BigInt(Math.round(time * 1e6)) * 1000n;
  const stampOf = (time) => {
    const all = nanoseconds(time);
    const seconds = Number(all / 1000000000n), rest = Number(all % 1000000000n);
    return { sec: seconds, nsec: rest, nanosec: rest };
  };
  const header = (time) => ({ seq: 0, stamp: stampOf(time), frame_id: optical });
  const send = async (topic, type, time, message) => {
    const name = `sensor_msgs/${part}${type}`;
    writers[type] ??= new (version === 1 ? ros1 : ros2).MessageWriter(
        definitions(types, part, name));
    if (channels[topic] === undefined) {
      const schemaId = await mcap.registerSchema({
        name, encoding: `ros${version}msg`, data: new Uint8Array() });
      channels[topic] = await mcap.registerChannel({
        schemaId, topic, messageEncoding: version === 1 ? 'ros1' : 'cdr',
        metadata: new Map([['offered_qos_profiles', '']]) });
    }
    await mcap.addMessage({
      channelId: channels[topic], sequence: 0, logTime: nanoseconds(time),
      publishTime: nanoseconds(time), data: writers[type].writeMessage(message) });
  };
  const K = [30, 0, 15.5, 0, 30, 11.5, 0, 0, 1];
  const P = [30, 0, 15.5, 0, 0, 30, 11.5, 0, 0, 0, 1, 0];
  const R = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const D = [0, 0, 0, 0, 0];
  const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
  const info = {
    header: header(start), height, width, distortion_model: 'plumb_bob',
    K, P, R, D, k: K, p: P, r: R, d: D, binning_x: 0, binning_y: 0, roi,
  };
  await send('/camera/color/camera_info', 'CameraInfo', start, info);
  for (let i = 0; i < frames; ++i) {
    const time = start + i / 30;
    const color = new Uint8Array(width * height * 3);
    for (let p = 0; p < color.length; ++p) color[p] = [10, 60, 110][p % 3] + i;
    const depth = new Uint16Array(width * height).fill(1000 + i);
    depth[0] = 0;
    depth[1] = 65535;
    const image = (at, encoding, step, data) => ({
      header: header(at), height, width, encoding, is_bigendian: 0, step, data });
    await send('/camera/color/image_raw', 'Image', time + 0.01,
        // in nanoseconds its stamp, not when it was received
        image(time, 'bgr8', 3 * width, color));
    await send('/camera/depth/image_raw', 'Image', time + 0.014,
        image(time + 0.004, '16UC1', 2 * width, new Uint8Array(depth.buffer)));
  }
  await mcap.end();
  writeFileSync(file, Buffer.concat(bytes));
  console.log(file, Number(size));
}

const folder = process.argv[2] ?? '.';
await write(`${folder}/ros2_zstd.mcap`, 2, 'zstd');
await write(`${folder}/ros2_lz4_no_summary.mcap`, 2, 'lz4', { summary: false });
await write(`${folder}/ros2_no_chunks.mcap`, 2, 'none', { chunks: false });
await write(`${folder}/ros1_lz4.mcap`, 1, 'lz4');
