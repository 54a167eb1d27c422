'use strict';

// The map of a run of rgbd_slam: keyframes and their pairs, from above.

const PAIR_KINDS = [
  {name: 'tracked pairs', color: COLOR.black, width: 1.2},
  {name: 'further pairs', color: COLOR.sky, width: 0.8},
  {name: 'loops', color: COLOR.vermillion, width: 2.5},
];
// Colours of segments, different from those of pairs.
const KEYFRAME_COLORS = [COLOR.blue, COLOR.orange, COLOR.green, COLOR.purple];

// The transform from the map, whose world is the first camera, to the world of
// the ground truth, which errors and the paths above refer to.
function truthFromMap(data) {
  const e = data.metrics.evaluation;
  const pose = data.path.true_x && e && e.truth_from_estimate;
  if (!pose) return point => point;
  const [x, y, z, w] = pose.quaternion_xyzw, t = pose.translation_m;
  return ([a, b, c]) => [
    (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c + t[0],
    2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c + t[1],
    2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c + t[2],
  ];
}

// The two axes that are approximately horizontal if the first camera is level,
// the one along which `points` extend farther first: it is drawn to the right.
function levelAxes(data, points) {
  const down = downVector(data).map(Math.abs);
  const vertical = down.indexOf(Math.max(...down));
  const length = k => {
    const all = points.map(point => point[k]);
    return Math.max(...all) - Math.min(...all);
  };
  return [0, 1, 2].filter(k => k !== vertical).sort((a, b) => length(b) - length(a));
}

// The height (px) of a plot with equal scales whose ranges fill its width.
function heightFor(element, xRange, yRange) {
  const kTitles = 110, kLeast = 280, kMost = 760;
  const ratio = Math.abs((yRange[1] - yRange[0]) / (xRange[1] - xRange[0]));
  const height = kTitles + ratio * Math.max(element.clientWidth - 70, 200);
  return Math.min(Math.max(height, kLeast), kMost);
}

function pointsOf(path) {
  return path.x.map((x, i) => (known(x) ? [x, path.y[i], path.z[i]] : null));
}

function largestDistance(before, after) {
  return largest(before.map((point, i) => (point && after[i]
      ? Math.hypot(...point.map((v, k) => v - after[i][k])) : null)));
}

// The number of segments at the end; 0 without a map.
function mapSegments(slam) {
  return new Set(((slam && slam.graph_keyframes) || []).map(k => k[3])).size;
}

function mapTraces(slam, before, after, move, [a, b]) {
  const put = points => {
    const moved = points.map(point => (point ? move(point) : [null, null, null]));
    return {type: 'scatter', x: moved.map(p => p[a]), y: moved.map(p => p[b]),
            hoverinfo: 'skip', connectgaps: false};
  };
  const traces = [];
  if (before) {
    traces.push(Object.assign(put(before), {
      mode: 'lines', name: 'odometry path',
      line: {color: COLOR.grey, width: 2, dash: 'dot'}}));
    traces.push(Object.assign(put(after), {
      mode: 'lines', name: 'final path',
      line: {color: COLOR.grey, width: 2}}));
  }
  const keyframes = slam.graph_keyframes;
  PAIR_KINDS.forEach((kind, k) => {
    const pairs = slam.graph_pairs.filter(pair => pair[2] === k);
    if (pairs.length === 0) return;
    traces.push(Object.assign(
        put(pairs.flatMap(([i, j]) => [keyframes[i], keyframes[j], null])), {
          mode: 'lines', name: `${kind.name} (${pairs.length})`,
          line: {color: kind.color, width: kind.width}}));
  });
  const add = (numbers, name, marker) => numbers.length && traces.push(Object.assign(
      put(numbers.map(i => keyframes[i])), {
        mode: 'markers', name: `${name} (${numbers.length})`, marker,
        customdata: numbers, hoverinfo: undefined,
        hovertemplate: 'keyframe %{customdata}<extra></extra>'}));
  const numbers = keyframes.map((keyframe, i) => i);
  const kept = numbers.filter(i => !keyframes[i][4]);
  const segments = [...new Set(kept.map(i => keyframes[i][3]))];
  add(numbers.filter(i => keyframes[i][4]), 'removed',
      {color: '#fff', size: 5, line: {color: COLOR.grey, width: 1}});
  segments.forEach((segment, k) => add(
      kept.filter(i => keyframes[i][3] === segment),
      segments.length > 1 ? `keyframes, segment ${segment + 1}` : 'keyframes',
      {color: KEYFRAME_COLORS[k % KEYFRAME_COLORS.length],
       size: kept.length > 300 ? 5 : 7,
       line: {color: '#fff', width: 1}}));
  return traces;
}

function map(data) {
  const slam = data.metrics.slam;
  if (!slam || !slam.graph_keyframes || !slam.graph_keyframes.length) return;
  const number = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
  const joined = slam.segments_joined
      ? `, ${number(slam.segments_joined, 'segment')} joined to others` : '';
  const gone = slam.keyframes_dropped
      ? ` (${slam.keyframes_dropped} more removed because others see the same)` : '';
  const element = section('Map',
      'Keyframes and the motions measured between them, seen from above: ' +
      `${number(slam.keyframes, 'keyframe')}${gone}, ` +
      `${number(slam.tracked_pairs + slam.pairs, 'pair')}, of these ` +
      `${slam.loops} closing loops${joined}. ` +
      (slam.unsolved ? `Solving for the poses failed ${number(slam.unsolved, 'time')}; ` +
          `last reason: ${slam.error || 'unknown'}. ` : '') +
      (mapSegments(slam) > 1 ? 'The relative poses of the segments are unknown. ' : '') +
      'Equal scales on both axes; a click on a name hides it.');
  const move = truthFromMap(data);
  const axes = levelAxes(data, slam.graph_keyframes.map(move));
  const before = data.odometry_path && pointsOf(data.odometry_path.before);
  const after = data.odometry_path && pointsOf(data.odometry_path.after);
  const traces = mapTraces(slam, before, after, move, axes);
  const all = letter => traces.flatMap(trace => trace[letter]);
  const [a, b] = axes.map(k => 'XYZ'[k]);
  const xRange = pathRange(all('x'), false), yRange = pathRange(all('y'), false);
  const div = plot('map', '', element, traces, {
    height: heightFor(element, xRange, yRange),
    xaxis: axis(a + ' (m)', {range: xRange}),
    yaxis: axis(b + ' (m)', {scaleanchor: 'x', range: yRange}),
    hovermode: 'closest',
  });
  div.style.height = '';
  if (!before) return;
  const unit = lengthUnit(largestDistance(before, after));
  element.append(make('p', {class: 'soft caption'},
      'Correction by the map: the final path is up to ' +
      `${digits(largestDistance(before, after) * unit.factor, 3)} ${unit.name} from the ` +
      'odometry path, which starts at the same pose.' + (data.metrics.run.lost
          ? ' The odometry does not know how the camera moved while it was lost.' : '')));
}
