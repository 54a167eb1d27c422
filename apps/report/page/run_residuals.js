'use strict';

// The distributions of residuals and weights.

// Density of the norm of `degrees` independent standard normal numbers.
function chiDensity(x, degrees) {
  const kGamma = [0, Math.sqrt(Math.PI), 1, Math.sqrt(Math.PI) / 2, 1,
                  Math.sqrt(Math.PI) * 3 / 4, 2];  // of degrees / 2
  return Math.pow(x, degrees - 1) * Math.exp(-x * x / 2) /
      (Math.pow(2, degrees / 2 - 1) * kGamma[degrees]);
}

function residuals(data) {
  const r = data.metrics.residuals;
  if (!r || r.matches === 0) return;
  const loss = data.loss;
  const percent = count => digits(100 * count / r.matches, 2) + ' %';
  const element = section('Residuals and robust weights',
      `The ${r.matches.toLocaleString('en')} matches of all tracked frames, each ` +
      'at the estimated motion. The norm of a whitened residual is in sigmas of the ' +
      'noise model.');
  const density = r.norm_counts.map(c => c / (r.matches * r.norm_bin));
  const end = r.norm_counts.length * r.norm_bin;
  const chi = {x: [], y: []};
  for (let x = 0; x <= end + 1e-9; x += 0.05) {
    chi.x.push(x);
    chi.y.push(r.degrees_counts.reduce((sum, count, p) => (
        p > 0 && count > 0 ? sum + count / r.matches * chiDensity(x, p) : sum), 0));
  }
  const rows = [{title: '', y: 'density', weight: 1.5}];
  const filled = bars(density, 0, r.norm_bin);
  const traces = [
    {type: 'scatter', mode: 'lines', name: 'matches', x: filled.x, y: filled.y,
     fill: 'tozeroy', fillcolor: 'rgba(86,180,233,0.55)', hoverinfo: 'skip',
     line: {color: COLOR.blue, width: 1}},
    {type: 'scatter', mode: 'lines', name: 'expected for correct matches (chi)',
     x: chi.x, y: chi.y, line: {color: COLOR.black, width: 2, dash: 'dash'},
     hoverinfo: 'skip'},
  ];
  if (loss) {
    const x = loss.weights.map((w, i) => i * loss.step);
    traces.push(
        {type: 'scatter', mode: 'lines', name: `weight w of ${loss.name}`, x,
         y: loss.weights, yaxis: 'y2', line: {color: COLOR.vermillion, width: 2},
         hovertemplate: '%{y:.2f}'},
        {type: 'scatter', mode: 'lines', name: 'influence w·x', x,
         y: loss.weights.map((w, i) => w * x[i]), yaxis: 'y2',
         line: {color: COLOR.green, width: 2, dash: 'dot'}, hovertemplate: '%{y:.2f}'});
    rows.push({title: '', y: 'w, w·x'});
  }
  const layout = rowsLayout(rows, 'norm x of the whitened residual (sigmas)', [0, end]);
  layout.showlegend = true;
  if (loss && setting(data, 'scale') === 'fixed') {
    layout.shapes = [{type: 'line', xref: 'x', x0: loss.limit, x1: loss.limit,
                      yref: 'paper', y0: 0, y1: 1,
                      line: {color: COLOR.grey, width: 1, dash: 'dash'}}];
    layout.annotations.push({
      text: 'inliers up to here', showarrow: false, x: loss.limit, xref: 'x',
      xanchor: 'left', xshift: 4, y: 1, yref: 'paper', yanchor: 'top',
      font: {color: '#57606a'}});
  }
  plot('residuals', loss ? 'rows2' : 'small', element, traces, layout);
  let text = `${percent(r.norms_above)} of the matches lie beyond ${digits(end, 2)} sigmas.`;
  if (loss && loss.width !== null) {
    text += ` The width of ${loss.name} is ${digits(loss.width, 3)} sigmas` +
        (setting(data, 'scale') === 'fixed' ? '.'
            : ', multiplied by the scale estimated in each frame.');
  }
  element.append(make('p', {class: 'soft caption'}, text));

  element.append(make('h3', {}, 'Robust weights'));
  const weights = bars(r.weight_counts.map(c => 100 * c / r.matches), 0, r.weight_bin);
  plot('weights', 'small', element, [{
    type: 'scatter', mode: 'lines', name: 'matches', x: weights.x, y: weights.y,
    fill: 'tozeroy', fillcolor: 'rgba(86,180,233,0.55)', hoverinfo: 'skip',
    line: {color: COLOR.blue, width: 1},
  }], {
    showlegend: false,
    xaxis: axis('robust weight of a match', {range: [0, 1]}),
    yaxis: axis('share of the matches (%)', {rangemode: 'tozero'}),
  });
  element.append(make('p', {class: 'soft caption'},
      `${percent(r.weights_zero)} of the matches have weight 0: the estimate ` +
      'ignores them.'));
}
