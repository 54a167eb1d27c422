'use strict';

// The page of a comparison: one sequence under several M-estimators.

const COMPARED_ERRORS = [
  {key: 'distance_m', y: 'distance', unit: 'mm', factor: 1000},
  {key: 'angle_deg', y: 'angle', unit: '°', factor: 1},
  {key: 'rpe_seconds_m', y: 'translation', unit: 'mm', factor: 1000},
  {key: 'rpe_seconds_deg', y: 'rotation', unit: '°', factor: 1},
];

const COMPARED_FIGURES = [
  {key: 'ate_mm', name: 'ATE', unit: 'mm'},
  {key: 'rpe_seconds_mm', name: 'RPE over 1 s', unit: 'mm'},
  {key: 'rpe_seconds_deg', name: 'RPE over 1 s', unit: '°'},
  {key: 'end_mm', name: 'end', unit: 'mm'},
  {key: 'end_deg', name: 'end', unit: '°'},
];

const DEFINITIONS = [
  ['ATE', 'Distances of positions from the true ones after rigid alignment of the ' +
      'whole path, without scale, RMSE.'],
  ['RPE over 1 s', 'Translation and rotation errors of all motions over 1 s, RMSE.'],
  ['end', 'Error of the last pose relative to the first.'],
  ['distance, angle', 'From the true pose of the same time, with the first poses ' +
      'aligned.'],
  ['tracked', 'Share of frames with a pose.'],
];

const LEGEND_HINT = ' A click on a name hides its line, a double click all others.';

function comparisonHeader(data) {
  const experiment = setting(data, 'experiment');
  const name = ['xyz', 'pan_tilt'].includes(experiment)
      ? `simulated ${experiment}` : baseName(experiment);
  document.title = name + ': rgbd_pose comparison';
  const losses = data.sequences.length ? data.sequences[0].losses.length : 0;
  document.getElementById('page').append(
      make('h1', {}, 'M-estimators on ' + name),
      make('p', {class: 'soft'},
          `${losses} loss${losses === 1 ? '' : 'es'} on the same frames; tracker ` +
          `${setting(data, 'tracker')}, cost ${setting(data, 'cost')}, frontend ` +
          `${setting(data, 'frontend')}.`));
}

// The losses with the smallest and the largest value of a figure.
function extremes(sequence, key) {
  const losses = sequence.losses.filter(loss => known(loss.figures[key]));
  losses.sort((a, b) => a.figures[key] - b.figures[key]);
  return losses.length ? [losses[0], losses[losses.length - 1]] : null;
}

function comparisonTiles(sequence) {
  const tiles = make('div', {class: 'figures'});
  const seconds = largest(sequence.t);
  tiles.append(figureTile(String(sequence.num_frames),
      `frame${sequence.num_frames === 1 ? '' : 's'} over ${digits(seconds, 3)} s`));
  const ate = extremes(sequence, 'ate_mm');
  if (ate) {
    tiles.append(figureTile(digits(ate[0].figures.ate_mm, 3) + ' mm',
        `smallest position error (ATE): loss ${ate[0].name}`));
    if (ate[1] !== ate[0]) {
      tiles.append(figureTile(digits(ate[1].figures.ate_mm, 3) + ' mm',
          `largest position error (ATE): loss ${ate[1].name}`));
    }
  }
  const tracked = extremes(sequence, 'tracked_share');
  if (tracked) {
    const least = tracked[0].figures.tracked_share;
    tiles.append(figureTile(digits(100 * least, 3) + ' %',
        least === tracked[1].figures.tracked_share
            ? 'of frames tracked, with every loss'
            : `of frames tracked, the minimum: loss ${tracked[0].name}`));
  }
  return tiles;
}

function comparedPaths(sequence, prefix, parent) {
  const element = block(parent, 'Paths', (sequence.truth
      ? 'Positions of the camera in the world of the ground truth; the first pose ' +
        'of every path is aligned with the true one.'
      : 'Positions of the camera relative to the first pose: X right, Y down, Z ' +
        'forward. There is no ground truth.') +
      ' Equal scales on all axes.' + LEGEND_HINT);
  const paths = sequence.truth ? [sequence.truth, ...sequence.losses]
                               : sequence.losses;
  const positions = {};
  for (const name of ['x', 'y', 'z']) {
    positions[name] = [].concat(...paths.map(path => path[name]));
  }
  if (!positions.x.some(known)) {
    element.append(make('p', {}, 'There are no poses: with every loss, all frames are lost.'));
    return;
  }
  const tracesOf = (axes, type, line) => {
    const trace = (path, name, look) => {
      const points = path.x.filter(known).length;
      const result = {
        type, mode: points === 1 ? 'markers' : 'lines', name,
        line: Object.assign({}, line, look), marker: {color: look.color},
        connectgaps: false, customdata: sequence.t, legendgroup: name,
        hovertemplate: '%{customdata:.2f} s<extra>%{fullData.name}</extra>',
      };
      'xyz'.split('').slice(0, axes.length).forEach((letter, i) => {
        result[letter] = path[axes[i]];
      });
      return result;
    };
    const wide = {color: '#b6bec7', width: type === 'scatter3d' ? 8 : 6};
    return (sequence.truth ? [trace(sequence.truth, 'ground truth', wide)] : [])
        .concat(sequence.losses.map((loss, k) => {
          const {color, dash} = lineStyle(k);
          return trace(loss, loss.name, {color, dash});
        }));
  };
  pathViews(element, prefix, ['paths', 'large'], positions, sequence.down, tracesOf);
}

function comparedErrors(sequence, prefix, parent) {
  const shown = COMPARED_ERRORS.filter(
      error => sequence.losses.some(loss => loss[error.key].some(v => v > 0)));
  if (shown.length === 0) return;
  const element = block(parent, 'Errors over time',
      'Logarithmic. Distance and angle from the ground truth, with the first poses ' +
      'aligned' + (shown.some(error => error.key.startsWith('rpe'))
          ? '; translation and rotation: errors of the motion over the following ' +
            'second, unaffected by earlier drift.' : '.') +
      (sequence.every > 1 ? ` Every point is the largest of ${sequence.every} frames.`
                          : '') + LEGEND_HINT);
  const end = largest(sequence.t) || 1;
  const rows = shown.map(error => ({
    title: '', y: `${error.y} (${error.unit})`,
    axis: logAxis([].concat(...sequence.losses.map(
        loss => scaled(loss[error.key], error.factor)))),
  }));
  const traces = [];
  shown.forEach((error, row) => sequence.losses.forEach((loss, k) => {
    const {color, dash} = lineStyle(k);
    traces.push({
      type: 'scatter', mode: sequence.num_frames < 3 ? 'markers' : 'lines',
      name: loss.name, legendgroup: loss.name, showlegend: row === 0,
      x: sequence.t,
      y: loss[error.key].map(v => (v > 0 ? v * error.factor : null)),
      yaxis: 'y' + (row === 0 ? '' : row + 1), connectgaps: false,
      line: {color, dash, width: 1.5}, marker: {color},
      hovertemplate: `%{y:.3~g} ${error.unit}`,
    });
  }));
  const layout = rowsLayout(rows, TIME_AXIS, [-0.01 * end, 1.01 * end]);
  layout.showlegend = true;
  plot(prefix + 'errors', ['small', 'rows2', 'rows3', 'rows4'][rows.length - 1],
      element, traces, layout);
}

// Plots the figures of the table next to each other.
function comparedFigures(sequence, prefix, element) {
  const losses = sequence.losses;
  const shown = COMPARED_FIGURES.filter(
      figure => losses.some(loss => loss.figures[figure.key] > 0));
  for (const unit of ['mm', '°']) {
    const own = shown.filter(figure => figure.unit === unit);
    if (own.length === 0) continue;
    const traces = own.map((figure, k) => ({
      type: 'scatter', mode: 'markers', name: figure.name,
      x: losses.map(loss => loss.figures[figure.key]),
      y: losses.map((loss, i) => i),
      marker: {size: 10, symbol: LINE_SYMBOLS[k], color: SEGMENT_COLORS[k]},
      customdata: losses.map(loss => loss.name),
      hovertemplate: `%{customdata}: %{x:.3~g} ${unit}` +
          '<extra>%{fullData.name}</extra>',
    }));
    plot(`${prefix}figures-${unit === 'mm' ? 'mm' : 'deg'}`, 'batch', element, traces, {
      height: 110 + 30 * losses.length,
      hovermode: 'closest', showlegend: true,
      xaxis: axis(unit === 'mm' ? 'error (mm)' : 'error (°)', logAxis(
          [].concat(...own.map(figure => losses.map(loss => loss.figures[figure.key]))))),
      yaxis: axis('', {range: [losses.length - 0.5, -0.5],
                       tickvals: losses.map((loss, i) => i),
                       ticktext: losses.map(loss => loss.name), gridcolor: '#d8dee4'}),
    }).style.height = '';
  }
}

function comparedTables(data, sequence, prefix, parent) {
  const number = (value, decimals) => (
      {number: known(value) ? value.toFixed(decimals) : 'n/a'});
  const returns = setting(data, 'experiment') === 'pan_tilt';
  if (returns || !sequence.truth) {
    block(parent, 'Last pose relative to the first', returns
        ? 'The path ends where it starts: all should be 0, as in the thesis\' Tables ' +
          '4.4-4.6.' : 'In the parameters of the thesis.').append(
        table(['loss', ...['alpha (°)', 'beta (°)', 'gamma (°)', 'Cx (mm)', 'Cy (mm)',
                           'Cz (mm)', 'tracked (%)'].map(text => ({number: text}))],
            sequence.losses.map(({name, figures: f}) => [
              {class: 'name', text: name}, number(f.alpha_deg, 4), number(f.beta_deg, 4),
              number(f.gamma_deg, 4), number(f.cx_mm, 3), number(f.cy_mm, 3),
              number(f.cz_mm, 3), number(100 * f.tracked_share, 1)]), 'stack wide'));
  }
  if (!sequence.truth) return;
  const element = block(parent, 'Errors along the path',
      'As in the thesis\' Tables 4.7 and 4.8. Logarithmic; lower is better.');
  comparedFigures(sequence, prefix, element);
  element.append(table(
      ['loss', {number: 'ATE (mm)'}, {number: 'RPE over 1 s (mm)'}, {number: 'RPE over 1 s (°)'},
       {number: 'end (mm)'}, {number: 'end (°)'}, {number: 'tracked (%)'}],
      sequence.losses.map(({name, figures: f}) => [
        {class: 'name', text: name}, number(f.ate_mm, 3), number(f.rpe_seconds_mm, 3),
        number(f.rpe_seconds_deg, 4), number(f.end_mm, 3), number(f.end_deg, 4),
        number(100 * f.tracked_share, 1)]), 'stack wide'));
}

function definitions(rows) {
  section('What the numbers mean').append(table(['', 'what it is'],
      rows.map(([name, text]) => [{class: 'name', text: name}, text])));
}

function showComparison(data) {
  comparisonHeader(data);
  data.sequences.forEach((sequence, i) => {
    const prefix = `s${i}-`;
    const element = section(sequence.name);
    element.classList.add('long');
    element.append(comparisonTiles(sequence));
    comparedPaths(sequence, prefix, element);
    comparedTables(data, sequence, prefix, element);
    comparedErrors(sequence, prefix, element);
  });
  definitions(DEFINITIONS);
  settings(data, 'rgbd_compare');
}
