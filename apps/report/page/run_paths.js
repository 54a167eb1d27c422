'use strict';

// The path of the camera: two 2D views and one 3D view.

const TRUTH_COLOR = '#b9c2cb';

// Splits the path into one trace per segment, with gaps where lost.
function segmentTraces(data, axes, type, line) {
  const path = data.path, frames = data.frames;
  const ids = [...new Set(frames.segment.filter((s, i) => known(path.x[i])))];
  return ids.map((id, k) => {
    const trace = {
      type, mode: path.x.length === 1 ? 'markers' : 'lines',
      name: ids.length > 1 ? `estimate, segment ${id + 1}` : 'estimate',
      line: Object.assign({color: SEGMENT_COLORS[k % SEGMENT_COLORS.length]}, line),
      marker: {color: SEGMENT_COLORS[k % SEGMENT_COLORS.length]},
      connectgaps: false,
      customdata: frames.t,
      hovertemplate: '%{customdata:.2f} s<extra>%{fullData.name}</extra>',
      legendgroup: 'segment' + id,
    };
    'xyz'.split('').slice(0, axes.length).forEach((letter, i) => {
      trace[letter] = path[axes[i]].map(
          (value, frame) => (frames.segment[frame] === id ? value : null));
    });
    return trace;
  });
}

function pathTraces(data, axes, type, line) {
  const path = data.path;
  const letters = 'xyz'.split('').slice(0, axes.length);
  const traces = [];
  if (path.true_x) {
    // A pale band, which is seen also where the estimate covers it. In 3D, where
    // the nearer line covers the other, it is hardly wider.
    const wider = type === 'scatter3d' ? 1.5 : 4;
    const truth = {type, mode: path.x.length === 1 ? 'markers' : 'lines',
                   name: 'ground truth', connectgaps: false,
                   line: {color: TRUTH_COLOR, width: wider * line.width},
                   marker: {color: COLOR.black, symbol: 'circle-open', size: 9},
                   customdata: data.frames.t,
                   hovertemplate: '%{customdata:.2f} s<extra>ground truth</extra>'};
    letters.forEach((letter, i) => { truth[letter] = path['true_' + axes[i]]; });
    traces.push(truth);
  }
  traces.push(...segmentTraces(data, axes, type, line));
  const tracked = path.x.map((v, i) => (known(v) ? i : -1)).filter(i => i >= 0);
  const ends = [['start', tracked[0], 'circle', '#fff'],
                ['end', tracked[tracked.length - 1], 'square', COLOR.black]];
  for (const [name, place, symbol, color] of ends) {
    if (place === undefined || (name === 'end' && tracked.length < 2)) continue;
    const marker = {type, mode: 'markers', name, hoverinfo: 'name',
                    marker: {symbol, color, size: type === 'scatter3d' ? 5 : 10,
                             line: {color: COLOR.black, width: 1.5}}};
    letters.forEach((letter, i) => { marker[letter] = [path[axes[i]][place]]; });
    traces.push(marker);
  }
  return traces;
}

// The downward direction in the world of the page, used to show the path
// upright. If gravity is not known, it is that of the first camera: x right, y
// down, z forward.
function downVector(data) {
  const gravity = data.metrics.gravity;
  const down = gravity && gravity.up ? gravity.up.map(value => -value) : [0, 1, 0];
  const turn = truthFromMap(data);
  const origin = turn([0, 0, 0]);
  return turn(down).map((value, k) => value - origin[k]);
}

function hasWebGl() {
  try {
    return !!document.createElement('canvas').getContext('webgl');
  } catch (error) {
    return false;
  }
}

// The range of all positions along an axis with a margin. Equal scales of both
// axes may widen it.
function pathRange(values, reversed) {
  const all = values.filter(known);
  const low = Math.min(...all), high = Math.max(...all);
  const room = 0.05 * (high - low) || 0.5;
  return reversed ? [high + room, low - room] : [low - room, high + room];
}

// The ranges of a scene that holds all traces, and its aspect ratio for equal
// scales. The longest side is constant, which keeps a long path in view.
function sceneBox(traces) {
  const kLongestSide = 1.05, kThinnest = 0.1;
  const low = {}, high = {};
  for (const name of ['x', 'y', 'z']) {
    low[name] = Infinity;
    high[name] = -Infinity;
    for (const trace of traces) {
      for (const value of trace[name]) {
        if (!known(value)) continue;
        low[name] = Math.min(low[name], value);
        high[name] = Math.max(high[name], value);
      }
    }
  }
  const longest = Math.max(...['x', 'y', 'z'].map(name => high[name] - low[name])) || 1;
  const ranges = {}, ratio = {};
  for (const name of ['x', 'y', 'z']) {
    const side = Math.max(1.04 * (high[name] - low[name]), kThinnest * longest);
    const middle = (low[name] + high[name]) / 2;
    ranges[name] = [middle - side / 2, middle + side / 2];
    ratio[name] = kLongestSide * side / longest;
  }
  return {ranges, ratio};
}

// Draws two 2D views of paths and one in 3D. Their ids begin with `prefix`;
// `sizes` has the size class of the 2D views and that of the 3D view.
// `positions` has all x, y and z, `down` is the downward axis;
// `tracesOf(axes, type, line)` makes the traces.
function pathViews(element, prefix, sizes, positions, down, tracesOf) {
  const pair = make('div', {class: 'pair'});
  element.append(pair);
  for (const [a, b, k] of [['x', 'y', 1], ['x', 'z', 2]]) {
    plot(`${prefix}path-${a}${b}`, sizes[0], pair,
        tracesOf([a, b], 'scatter', {width: 2}), {
          xaxis: axis(a.toUpperCase() + ' (m)',
              {nticks: 6, range: pathRange(positions[a], false)}),
          yaxis: axis(b.toUpperCase() + ' (m)',
              {nticks: 7, scaleanchor: 'x',
               range: pathRange(positions[b], down[k] > 0.7)}),
          hovermode: 'closest',
        });
  }
  const screen = make('div', {class: 'screen'});
  element.append(screen);
  if (!hasWebGl()) {
    screen.append(make('p', {class: 'soft'},
        'The 3D view needs WebGL, which this browser does not support.'));
    return;
  }
  screen.append(make('h3', {}, '3D view'), make('p', {class: 'soft'},
      'Drag to rotate, scroll or pinch to zoom. In the other plots, drag with the mouse '
      + 'to zoom and double-click to reset.'));
  const traces = tracesOf(['x', 'y', 'z'], 'scatter3d', {width: 4});
  const {ranges, ratio} = sceneBox(traces);
  const axis3 = name => ({
    title: {text: name.toUpperCase() + ' (m)'}, range: ranges[name],
    nticks: Math.max(2, Math.round(5 * ratio[name])),  // room for few on short sides
    gridcolor: '#d8dee4', backgroundcolor: '#fff', zeroline: false,
  });
  const side = down.map(v => -v);
  // Looks from behind and above for any vertical axis. The distance is smaller
  // for a flat path than for a high one, and larger in a narrow window.
  const height = ['x', 'y', 'z'].reduce((h, name, k) =>
      h + Math.abs(side[k]) * ratio[name], 0);
  const far = window.innerWidth < 600 ? 1.5
      : (sizes[1] === 'tall' ? 0.4 : 0.45) + 0.5 * Math.min(1, height);
  const back = Math.abs(side[1]) > 0.7 ? [-1, 0, -1.7] : [1.4, -1.6, 0];
  const eye = back.map((v, k) => far * (v + 0.8 * side[k]));
  plot(`${prefix}path-3d`, sizes[1], screen, traces, {
    margin: {l: 0, r: 0, t: 0, b: 0},
    dragmode: 'turntable',
    hovermode: 'closest',
    scene: {
      aspectmode: 'manual', aspectratio: ratio, dragmode: 'orbit',
      xaxis: axis3('x'), yaxis: axis3('y'), zaxis: axis3('z'),
      camera: {up: {x: side[0], y: side[1], z: side[2]},
               eye: {x: eye[0], y: eye[1], z: eye[2]}},
    },
  });
}

function paths(data) {
  const element = section('Path', data.path.true_x
      ? 'Positions of the camera in the world of the ground truth, the estimate ' +
        'after rigid alignment (no scale). Equal scales on all axes.'
      : 'Positions of the camera relative to the first pose: X right, Y down, Z ' +
        'forward. There is no ground truth. Equal scales on all axes.');
  const positions = {};
  for (const name of ['x', 'y', 'z']) {
    positions[name] = data.path[name].concat(data.path['true_' + name] || []);
  }
  const sizes = ['small', data.cloud || data.mesh ? 'tall' : 'large'];
  pathViews(element, '', sizes, positions, downVector(data), (axes, type, line) => (
      (type === 'scatter3d' ? seenTraces(data) : []).concat(
          pathTraces(data, axes, type, line))));
  seenNote(data, element);
}
