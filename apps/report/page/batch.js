'use strict';

// The page of a batch: many sequences with many settings.

const SETTING_SYMBOLS = ['circle', 'square', 'diamond', 'triangle-up', 'x', 'star'];

const BATCH_SETTINGS = ['tracker', 'cost', 'loss', 'frontend'];

const BATCH_FIGURES = [
  {key: 'ate_rmse_m', id: 'batch-ate', title: 'Position error (ATE, RMSE)',
   label: 'ATE', unit: 'mm', factor: 1000,
   text: 'Distance of positions from the ground truth after rigid alignment of the ' +
         'whole path, without scale.'},
  {key: 'rpe_seconds_translation_m', id: 'batch-rpe',
   title: 'Translation error over 1 s (RPE, RMSE)', label: 'RPE', unit: 'mm', factor: 1000,
   text: 'Translation error of all motions over 1 s.'},
  {key: 'rpe_seconds_rotation_deg', id: 'batch-turn',
   title: 'Rotation error over 1 s (RPE, RMSE)', label: 'RPE', unit: '°', factor: 1,
   text: 'Rotation error of the same motions.'},
  {key: 'track_ms_median', id: 'batch-time', title: 'Time per frame', label: 'time',
   unit: 'ms', factor: 1,
   text: 'Median tracking time, without decoding.'},
];

function distinct(values) {
  return [...new Set(values)];
}

// The name of a run: all settings that vary within the batch.
function settingName(row, varied) {
  return varied.map(name => row[name]).join(', ') || 'all runs';
}

function batchHeader(data, varied) {
  const rows = data.rows;
  document.title = data.name + ': rgbd_pose batch';
  const fixed = BATCH_SETTINGS.filter(name => !varied.includes(name));
  const page = document.getElementById('page');
  page.append(make('h1', {}, 'Batch: ' + data.name));
  if (rows.length > 0 && fixed.length > 0) {
    page.append(make('p', {class: 'soft'}, 'The same in all runs: ' +
        fixed.map(name => `${name} ${rows[0][name]}`).join(', ') + '.'));
  }
  const figures = make('div', {class: 'figures'});
  const ok = rows.filter(row => row.status === 'ok').length;
  const count = name => distinct(rows.map(row => row[name])).length;
  for (const [value, text] of [
    [rows.length, 'runs'], [ok, 'of them ok'],
    [count('sequence'), 'sequences'],
    [distinct(rows.map(row => settingName(row, varied))).length, 'settings'],
    [count('part'), 'parts of each'], [count('repeat'), 'repeats'],
  ]) {
    figures.append(figureTile(String(value), text));
  }
  page.append(figures);
}

// One row per sequence, with the settings next to each other.
function batchPlot(data, figure, sequences, settings, varied) {
  const rows = data.rows.filter(row => known(row[figure.key]));
  if (rows.length === 0) return;
  sequences = sequences.filter(name => rows.some(row => row.sequence === name));
  const element = section(figure.title, figure.text + ' Logarithmic; lower is better.');
  const traces = settings.map((setting, k) => {
    const own = rows.filter(row => settingName(row, varied) === setting);
    // Offset within the row, which has a height of 1.
    const shift = settings.length > 1 ? 0.6 * (k / (settings.length - 1) - 0.5) : 0;
    return {
      type: 'scatter', mode: 'markers', name: setting,
      x: own.map(row => figure.factor * row[figure.key]),
      y: own.map(row => sequences.indexOf(row.sequence) + shift),
      customdata: own.map(row => `${row.sequence} ${row.part}, run ${row.repeat}`),
      hovertemplate: `%{customdata}: %{x:.3~g} ${figure.unit}` +
          '<extra>%{fullData.name}</extra>',
      marker: {size: 9, color: SEGMENT_COLORS[k % SEGMENT_COLORS.length],
               symbol: SETTING_SYMBOLS[
                   Math.floor(k / SEGMENT_COLORS.length) % SETTING_SYMBOLS.length]},
    };
  });
  const div = plot(figure.id, 'batch', element, traces, {
    height: 110 + sequences.length * Math.max(34, 12 * settings.length),
    showlegend: settings.length > 1,
    hovermode: 'closest',
    xaxis: axis(`${figure.label} (${figure.unit})`,
        logAxis(rows.map(row => figure.factor * row[figure.key]))),
    yaxis: axis('', {
      range: [sequences.length - 0.5, -0.5], tickvals: sequences.map((s, i) => i),
      ticktext: sequences.map(shorten), gridcolor: '#d8dee4'}),
  });
  div.style.height = '';
}

// Long names would leave no room for the plot on a phone. They are cut at the
// start, because they differ at their ends.
function shorten(name) {
  const kLongest = window.innerWidth < 600 ? 14 : 40;
  return name.length > kLongest ? '…' + name.slice(1 - kLongest) : name;
}

function batchTable(data, varied) {
  const number = (value, factor, count = 3) => (
      {number: known(value) ? digits(value * factor, count) : '–'});
  section('All runs', data.rows.some(row => row.report)
      ? 'A name leads to the report of its run.' : '').append(table(
      ['sequence', ...varied, 'part', {number: 'run'}, 'status',
       {number: 'tracked (%)'}, {number: 'ATE (mm)'}, {number: 'RPE over 1 s (mm)'},
       {number: 'RPE over 1 s (°)'}, {number: 'ms/frame'}],
      data.rows.map(row => [
        {class: 'name', text: row.sequence, link: row.report}, ...varied.map(name => row[name]),
        row.part || 'all', {number: String(row.repeat)}, row.status, number(row.tracked_share, 100),
        number(row.ate_rmse_m, 1000), number(row.rpe_seconds_translation_m, 1000),
        number(row.rpe_seconds_rotation_deg, 1), number(row.track_ms_median, 1),
      ]), 'stack wide'));
}

// Statistics over parts, because the error of a single part may be chance.
function partsTable(data, sequences, settings, varied) {
  if (distinct(data.rows.map(row => row.part)).length < 2) return;
  const range = (rows, key, factor) => {
    const values = rows.map(row => row[key]).filter(known).sort((a, b) => a - b)
        .map(v => v * factor);
    if (values.length === 0) return {number: '–'};
    const middle = (values.length - 1) / 2;
    const median = (values[Math.floor(middle)] + values[Math.ceil(middle)]) / 2;
    return {number: `${digits(median, 3)} (${digits(values[0], 3)} to ` +
        `${digits(values[values.length - 1], 3)})`};
  };
  const rows = [];
  for (const sequence of sequences) {
    for (const setting of settings) {
      const own = data.rows.filter(row => row.sequence === sequence &&
          settingName(row, varied) === setting);
      rows.push([{class: 'name', text: sequence}, setting,
                 {number: String(own.length)}, range(own, 'tracked_share', 100),
                 range(own, 'ate_rmse_m', 1000),
                 range(own, 'rpe_seconds_translation_m', 1000),
                 range(own, 'rpe_seconds_rotation_deg', 1)]);
    }
  }
  section('Settings over parts', 'Median (minimum to maximum) over the parts of a ' +
      'sequence. Settings whose ranges overlap cannot be ranked.').append(table(
      ['sequence', 'setting', {number: 'runs'}, {number: 'tracked (%)'},
       {number: 'ATE (mm)'}, {number: 'RPE over 1 s (mm)'},
       {number: 'RPE over 1 s (°)'}], rows, 'stack wide'));
}

function showBatch(data) {
  const varied = BATCH_SETTINGS.filter(
      name => distinct(data.rows.map(row => row[name])).length > 1);
  const sequences = distinct(data.rows.map(row => row.sequence));
  const settings = distinct(data.rows.map(row => settingName(row, varied)));
  batchHeader(data, varied);
  partsTable(data, sequences, settings, varied);
  for (const figure of BATCH_FIGURES) {
    batchPlot(data, figure, sequences, settings, varied);
  }
  batchTable(data, varied);
}
