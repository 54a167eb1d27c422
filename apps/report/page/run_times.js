'use strict';

// Quantities over time: errors, tracking, computing time.

const STATUS = [
  {name: 'ok', color: COLOR.green},
  {name: 'degraded', color: COLOR.orange},
  {name: 'lost', color: COLOR.vermillion},
];

const STAGES = [
  {key: 'match_ms', name: 'matching', color: COLOR.blue},
  {key: 'solve_ms', name: 'pose solve', color: COLOR.orange},
  {key: 'reference_ms', name: 'new reference', color: COLOR.green},
  {key: 'relocalise_ms', name: 'relocalisation', color: COLOR.purple},
  {key: 'other_ms', name: 'other tracking', color: COLOR.grey},
];

const TIME_AXIS = 'time since the first frame (s)';

const PER_POINT = data => (data.every > 1
    ? ` Every point stands for ${data.every} frames: times and errors are their` +
      ' maximum.' : '');

// Grey bands where frames have no pose.
function lostBands(data) {
  return data.incidents.filter(i => i.status === 'lost').map(i => ({
    type: 'rect', xref: 'x', yref: 'paper', y0: 0, y1: 1, x0: i.from_s,
    x1: Math.max(i.to_s, i.from_s + 1e-3), fillcolor: '#d0d7de', opacity: 0.6,
    line: {width: 0}, layer: 'below',
  }));
}

function lineTrace(data, y, number, name, color, format, more) {
  return Object.assign({
    type: 'scatter', mode: data.frames.t.length === 1 ? 'markers' : 'lines',
    x: data.frames.t, y, name, connectgaps: false, line: {color, width: 1.5},
    marker: {color}, yaxis: 'y' + number,
    customdata: data.frames.t.map((t, i) => i * data.every),
    hovertemplate: `%{y:${format}} (frame no. %{customdata})`,
  }, more);
}

// Dotted lines at jumps of the path.
function jumpLines(data) {
  return (data.metrics.jumps || []).map(jump => ({
    type: 'line', xref: 'x', yref: 'paper', y0: 0, y1: 1, x0: jump.seconds,
    x1: jump.seconds, line: {color: COLOR.black, width: 1, dash: 'dot'},
    layer: 'below',
  }));
}

function errors(data) {
  if (!data.errors || data.num_frames < 2) return;
  const evaluation = data.metrics.evaluation;
  const lost = data.incidents.some(i => i.status === 'lost');
  const element = section('Error over time',
      'Top: distance of each position from the ground truth after alignment. ' +
      'Below: error of the motion over the following second, unaffected by earlier ' +
      'drift. Dashed: root mean square (RMSE).' + PER_POINT(data) +
      (lost ? ' Grey: lost, no pose.' : '') +
      ' Gaps: no ground truth within ' +
      `${evaluation.max_time_difference_s} s of that time or of a second later.` +
      ((data.metrics.jumps || []).length ? ' Dotted: a jump.' : ''));
  const rmse = (statistics, factor, unit) => (statistics
      ? `, RMSE ${digits(statistics.rmse * factor, 3)} ${unit}` : ': n/a');
  const position = lengthUnit(largest(data.errors.position_m));
  const rpe = lengthUnit(largest(data.errors.rpe_m));
  const relative = evaluation.rpe_seconds;
  const levels = [];
  if (evaluation.ate.position_m) {
    levels.push(level(evaluation.ate.position_m.rmse * position.factor, ''));
  }
  const rows = [
    {title: 'Position' + rmse(evaluation.ate.position_m, position.factor, position.name),
     y: position.name},
  ];
  const traces = [lineTrace(data, scaled(data.errors.position_m, position.factor), '',
      `position (${position.name})`, COLOR.blue, '.3~g')];
  if (relative.translation_m) {
    rows.push(
        {title: 'Translation over 1 s' + rmse(relative.translation_m, rpe.factor, rpe.name),
         y: rpe.name},
        {title: 'Rotation over 1 s' + rmse(relative.rotation_deg, 1, '°'), y: 'degrees'});
    traces.push(
        lineTrace(data, scaled(data.errors.rpe_m, rpe.factor), '2',
            `translation (${rpe.name})`, COLOR.vermillion, '.3~g'),
        lineTrace(data, data.errors.rpe_deg, '3', 'rotation (°)', COLOR.purple, '.3~g'));
    levels.push(level(relative.translation_m.rmse * rpe.factor, '2'),
        level(relative.rotation_deg.rmse, '3'));
  }
  plot('errors', rows.length > 1 ? 'rows3' : 'small', element, traces,
      Object.assign(rowsLayout(rows, TIME_AXIS, timeRange(data)),
          {shapes: lostBands(data).concat(levels, jumpLines(data))}));
}

function tracking(data) {
  const frames = data.frames;
  const element = section('Tracking',
      'Status of every frame; number of matches with the reference frame, and of ' +
      'inliers, which agree with the estimated motion; sigma, the spread of whitened ' +
      'residuals: 1 means that the noise model fits. Frames tracked by pixels alone ' +
      'are shown separately: they count pixels, not features. The first frame has no ' +
      'reference frame.' + PER_POINT(data));
  const rows = [
    {title: 'Status and new references', y: '', weight: 0.8,
     axis: {range: [-1.6, 2.6], tickvals: [2, 1, 0, -1], showgrid: false,
            ticktext: [...STATUS.map(s => s.name), 'reference']}},
    {title: key(COLOR.sky) + 'features matched   ' + key(COLOR.blue) +
         'inliers', y: 'features'},
    {title: 'Sigma of the residuals (dashed: 1)', y: 'sigma', weight: 0.8},
  ];
  const traces = STATUS.map((status, code) => ({
    type: 'scatter', mode: 'markers', name: status.name,
    x: frames.t.filter((t, i) => frames.status[i] === code),
    y: frames.t.filter((t, i) => frames.status[i] === code).map(() => 2 - code),
    marker: {color: status.color, symbol: 'square', size: 7}, hoverinfo: 'skip',
  }));
  const references = frames.t.filter((t, i) => frames.is_reference[i]);
  traces.push({
    type: 'scatter', mode: 'markers', name: 'new reference', x: references,
    y: references.map(() => -1), hoverinfo: 'skip',
    marker: {symbol: 'line-ns-open', size: 9, color: COLOR.black},
  });
  const byFeatures = values => values.map((v, i) => (frames.by_pixels[i] === 0 &&
      (frames.matches[i] > 0 || frames.status[i] > 0) ? v : null));
  const byPixels = values => values.map((v, i) => (frames.by_pixels[i] ? v : null));
  const pixelRow = frames.by_pixels.some(v => v);
  const last = pixelRow ? '4' : '3';
  traces.push(
      lineTrace(data, byFeatures(frames.matches), '2', 'features matched', COLOR.sky, 'd'),
      lineTrace(data, byFeatures(frames.inliers), '2', 'inliers', COLOR.blue, 'd'));
  if (pixelRow) {
    rows.splice(2, 0, {title: key(COLOR.orange) + 'pixels compared   ' +
        key(COLOR.vermillion) + 'inliers', y: 'pixels', weight: 0.8});
    for (const [values, name, color] of [
      [frames.matches, 'pixels compared', COLOR.orange],
      [frames.inliers, 'inliers', COLOR.vermillion],
    ]) {
      traces.push(lineTrace(data, byPixels(values), '3', name, color, 'd',
          {mode: 'markers', marker: {color, size: 4}}));
    }
  }
  traces.push(lineTrace(data, frames.sigma.map(s => (s > 0 ? s : null)), last, 'sigma',
      COLOR.purple, '.2f'));
  const layout = rowsLayout(rows, TIME_AXIS, timeRange(data));
  layout.shapes = lostBands(data).concat(level(1, last), jumpLines(data));
  plot('tracking', pixelRow ? 'rows4' : 'rows3', element, traces, layout);
  jumpTable(data, element);
  incidents(data, element);
}

// Explains jumps and how to inspect them.
function jumpTable(data, element) {
  const jumps = data.metrics.jumps || [];
  if (jumps.length === 0) return;
  element.append(make('h3', {}, 'Jumps'), make('p', {class: 'soft'},
      'Frames whose motion differs from the mean of the previous and the next motion ' +
      'by more than 10 mm and six times the median difference, largest first. With few ' +
      'matches or a large sigma, a jump is an error; if the camera was pushed, it is ' +
      `not. To see the matches of the largest jumps, ${startFolder(data)}:`),
      make('pre', {}, repeated(data, data.metrics.program) + ' ' +
          `--debug_images=${jumps.slice(0, 3).map(jump => jump.frame).join(',')}`),
      table([{number: 'frame no.'}, {number: 'time (s)'}, {number: 'difference (mm)'},
             'tracked by', {number: 'inliers'}, {number: 'sigma'}, 'status'],
          jumps.map(jump => [
            {number: String(jump.frame)}, {number: jump.seconds.toFixed(2)},
            {number: digits(1000 * jump.translation_m, 2)},
            {direct: 'pixels alone', 'features+direct': 'features and pixels'}[
                jump.tracking_source] || jump.tracking_source,
            {number: `${jump.inliers} of ${jump.matches}`},
            {number: digits(jump.sigma, 2)}, jump.status])));
}

function incidents(data, element) {
  if (data.incidents.length === 0) {
    element.append(make('p', {}, 'Every frame is ok.'));
    return;
  }
  const shown = data.incidents.slice(0, 20);
  element.append(make('h3', {}, 'Frames that are not ok'));
  element.append(table(
      [{number: 'from (s)'}, {number: 'to (s)'}, {number: 'frame no.'}, 'status', 'reason'],
      shown.map(i => [
        {number: i.from_s.toFixed(2)}, {number: i.to_s.toFixed(2)},
        {number: i.first === i.last ? String(i.first) : `${i.first}–${i.last}`},
        i.status, i.reason,
      ])));
  const rest = data.incidents.length - shown.length;
  if (rest > 0) {
    element.append(make('p', {class: 'soft'},
        `${rest} further interval${rest === 1 ? '' : 's'} in frames.csv.`));
  }
}

function times(data) {
  const frames = data.frames;
  const element = section('Time per frame',
      'Top: tracking time by stage, stacked; "pose solve" is all solves of a frame, ' +
      'from features and from pixels, with weights and covariance. Bottom: decoding ' +
      'of the images, which may run in other threads at the same time.' +
      PER_POINT(data));
  const other = frames.track_ms.map((all, i) => Math.max(0, all - STAGES.slice(0, 4)
      .reduce((sum, stage) => sum + (frames[stage.key][i] || 0), 0)));
  const traces = [];
  for (const stage of STAGES) {
    const y = stage.key === 'other_ms' ? other : frames[stage.key];
    if (largest(y) < 1e-3) continue;
    traces.push(lineTrace(data, y, '', stage.name, stage.color, '.2f', {
      stackgroup: 'one', line: {width: 0, color: stage.color, shape: 'hvh'},
      fillcolor: stage.color,
    }));
  }
  traces.push(lineTrace(data, frames.decode_ms, '2', 'decoding', COLOR.black, '.2f',
      {showlegend: false, line: {width: 1, color: COLOR.black}}));
  const layout = rowsLayout([
    {title: '', y: 'tracking (ms)', weight: 1.6},
    {title: '', y: 'decoding (ms)'},
  ], TIME_AXIS, timeRange(data));
  layout.showlegend = true;
  layout.legend = Object.assign({}, BASE_LAYOUT.legend, {traceorder: 'normal'});
  plot('times', 'rows2', element, traces, layout);
}
