'use strict';

// The page of a calibration: its verdict, the parameters, and what is left of the
// errors of held-out views with the first camera and with the one found.

const CAMERAS = [
  {name: 'with the first camera', at: 2, color: COLOR.grey},
  {name: 'with the camera found', at: 4, color: COLOR.blue},
];

// What to do after a camera was rejected: what the reason says, and the advice.
const ADVICE = [
  ['“fit no better” or “no error found”',
   'The first camera is as good: continue to use it.'],
  ['“halves of the recording disagree”',
   'There is an error that no parameter describes: blur, moving objects, a wrong ' +
   'depth unit, a lens of another kind.'],
  ['“not plausible”', 'A parameter makes up for another error: keep it with --fix.'],
  ['too few pairs, or no parameter determined',
   'Record half a minute; turn and move at the same time, with near and far objects ' +
   'in view.'],
];

function median(values) {
  const sorted = values.slice().sort((a, b) => a - b);
  const middle = (sorted.length - 1) / 2;
  return (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2;
}

function calibrationHeader(data) {
  const c = data.calibration;
  document.title = 'Calibration: rgbd_pose';
  page.append(make('h1', {}, c.accepted ? 'The new camera is better'
      : 'The first camera is kept'));
  if (!c.accepted) page.append(make('p', {}, c.reason));
  const figures = make('div', {class: 'figures'});
  for (const [value, text] of [
    [c.keyframes, 'keyframes'], [c.pairs, 'pairs of them'],
    [c.landmarks, 'landmarks'], [c.views, 'views of these'],
    [c.passes, c.passes === 1 ? 'pass' : 'passes'],
  ]) {
    figures.append(figureTile(String(value), text));
  }
  page.append(figures);
  if (!c.accepted) {
    section('What to do next').append(table(['reason', 'advice'],
        ADVICE.map(([reason, text]) => [{class: 'name', text: reason}, text])));
  }
}

function parameters(data) {
  const rows = data.calibration.parameters;
  const element = section('Parameters', data.calibration.scale_from
      ? `The depth scale is estimated from ${data.calibration.scale_from}.`
      : 'The depth scale is unchanged: images do not contain it; give a known length, ' +
        'ground truth or motion guess.');
  const isFound = row => row.status === 'determined';
  element.append(table(
      ['parameter', {number: 'before'}, {number: 'found'}, {number: '±'}, 'unit',
       'status'],
      rows.map((row, k) => {
        const words = data.words.parameters[k];
        return [{class: 'name', text: row.what}, {number: words[0]},
                {number: isFound(row) ? words[1] : ''},
                {number: isFound(row) ? words[2] : ''}, row.unit, row.status];
      }), 'stack wide'));
  const found = rows.filter(isFound);
  if (found.length === 0) return;
  const changes = found.map(row => (row.found - row.before) / row.prior_sigma);
  plot('parameters', '', block(element, 'Changes',
      'In standard deviations of what was known before; a change of more than four is ' +
      'not plausible.'), [{
    type: 'scatter', mode: 'markers', x: changes, y: found.map((row, k) => k),
    error_x: {type: 'data', array: found.map(row => row.sigma / row.prior_sigma),
              color: COLOR.blue},
    marker: {color: COLOR.blue, size: 8}, hovertemplate: '%{x:.3~g}<extra></extra>',
  }], {
    height: 90 + 30 * found.length, hovermode: 'closest', showlegend: false,
    xaxis: axis('change', {zeroline: true, zerolinecolor: COLOR.grey}),
    yaxis: axis('', {range: [found.length - 0.5, -0.5],
                     tickvals: found.map((row, k) => k),
                     ticktext: found.map(row => row.what)}),
  }).style.height = '';
}

// The residuals in cells of the image, as arrows that are enlarged: medians, since
// wrong matches would turn means.
function cellResiduals(data, camera, zoom) {
  const kCells = 16, kFew = 3;
  const cell = data.width / kCells;
  const cells = new Map();
  for (const row of data.residuals) {
    const key = Math.floor(row[1] / cell) * kCells + Math.floor(row[0] / cell);
    if (!cells.has(key)) cells.set(key, []);
    cells.get(key).push([row[camera.at], row[camera.at + 1]]);
  }
  const lines = {x: [], y: []}, ends = {x: [], y: []};
  for (const [key, all] of cells) {
    if (all.length < kFew) continue;
    const du = median(all.map(r => r[0])), dv = median(all.map(r => r[1]));
    const u = (key % kCells + 0.5) * cell, v = (Math.floor(key / kCells) + 0.5) * cell;
    lines.x.push(u, u + zoom * du, null);
    lines.y.push(v, v + zoom * dv, null);
    ends.x.push(u);
    ends.y.push(v);
  }
  return [
    Object.assign(lines, {type: 'scatter', mode: 'lines', hoverinfo: 'skip',
                          line: {color: COLOR.vermillion, width: 1.5}}),
    Object.assign(ends, {type: 'scatter', mode: 'markers', hoverinfo: 'skip',
                         marker: {color: COLOR.grey, size: 4}}),
  ];
}

// The residuals of a camera in bins of equal size by key(row). A point is what
// value(residuals, motions) makes of a bin.
function binned(data, camera, key, value) {
  const kBins = 12, kFew = 20;
  // A landmark at infinity has no motion.
  const rows = data.residuals.filter(row => known(row[6]) && known(row[7]));
  rows.sort((a, b) => key(a) - key(b));
  const bins = Math.min(kBins, Math.floor(rows.length / kFew));
  const trace = {type: 'scatter', mode: 'lines+markers', name: camera.name, x: [], y: [],
                 line: {color: camera.color}, hovertemplate: '%{y:.3~g}'};
  for (let bin = 0; bin < bins; ++bin) {
    const own = rows.slice(Math.floor(bin * rows.length / bins),
        Math.floor((bin + 1) * rows.length / bins));
    trace.x.push(own.reduce((sum, row) => sum + key(row), 0) / own.length);
    trace.y.push(value(own.map(row => [row[camera.at], row[camera.at + 1]]),
        own.map(row => [row[6], row[7]])));
  }
  return trace;
}

// How much later (ms) than expected these pixels were exposed: seen is predicted +
// motion t, so the residual is -motion t; t by least squares.
function lateMs(residuals, motions) {
  let along = 0, square = 0;
  residuals.forEach(([du, dv], i) => {
    along -= du * motions[i][0] + dv * motions[i][1];
    square += motions[i][0] ** 2 + motions[i][1] ** 2;
  });
  return square > 0 ? 1e3 * along / square : null;
}

function heldOut(data) {
  const c = data.calibration;
  if (c.held_out_pairs === 0) return;
  const change = 100 * (c.cost_after / c.cost_before - 1);
  const element = section('Held-out pairs',
      `${c.held_out_pairs} pairs: the cost per view ${change > 0 ? 'rises' : 'falls'} by ` +
      `${digits(Math.abs(change), 2)} %, from ${digits(c.cost_before, 4)} to ` +
      `${digits(c.cost_after, 4)} (${digits(Math.abs(c.gain_sigmas), 2)} standard ` +
      'deviations of the difference).');
  for (const text of ['left', 'halves', 'unseen']) {
    const sentence = data.words[text];
    element.append(make('p', {}, sentence[0].toUpperCase() + sentence.slice(1) + '.'));
  }
  if (c.depth_noise) {
    element.append(make('p', {},
        `Depth scatters by ${digits(c.depth_noise.in_old_sigmas, 3)} times the sigma that ` +
        'was assumed' + (data.noise_is_plausible ? '.' : ': too large for noise of a ' +
        'sensor. Depth is displaced, so do not use depth_noise.yaml.')));
  }
  if (data.residuals.length === 0) return;
  const spread = Math.max(0.5 * c.pixel_spread_before, 1e-3);
  const zoom = Math.min(Math.max(Math.round(10 / spread), 1), 200);
  const arrows = block(element, 'Residuals over the image',
      `Medians, enlarged ${zoom} times. Arrows that depend on the place are an error of the lens.`);
  const pair = make('div', {class: 'pair'});
  arrows.append(pair);
  CAMERAS.forEach((camera, k) => {
    const half = make('div', {}, make('h3', {}, 'Residuals ' + camera.name));
    pair.append(half);
    plot('arrows-' + k, 'small', half, cellResiduals(data, camera, zoom), {
      showlegend: false, hovermode: false,
      xaxis: axis('column (px)', {range: [0, data.width]}),
      yaxis: axis('row (px)', {range: [data.height, 0], scaleanchor: 'x'}),
    });
  });
  const charts = [
    ['late', 'Exposed later than expected', 'row (px)', 'ms', row => row[1], lateMs,
     'A line that rises or falls is a wrong readout, one above or below 0 a wrong delay.'],
    ['speed', 'Residuals over speed', 'motion in the image (px/s)', 'median residual (px)',
     row => Math.hypot(row[6], row[7]),
     residuals => median(residuals.map(r => Math.hypot(...r))),
     'A line that rises is an error of time or blur; a level one is the noise of features.'],
  ];
  const two = make('div', {class: 'pair'});
  element.append(two);
  for (const [id, title, x, y, key, value, text] of charts) {
    const half = block(two, title, text);
    plot(id, 'small', half, CAMERAS.map(camera => binned(data, camera, key, value)),
        {xaxis: axis(x), yaxis: axis(y)});
  }
}

function calibrationPath(data) {
  if (data.path.x.length === 0) return;
  const element = section('Path from above', 'As tracked in the last pass.');
  const xRange = pathRange(data.path.x, false), yRange = pathRange(data.path.z, false);
  plot('path', '', element, [{
    type: 'scatter', mode: 'lines', x: data.path.x, y: data.path.z,
    line: {color: COLOR.blue, width: 2}, hoverinfo: 'skip',
  }], {
    height: heightFor(element, xRange, yRange), showlegend: false, hovermode: false,
    xaxis: axis('X (m)', {range: xRange}),
    yaxis: axis('Z (m)', {scaleanchor: 'x', range: yRange}),
  }).style.height = '';
}

function showCalibration(data) {
  calibrationHeader(data);
  parameters(data);
  heldOut(data);
  calibrationPath(data);
}
