'use strict';

// The page of a sweep: all M-estimators on matches with a share of wrong ones.

const SWEEP_METHODS = [
  {schedule: 'gnc', ransac: false, name: 'graduated (gnc), from identity'},
  {schedule: 'gnc', ransac: true, name: 'graduated (gnc), from RANSAC'},
  {schedule: 'direct', ransac: false,
   name: 'final width from the start (direct), from identity'},
  {schedule: 'direct', ransac: true,
   name: 'final width from the start (direct), from RANSAC'},
];

const SWEEP_ERRORS = [
  {key: 'translation_mm', id: 'sweep-translation', unit: 'mm', title: 'Translation',
   y: 'translation error (mm)'},
  {key: 'rotation_deg', id: 'sweep-rotation', unit: '°', title: 'Rotation',
   y: 'rotation error (°)'},
];

const SWEEP_DEFINITIONS = [
  ['error', 'Of the estimated motion compared with the true one; the median of all ' +
      'trials at a share of wrong matches.'],
  ['band', '95 % confidence interval of the median from order statistics; it makes no ' +
      'assumption about the distribution of errors.'],
  ['wrong matches', 'Random points; wrong matches that agree with each other are not ' +
      'tested.'],
  ['graduated (gnc)', 'The loss is wide at first and narrowed step by step.'],
  ['from', 'Initial guess of the solver: the result of RANSAC or the identity (no motion).'],
];

function sweepHeader(data) {
  document.title = 'Wrong matches: rgbd_pose comparison';
  const losses = distinct(data.methods.map(method => method.loss));
  const page = document.getElementById('page');
  const percent = data.wrong_percent;
  page.append(make('h1', {}, 'M-estimators on wrong matches'), make('p', {class: 'soft'},
      `${losses.length} loss${losses.length === 1 ? '' : 'es'} on the same simulated ` +
      `matches with Kinect noise, of which ${percent[0]} to ` +
      `${percent[percent.length - 1]} % are wrong; ${setting(data, 'seeds')} random ` +
      `motions at each share; cost ${setting(data, 'cost')}.`));
  section('Verdict').append(...data.verdict.split(/(?<=\.) (?=Under)/).map(
      text => make('p', {}, text)));
}

// Curves of one kind of error for one method, each loss with its band.
function sweepTraces(data, chosen, error) {
  const methods = data.methods.filter(
      m => m.schedule === chosen.schedule && m.ransac === chosen.ransac);
  const bands = [], lines = [];
  methods.forEach((method, k) => {
    const {color, dash, symbol} = lineStyle(k);
    const band = method[error.key];
    const x = data.wrong_percent;
    bands.push({
      type: 'scatter', mode: 'lines', fill: 'toself', hoverinfo: 'skip',
      x: x.concat(x.slice().reverse()), y: band.high.concat(band.low.slice().reverse()),
      line: {width: 0, color}, opacity: 0.15, fillcolor: color, showlegend: false,
      legendgroup: method.loss, name: method.loss,
    });
    lines.push({
      type: 'scatter', mode: 'lines+markers', name: method.loss, x, y: band.median,
      legendgroup: method.loss, line: {color, dash, width: 2},
      marker: {color, symbol, size: 7},
      customdata: x.map((v, i) => `${digits(band.median[i], 3)} ${error.unit} ` +
          `[${digits(band.low[i], 3)}, ${digits(band.high[i], 3)}]`),
      hovertemplate: '%{customdata}',
    });
  });
  return bands.concat(lines);
}

function sweepLayout(data, error) {
  // The same axes for all methods, to make them comparable.
  const values = [].concat(...data.methods.map(
      m => m[error.key].low.concat(m[error.key].high)));
  const end = data.wrong_percent[data.wrong_percent.length - 1];
  return {
    uirevision: 'kept',  // keeps hidden curves hidden
    xaxis: axis('wrong matches (%)', {range: [-0.03 * end, 1.03 * end]}),
    yaxis: axis(error.y, logAxis(values)),
  };
}

function sweepTable(data, chosen) {
  const methods = data.methods.filter(
      m => m.schedule === chosen.schedule && m.ransac === chosen.ransac);
  return table(
      ['loss', ...data.wrong_percent.map(share => ({number: share + ' %'}))],
      methods.map(({loss, translation_mm: band}) => [
        {class: 'name', text: loss},
        ...data.wrong_percent.map((share, i) => ({
          number: `${digits(band.median[i], 3)} [${digits(band.low[i], 3)}, ` +
              `${digits(band.high[i], 3)}]`})),
      ]), 'stack wide bands');
}

function showSweep(data) {
  sweepHeader(data);
  const element = section('Errors over the share of wrong matches',
      'Medians with their 95 % bands, logarithmic, for the schedule and the initial' +
      ' guess selected here.' + LEGEND_HINT);
  const select = make('select', {id: 'method', 'aria-label': 'schedule and initial guess'},
      ...SWEEP_METHODS.map((method, i) => make('option', {value: i}, method.name)));
  element.append(select);
  element.classList.add('long');
  const divs = SWEEP_ERRORS.map(error => plot(
      error.id, 'tall', block(element, error.title),
      sweepTraces(data, SWEEP_METHODS[0], error), sweepLayout(data, error)));
  const place = make('div', {}, sweepTable(data, SWEEP_METHODS[0]));
  block(element, 'Median translation errors (mm) and their 95 % bands').append(place);
  select.addEventListener('change', () => {
    const chosen = SWEEP_METHODS[select.value];
    SWEEP_ERRORS.forEach((error, i) => Plotly.react(divs[i],
        sweepTraces(data, chosen, error), divs[i].layout, CONFIG));
    place.replaceChildren(sweepTable(data, chosen));
  });
  definitions(SWEEP_DEFINITIONS);
  settings(data, 'rgbd_compare');
}
