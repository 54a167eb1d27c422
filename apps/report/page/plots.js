'use strict';

// Shared by the pages: elements, formatted numbers and a plain plot style.

// Okabe and Ito: also distinguishable for colour-blind people.
const COLOR = {
  black: '#000000', orange: '#E69F00', sky: '#56B4E9', green: '#009E73',
  yellow: '#F0E442', blue: '#0072B2', vermillion: '#D55E00', purple: '#CC79A7',
  grey: '#8c959f',
};
// Colours of the segments of a path, in order. Black is used for the truth.
const SEGMENT_COLORS = [
  COLOR.blue, COLOR.vermillion, COLOR.green, COLOR.purple, COLOR.orange,
  COLOR.sky,
];

// The style of the k-th of several lines. The first twelve are all different.
const LINE_DASHES = ['solid', 'dash', 'dot', 'dashdot'];
const LINE_SYMBOLS = ['circle', 'square', 'diamond', 'triangle-up', 'triangle-down'];

function lineStyle(k) {
  return {color: SEGMENT_COLORS[k % SEGMENT_COLORS.length],
          dash: LINE_DASHES[k % LINE_DASHES.length],
          symbol: LINE_SYMBOLS[k % LINE_SYMBOLS.length]};
}

// Creates an element: make('td', {class: 'number'}, 'text' or child, ...).
function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

function known(value) {
  return value !== null && value !== undefined && Number.isFinite(value);
}

// A number with `count` significant digits, without an exponent.
function digits(value, count) {
  if (!known(value)) return 'n/a';
  if (value === 0) return '0';
  const decimals = count - 1 - Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.min(Math.max(decimals, 0), 12));
}

function largest(values) {
  return values.reduce((most, v) => (known(v) && v > most ? v : most), 0);
}

// The unit for lengths up to `most` metres.
function lengthUnit(most) {
  return most < 1 ? {name: 'mm', factor: 1000} : {name: 'm', factor: 1};
}

function scaled(values, factor) {
  return values.map(v => (known(v) ? v * factor : null));
}

function axis(title, more) {
  return Object.assign({
    title: {text: title, standoff: 6},
    automargin: true,
    zeroline: false,
    gridcolor: '#e7ebef',
    linecolor: '#8c959f',
    linewidth: 1,
    ticks: 'outside',
    tickcolor: '#8c959f',
    ticklen: 4,
    nticks: 8,
  }, more);
}

// A logarithmic axis for all values above 0, with ticks at powers of ten and,
// if there are few, also between them. It spans at least a factor of 4, so
// small differences look small.
function logAxis(values) {
  const above = values.filter(v => known(v) && v > 0).map(Math.log10);
  const least = above.reduce((a, b) => Math.min(a, b), Infinity);
  const most = above.reduce((a, b) => Math.max(a, b), -Infinity);
  if (above.length === 0) return {type: 'log'};
  const room = Math.max(0.05 * (most - least), 0.3 - (most - least) / 2, 0.02);
  const low = least - room, high = most + room;
  const wanted = high - low > 2.5 ? [1] : high - low > 1 ? [1, 2, 5]
      : [1, 1.5, 2, 3, 4, 5, 7];
  const tickvals = [];
  for (let power = Math.floor(low); power <= high; ++power) {
    for (const digit of wanted) {
      tickvals.push(Number(`${digit}e${power}`));
    }
  }
  return {type: 'log', range: [low, high], rangemode: 'normal', tickvals,
          ticktext: tickvals.map(String)};
}

// A tile in the head of a page: a value and its description.
function figureTile(value, text) {
  return make('div', {class: 'figure'}, make('b', {}, value), make('span', {}, text));
}

const BASE_LAYOUT = {
  font: {family: 'system-ui, -apple-system, "Segoe UI", Roboto, Arial, sans-serif',
         size: 12, color: '#1b1f24'},
  paper_bgcolor: '#fff',
  plot_bgcolor: '#fff',
  margin: {l: 10, r: 14, t: 10, b: 10},
  legend: {orientation: 'h', x: 0, xanchor: 'left', y: 1.02, yanchor: 'bottom',
           bgcolor: 'rgba(0,0,0,0)', itemsizing: 'constant', itemwidth: 40},
  hovermode: 'x unified',
  hoverlabel: {font: {size: 12}},
  dragmode: false,
};

// The button bar would cover titles and legends. It is not needed: dragging
// zooms and a double click resets.
const CONFIG = {displayModeBar: false, responsive: true};

// Dragging zooms with a mouse, but must scroll the page on a touch screen.
function dragMode() {
  return window.matchMedia('(pointer: coarse)').matches ? false : 'zoom';
}

function plot(id, size, parent, traces, layout) {
  const div = make('div', {id: id, class: 'plot ' + size});
  parent.append(div);
  Plotly.newPlot(
      div, traces,
      Object.assign({}, BASE_LAYOUT, {dragmode: dragMode()}, layout), CONFIG);
  return div;
}

// Layout of rows with a common time axis, from top to bottom. Each row is
// {title, y, weight}, where y is the title of its y axis.
function rowsLayout(rows, xTitle, xRange) {
  const gap = rows.some(row => row.title) ? 0.11 : 0.05;
  const total = rows.reduce((sum, row) => sum + (row.weight || 1), 0);
  const height = (1 - gap * (rows.length - 1)) / total;
  const layout = {annotations: [], showlegend: false};
  let top = 1;
  rows.forEach((row, i) => {
    const number = i === 0 ? '' : String(i + 1);
    const bottom = Math.max(0, top - height * (row.weight || 1));
    layout['yaxis' + number] = axis(row.y, Object.assign(
        // No automatic margins: the time axes of all plots must be aligned.
        {domain: [bottom, top], nticks: 5, rangemode: 'tozero', automargin: false},
        row.axis));
    layout.annotations.push({
      text: row.title, showarrow: false, xref: 'paper', yref: 'paper', x: 0,
      xanchor: 'left', y: top, yanchor: 'bottom', yshift: 3, align: 'left',
      font: {size: 12.5},
    });
    top = bottom - gap;
  });
  const last = rows.length === 1 ? '' : String(rows.length);
  layout.xaxis = axis(xTitle, {anchor: 'y' + last, range: xRange});
  layout.margin = {l: 74, r: 14, t: 26, b: 10};
  return layout;
}

// The same time range in all plots, with room for markers at both ends.
function timeRange(data) {
  const end = largest(data.frames.t) || 1;
  return [-0.01 * end, 1.01 * end];
}

// A dashed horizontal line in row `number` ('' is the first).
function level(value, number) {
  return {type: 'line', xref: 'paper', x0: 0, x1: 1, yref: 'y' + number, y0: value,
          y1: value, line: {color: COLOR.grey, width: 1, dash: 'dash'}};
}

// A coloured square for a title that replaces a legend.
function key(color) {
  return `<span style="color:${color}">\u25A0</span> `;
}

// The filled outline of a histogram with bars of equal width from `from` on.
function bars(counts, from, width) {
  const x = [from], y = [0];
  counts.forEach((count, i) => {
    x.push(from + i * width, from + (i + 1) * width);
    y.push(count, count);
  });
  x.push(from + counts.length * width);
  y.push(0);
  return {x, y};
}

// A link to a file beside the page, whose name may have any signs, such as # and
// :, which have a meaning in links.
function linkTo(path) {
  return path.split('/').map(encodeURIComponent).join('/');
}

function table(head, rows, className) {
  const cell = (tag, content, label) => {
    const number = typeof content === 'object' && content.number !== undefined;
    const attributes = {};
    if (number) attributes.class = 'number';
    else if (typeof content === 'object') attributes.class = content.class;
    if (label) attributes['data-label'] = label;
    const text = number ? content.number
        : typeof content === 'object' ? content.text : content;
    const isLink = typeof content === 'object' && content.link;
    return make(tag, attributes,
        isLink ? make('a', {href: linkTo(content.link)}, text) : text);
  };
  return make('div', {class: 'scroll'}, make('table', {class: className || ''},
      make('thead', {}, make('tr', {}, ...head.map(h => cell('th', h)))),
      make('tbody', {}, ...rows.map(row => make('tr', {}, ...row.map(
          (c, i) => cell('td', c,
              typeof c === 'object' && c.number !== undefined ? head[i].number : '',
          )))))));
}

// The value of a flag; `data.settings` has the flags in groups.
function setting(data, name) {
  for (const [, flags] of data.settings) {
    for (const [key, value] of flags) if (key === name) return value;
  }
  return '';
}

// The folder in which a run can be repeated: its paths are relative to it.
function startFolder(data) {
  return setting(data, 'output') === '.' ? 'in the folder of this page' :
      'in the folder in which it was started';
}

// A command that repeats the run there.
function repeated(data, program) {
  const flags = setting(data, 'output') + '/config.flags';
  const isPlain = /^[\w@%+=:,./-]+$/.test(flags);
  const quoted = isPlain ? flags : "'" + flags.replaceAll("'", "'\\''") + "'";
  return program + ' --flagfile=' + quoted;
}

function settings(data, program) {
  const element = section(
      'Settings', `All flags of the run. To repeat it, ${startFolder(data)}:`);
  element.append(make('pre', {}, repeated(data, program)));
  const columns = make('div', {class: 'columns'});
  for (const [title, flags] of data.settings) {
    columns.append(make('div', {}, make('h3', {}, title), table(
        ['flag', 'value'],
        flags.map(([name, value]) => [
          {class: 'code', text: '--' + name},
          value === '' ? {class: 'soft', text: '(empty)'} : {class: 'code', text: value},
        ]))));
  }
  element.append(columns);
}

// A part of a long section. Printing does not break it across pages.
function block(parent, title, text) {
  const element = make('div', {class: 'block'}, make('h3', {}, title));
  if (text) element.append(make('p', {class: 'soft'}, text));
  parent.append(element);
  return element;
}

// A section with a heading and a paragraph; callers add more content.
function section(title, text) {
  const element = make('section', {}, make('h2', {}, title));
  if (text) element.append(make('p', {class: 'soft'}, text));
  document.getElementById('page').append(element);
  return element;
}

// Plots keep their drawn size, but paper (A4) has another.
const PAPER_WIDTH = 680;
const PAPER_HEIGHT = {
  small: 240, paths: 300, rows2: 310, rows3: 390, rows4: 640, tall: 420,
};

function fitToPaper(div) {
  const half = div.parentElement.classList.contains('pair');
  const size = Object.keys(PAPER_HEIGHT).find(name => div.classList.contains(name));
  // Other plots have the height of their content.
  const height = PAPER_HEIGHT[size] || div.offsetHeight;
  div.style.height = height + 'px';
  Plotly.relayout(div, {width: half ? PAPER_WIDTH / 2 - 8 : PAPER_WIDTH, height});
}

function fitToScreen(div) {
  const fixed = div.classList.contains('batch');
  const height = fixed ? div.offsetHeight : null;
  div.style.height = '';
  Plotly.relayout(div, {width: null, height, autosize: true});
}

function fitForPrint() {
  const all = fit => () =>
      document.querySelectorAll('.js-plotly-plot:not(.screen *)').forEach(fit);
  window.addEventListener('beforeprint', all(fitToPaper));
  window.addEventListener('afterprint', all(fitToScreen));
}
