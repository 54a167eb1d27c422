
// The live page: receives events, shows pictures and figures.

const byId = id => document.getElementById(id);
const map = new RunMap();
const scene = new Scene(byId('scene'), map);
const images = new Images(byId('image'), byId('depth'));
const strips = new Strips(byId('strips'), map);
const page = byId('page');
const path = JSON.parse(byId('data').textContent).title;
const title = path.split('/').filter(Boolean).pop() || path;  // the folder's name

let paused = false, ended = false, stopping = false;

byId('title').textContent = title;
document.title = `${title} - rgbd_pose live`;
byId('scene-legend').append(...[
  [SCENE.path[0], 'path'], ['#e6edf3', 'keyframes'], ['#8c98a5', 'pairs'],
  [SCENE.loop, 'loops'], [`rgb(${SCENE.ghost})`, 'path before a loop closure'],
].map(([color, text]) => make('span', {},
    make('i', {style: `background:${color}; box-shadow: 0 0 0 1px rgba(27,31,36,.25)`}), text)));

function say(status, words) {
  byId('status').className = `pill ${status}`;
  byId('status').textContent = status;
  byId('reason').textContent = words;
}

function showStatus() {
  const frame = map.frames[map.frames.length - 1];
  if (!frame) return;
  const words = {ok: 'The motion is known and many matches agree.'}[frame.status]
      || `${frame.reason}.`;
  if (!ended) say(frame.status, words);
  if (!ended && stopping) say('stopping', 'Results are being written.');
  if (!ended && paused) say('paused', 'Press Resume to continue with the next frame.');
  const recent = map.frames.slice(-30);
  const median = values => quantileOf(values, 0.5);
  const agree = frame.matches ? Math.round(100 * frame.inliers / frame.matches) : 0;
  byId('figures').replaceChildren(
      figureTile(String(map.frames.length),
          `frames, ${(frame.t - map.frames[0].t).toFixed(1)} s of recording`),
      figureTile(`${digits(median(recent.map(f => f.ms)), 2)} ms`,
          'to track a frame, median of the last 30'),
      figureTile(String(frame.matches), `matches, ${agree} % of them inliers`),
      figureTile(digits(frame.sigma, 2), 'sigma: residuals over assumed noise'),
      figureTile(String(map.keyframes.size), `keyframes, ${map.links.length} pairs`),
      figureTile(String(map.loops), 'loop closures'));
}

function log(event) {
  byId('log').prepend(make('li', {}, make('b', {}, `frame ${event.frame}`), event.text));
  while (byId('log').children.length > 12) byId('log').lastChild.remove();
}

let noticeTimer = 0;
function notice(text) {
  byId('notice').textContent = text;
  byId('notice').classList.add('shown');
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => byId('notice').classList.remove('shown'), GHOST_MS);
}

function showButtons() {
  byId('pause').textContent = paused ? 'Resume' : 'Pause';
  byId('pause').disabled = ended || stopping;
  byId('stop').disabled = ended || stopping;
}

// State for tests and for users of the console.
function publish() {
  Object.assign(page.dataset, {
    frames: map.frames.length, keyframes: map.keyframes.size, links: map.links.length,
    loops: map.loops, points: map.points, paused, ended,
  });
}

function take(news) {
  // A page that opens late receives old loops, but has no motion to show.
  const late = news.frames.length > 100;
  for (const event of map.add(news)) {
    log(event);
    if (event.kind === 'loop' && !late) {
      scene.addGhost(event.before);
      notice(event.text);
    }
  }
  paused = news.paused;
  if (news.keyframes.length || news.poses.length || map.frames.length < 50) scene.fit();
  showStatus();
  showButtons();
  scene.draw();
  strips.paint();
  publish();
}

const source = new EventSource('events');
source.addEventListener('news', event => take(JSON.parse(event.data)));
source.addEventListener('images', event => {
  images.show(JSON.parse(event.data)).then(() => { page.dataset.images = 'true'; });
});
source.addEventListener('end', event => {
  ended = true;
  source.close();
  const folder = JSON.parse(event.data);
  say('finished', folder
      ? `Results are in ${folder}; open ${folder}/report.html for the report.`
      : 'No more frames are tracked.');
  showButtons();
  publish();
});
source.addEventListener('open', () => {
  // After a reconnection, everything is sent again.
  Object.assign(map, new RunMap());
  byId('log').replaceChildren();
});
source.onerror = () => {
  if (!ended) say('gone', 'The program does not respond: it has ended or is busy.');
};

function press(path) {
  return fetch(path, {method: 'POST'}).catch(() => {});
}
byId('pause').addEventListener('click', () => press(paused ? 'resume' : 'pause'));
byId('stop').addEventListener('click', () => {
  stopping = true;
  showButtons();
  showStatus();
  press('stop');
});
