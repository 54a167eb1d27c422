'use strict';

// The page of one run.

function baseName(path) {
  const parts = String(path || '').split('/').filter(part => part);
  return parts.length ? parts[parts.length - 1] : 'run';
}

// Describes the exposure times of rows and how the run handled them.
function shutterInWords(data) {
  const shutter = data.metrics.shutter, stamps = data.metrics.depth_stamp_ms;
  if (!shutter || !stamps) return '';
  const {color, depth} = shutter;
  const all = [color.offset_ms, color.readout_ms, depth.offset_ms, depth.readout_ms,
               stamps.least, stamps.most];
  if (all.every(ms => ms === 0)) return '';
  const ms = value => digits(value, 2).replace('-', '−');
  return `Times: depth is stamped ${ms(stamps.least)} to ${ms(stamps.most)} ms after ` +
      `colour (median ${ms(stamps.median)} ms). The middle row is exposed ` +
      `${ms(color.offset_ms)} ms (colour) and ${ms(depth.offset_ms)} ms (depth) after ` +
      `the time stamp; the readout takes ${ms(color.readout_ms)} ms (colour) and ` +
      `${ms(depth.readout_ms)} ms (depth). ` +
      (setting(data, 'shutter') === 'none' ? 'These times are not compensated (--shutter=none).'
          : 'All rows are corrected to the time stamp of colour.');
}

function header(data) {
  const run = data.metrics.run;
  const name = baseName(data.metrics.dataset);
  document.title = name + ': rgbd_pose run';
  const page = document.getElementById('page');
  const times = data.frames.t;
  const seconds = times.length ? times[times.length - 1] : 0;
  page.append(
      make('h1', {}, 'Camera motion: ' + name),
      make('p', {class: 'soft'},
          `${run.frames} frame${run.frames === 1 ? '' : 's'} over ` +
          `${digits(seconds, 3)} s; tracker ${setting(data, 'tracker')}, cost ` +
          `${setting(data, 'cost')}, loss ${setting(data, 'loss')}, frontend ` +
          `${setting(data, 'frontend')}.`));
  const figures = make('div', {class: 'figures'});
  const add = (value, text) => figures.append(figureTile(value, text));
  const evaluation = data.metrics.evaluation;
  if (evaluation && evaluation.ate.position_m) {
    add(digits(evaluation.ate.position_m.rmse * 1000, 3) + ' mm',
        'position error (ATE, RMSE)');
  }
  if (evaluation && evaluation.rpe_seconds.translation_m) {
    add(digits(evaluation.rpe_seconds.translation_m.rmse * 1000, 3) + ' mm',
        'translation error over 1\u00a0s (RPE, RMSE)');
    add(digits(evaluation.rpe_seconds.rotation_deg.rmse, 3) + '°',
        'rotation error over 1\u00a0s (RPE, RMSE)');
  }
  add(digits(100 * run.tracked_share, 3) + ' %',
      `of frames tracked (${run.ok} ok, ${run.degraded} degraded, ${run.lost} lost)`);
  const segments = mapSegments(data.metrics.slam) || run.segments;
  if (segments > 1) add(String(segments), 'segments; their relative poses are unknown');
  const jumps = data.metrics.jumps || [];
  if (jumps.length > 0) {
    add(digits(1000 * jumps[0].translation_m, 2) + ' mm',
        `largest of ${jumps.length} jumps, at frame no. ${jumps[0].frame}`);
  }
  if (evaluation && known(evaluation.with_scale.truth_per_estimate)) {
    const percent = 100 * (1 / evaluation.with_scale.truth_per_estimate - 1);
    add((percent < 0 ? '−' : '+') + digits(Math.abs(percent), 2) + ' %',
        'scale error of the path against the ground truth');
  }
  add(digits(run.track_ms_median, 3) + ' ms', 'tracking per frame, median');
  add(digits(run.frames_per_second, 3),
      `frames/s with decoding, ${run.threads} thread${run.threads === 1 ? '' : 's'}`);
  for (const [key, text] of [
    ['damaged_frames', 'damaged frames, left out'],
    ['repeated_color', 'colour images sent twice'],
    ['repeated_depth', 'depth images sent twice'],
    ['unmatched_color', 'colour images without depth, left out'],
    ['dropped_frames', 'frames left out because tracking was too slow'],
  ]) {
    if (data.metrics[key]) add(String(data.metrics[key]), text);
  }
  page.append(figures);
  const moved = shutterInWords(data);
  if (moved) page.append(make('p', {class: 'soft'}, moved));
  for (const remark of data.metrics.remarks || []) {
    page.append(make('p', {}, remark));
  }
  if (data.metrics.stopped) {
    page.append(make('p', {}, 'Stopped early: ' + data.metrics.stopped));
  }
}

// What is known of the errors of the ground truth.
function truthNoise(consistency) {
  const metres = consistency.truth_sigma_m, degrees = consistency.truth_sigma_deg;
  const origin = consistency.truth_sigma_origin;
  if (!origin) {
    return 'assumed to be exact, since nothing else is known: if it was measured, ' +
        'rgbd_evaluate takes its error (--truth_sigma_metres, --truth_sigma_degrees).';
  }
  if (!metres && !degrees) return `exact (${origin}).`;
  return `taken with sigmas of ${digits(1000 * metres, 3)} mm and ` +
      `${digits(degrees, 3)}° (${origin}).`;
}

function metrics(data) {
  const e = data.metrics.evaluation, run = data.metrics.run;
  const number = (value, count = 3) => ({number: digits(value, count)});
  const element = section('Metrics');
  if (e) {
    element.append(make('p', {class: 'soft'},
        `${e.paired_poses} of ${e.estimated_poses} estimated poses have a ground ` +
        `truth within ${e.max_time_difference_s} s; they span ` +
        `${digits(e.duration_s, 4)} s and ${digits(e.path_length_m, 4)} m of path.`));
    const row = (name, statistics, factor, definition) => [
      {class: 'name', text: name},
      ...['rmse', 'median', 'p90', 'p99', 'max'].map(key => (
        statistics && key in statistics ? number(statistics[key] * factor)
          : {number: 'n/a'})),
      definition,
    ];
    const relative = (key, span, words) => (e[key] ? [
      row(`RPE over ${span}: translation (mm)`, e[key].translation_m, 1000,
          `Translation error of all motions ${words}.`),
      row(`RPE over ${span}: rotation (°)`, e[key].rotation_deg, 1,
          'Rotation error of the same motions.'),
    ] : []);
    const rows = [
      row('ATE: position (mm)', e.ate.position_m, 1000,
          'Distance of each estimated position from the true one after rigid ' +
          'alignment of the whole path, without scale.'),
      ...relative('rpe_frame', '1 frame', 'from one frame to the next'),
      ...relative('rpe_seconds', `${e.rpe_seconds.delta} s`,
          `over ${e.rpe_seconds.delta} s`),
      ...relative('rpe_metres', `${e.rpe_metres.delta} m`,
          `over ${e.rpe_metres.delta} m of the true path`),
    ];
    element.append(table(['', {number: 'RMSE'}, {number: 'median'}, {number: '90 %'},
                          {number: '99 %'}, {number: 'max'}, 'what it is'], rows, 'stack'));
    element.append(make('p', {},
        `With a free scale the path fits best if scaled by ` +
        `${digits(e.with_scale.truth_per_estimate, 4)}; the ATE is then ` +
        `${digits(e.with_scale.position_rmse_m * 1000, 3)} mm. A deviation of more than ` +
        '1 % indicates a wrong depth scale (--depth_scale) or focal length.'));
    if (e.final_pose) {
      element.append(make('p', {},
          `Error of the last pose relative to the first: ` +
          `${digits(e.final_pose.translation_m * 1000, 3)} mm and ` +
          `${digits(e.final_pose.rotation_deg, 3)}°.`));
    }
    if (e.consistency) {
      const frames = e.consistency.ok_frames;
      element.append(make('p', {},
          `Of ${frames.count} evaluated frames with status ok, ${frames.wrong} are ` +
          'wrong: their error exceeds five sigmas of their own covariance. Squared ' +
          `errors are on average ${frames.count ? digits(frames.nees, 3) : 'n/a'} times ` +
          'those that the covariances predict (NEES). The ground truth is ' +
          truthNoise(e.consistency)));
    }
    element.append(make('h3', {}, 'Run'));
  }
  const rows = [
    ['tracked frames', digits(100 * run.tracked_share, 4) + ' %',
     'Frames with a pose: ok or degraded. Degraded: from few or contradictory matches.'],
    ['new references', String(run.references),
     'Frames that were used as reference frames for tracking.'],
    ['relocalised', String(run.relocalised),
     'Frames found among earlier reference frames after tracking was lost.'],
    ['matches', digits(run.matches_median, 3), 'Median number in a frame.'],
    ['inliers', digits(100 * run.inlier_share_median, 3) + ' %',
     'Median share of matches whose residual lies within 99 % of the noise.'],
    ['tracking', digits(run.track_ms_median, 3) + ' ms',
     `Median per frame without decoding; 99 of 100 frames take less than ` +
     `${digits(run.track_ms_p99, 3)} ms.`],
    ['matching', digits(run.match_ms_median, 3) + ' ms',
     'Part of tracking, median: matching features, selecting pixels.'],
    ['pose solve', digits(run.solve_ms_median, 3) + ' ms',
     'Part of tracking, median: all solves of a frame, from features and from ' +
     'pixels, with their iterations, weights and covariance.'],
    ['new reference', digits(run.reference_ms_median, 3) + ' ms',
     'Median of the frames that became a reference frame.'],
    ['decoding', digits(run.decode_ms_median, 3) + ' ms',
     'Reading the two images of a frame, median.'],
    ['throughput', digits(run.frames_per_second, 3) + ' frames/s',
     `Whole program: ${digits(run.wall_seconds, 3)} s with ${run.threads} ` +
     `thread${run.threads === 1 ? '' : 's'}.`],
    ['memory', digits(data.metrics.peak_rss_mb, 3) + ' MB', 'Peak memory usage.'],
  ];
  element.append(table(['', {number: ''}, 'what it is'],
      rows.map(([name, value, text]) => [
        {class: 'name', text: name}, {number: value}, text]), 'stack'));
}

function showRun(data) {
  header(data);
  paths(data);
  map(data);
  errors(data);
  tracking(data);
  times(data);
  residuals(data);
  metrics(data);
  settings(data, data.metrics.slam ? 'rgbd_slam' : 'rgbd_odometry');
}
