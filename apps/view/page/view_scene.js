
// The path and the map in 3D on a plain canvas: points with a depth buffer,
// lines drawn above them.

const SCENE = {
  ground: [0x12, 0x17, 0x1d],
  path: [COLOR.sky, COLOR.orange, '#5fd3a8', COLOR.purple, COLOR.yellow, '#f29b6b'],
  link: 'rgba(140, 152, 165, 0.45)', loop: '#ffd479', keyframe: '#e6edf3',
  camera: '#ffffff', ghost: '255, 120, 70',
};
const POINT_SIZE = 0.018;  // m
const GHOST_MS = 6000;

class Scene {
  constructor(canvas, map) {
    this.canvas = canvas;
    this.map = map;
    this.context = canvas.getContext('2d');
    // World: x right, y down, z forward of the first camera. Seen from behind
    // and above.
    this.yaw = 0.5;
    this.pitch = 0.55;
    this.zoom = 1;
    this.pan = [0, 0, 0];
    this.middle = [0, 0, 1];
    this.radius = 1.5;
    this.ghosts = [];
    this.listen();
  }

  listen() {
    const canvas = this.canvas;
    canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', event => {
      if (!event.buttons) return;
      if (event.shiftKey || event.buttons !== 1) {
        this.move(event.movementX, event.movementY);
      } else {
        this.yaw -= 0.006 * event.movementX;
        this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + 0.006 * event.movementY));
      }
      this.draw();
    });
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.zoom *= Math.exp(-0.0012 * event.deltaY);
      this.draw();
    }, {passive: false});
    canvas.addEventListener('dblclick', () => {
      this.zoom = 1;
      this.pan = [0, 0, 0];
      this.draw();
    });
    canvas.addEventListener('keydown', event => {
      const turn = {ArrowLeft: [0.08, 0], ArrowRight: [-0.08, 0],
                    ArrowUp: [0, 0.08], ArrowDown: [0, -0.08]}[event.key];
      if (turn) {
        this.yaw += turn[0];
        this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + turn[1]));
      } else if (event.key === '+' || event.key === '-') {
        this.zoom *= event.key === '+' ? 1.15 : 1 / 1.15;
      } else {
        return;
      }
      event.preventDefault();
      this.draw();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // The rotation from the world to the view, row by row.
  rotation() {
    const cy = Math.cos(this.yaw), sy = Math.sin(this.yaw);
    const cp = Math.cos(this.pitch), sp = Math.sin(this.pitch);
    return [cy, 0, -sy, sp * sy, cp, sp * cy, cp * sy, -sp, cp * cy];
  }

  move(dx, dy) {
    const r = this.rotation();
    const metres = this.distance() / this.focal() * (window.devicePixelRatio || 1);
    for (let k = 0; k < 3; ++k) this.pan[k] -= metres * (dx * r[k] + dy * r[3 + k]);
  }

  focal() { return 0.9 * Math.min(this.width, 1.3 * this.height); }
  distance() { return 1.75 * this.radius / this.zoom; }

  // Finds centre and size of the scene: most points and the whole path.
  fit() {
    const sides = [[], [], []];
    const add = p => p.forEach((value, k) => sides[k].push(value));
    for (const {p} of this.map.path()) if (p) add(p);
    const cameras = sides[0].length;
    for (const {pose, points} of this.map.keyframes.values()) {
      if (!pose) continue;
      const r = rotationOf(pose.q), view = new DataView(points.buffer);
      for (let at = 0; at + POINT_BYTES <= points.length; at += 40 * POINT_BYTES) {
        add(transform(r, pose.t, [0, 2, 4].map(k => view.getInt16(at + k, true) / 1000)));
      }
    }
    if (sides[0].length === 0) return;
    let square = 0;
    this.middle = sides.map(values => {
      const path = values.slice(0, cameras);
      const sorted = values.slice(cameras).sort((a, b) => a - b);
      const cut = share => sorted[Math.floor(share * (sorted.length - 1))];
      const low = Math.min(...path, sorted.length ? cut(0.04) : Infinity);
      const high = Math.max(...path, sorted.length ? cut(0.96) : -Infinity);
      square += (high - low) ** 2;
      return (low + high) / 2;
    });
    this.radius = Math.max(0.5, Math.sqrt(square) / 2);
  }

  // Shows the path before a loop closure, fading out.
  addGhost(path) { this.ghosts.push({path, since: performance.now()}); }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.paint();
    });
  }

  paint() {
    const still = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
    const moving = this.map.glide(still ? 1 : 0.22);
    this.resize();
    this.r = this.rotation();
    const back = this.distance();
    const target = this.middle.map((value, k) => value + this.pan[k]);
    const t = transform(this.r, [0, 0, 0], target);
    this.t = [-t[0], -t[1], back - t[2]];
    this.paintPoints();
    this.paintLinks();
    this.paintGhosts();
    this.paintPath(this.map.path('shown'), segment => SCENE.path[segment % SCENE.path.length], 2.5);
    this.paintCameras();
    this.paintScale(back);
    if (moving || this.ghosts.length) this.draw();
  }

  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.ratio = ratio;
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (width === this.width && height === this.height) return;
    this.canvas.width = this.width = width;
    this.canvas.height = this.height = height;
    this.image = this.context.createImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.nearest = new Float32Array(width * height);
  }

  paintPoints() {
    const {width, height, pixels, nearest} = this;
    const [red, green, blue] = SCENE.ground;
    pixels.fill(0xff000000 | blue << 16 | green << 8 | red);
    nearest.fill(Infinity);
    const f = this.focal(), cx = width / 2, cy = height / 2;
    for (const {shown, points} of this.map.keyframes.values()) {
      if (!shown || points.length === 0) continue;
      // From keyframe axes (mm) to view axes (m).
      const q = rotationOf(shown.q), r = this.r, m = new Float64Array(9);
      for (let i = 0; i < 3; ++i) {
        for (let k = 0; k < 3; ++k) {
          m[3 * i + k] = 1e-3 * (r[3 * i] * q[k] + r[3 * i + 1] * q[3 + k]
              + r[3 * i + 2] * q[6 + k]);
        }
      }
      const t = transform(r, this.t, shown.t);
      for (let at = 0; at + POINT_BYTES <= points.length; at += POINT_BYTES) {
        const x = (points[at] | points[at + 1] << 8) << 16 >> 16;
        const y = (points[at + 2] | points[at + 3] << 8) << 16 >> 16;
        const z = (points[at + 4] | points[at + 5] << 8) << 16 >> 16;
        const depth = m[6] * x + m[7] * y + m[8] * z + t[2];
        if (depth < 0.05) continue;
        const u = cx + f * (m[0] * x + m[1] * y + m[2] * z + t[0]) / depth;
        const v = cy + f * (m[3] * x + m[4] * y + m[5] * z + t[1]) / depth;
        const size = Math.min(5, Math.max(1, Math.round(f * POINT_SIZE / depth)));
        const left = Math.round(u - size / 2), top = Math.round(v - size / 2);
        if (left < 0 || top < 0 || left + size > width || top + size > height) continue;
        const red = 24 + 0.9 * points[at + 6], green = 24 + 0.9 * points[at + 7];
        const blue = 24 + 0.9 * points[at + 8];
        const color = 0xff000000 | blue << 16 | green << 8 | red;
        for (let row = top; row < top + size; ++row) {
          for (let pixel = row * width + left, k = 0; k < size; ++k, ++pixel) {
            if (depth >= nearest[pixel]) continue;
            nearest[pixel] = depth;
            pixels[pixel] = color;
          }
        }
      }
    }
    this.context.putImageData(this.image, 0, 0);
  }

  // Projects to the canvas; null: behind the view.
  project(p) {
    const [x, y, z] = transform(this.r, this.t, p);
    if (z < 0.05) return null;
    return [this.width / 2 + this.focal() * x / z, this.height / 2 + this.focal() * y / z];
  }

  line(points, color, width) {
    const context = this.context;
    context.strokeStyle = color;
    context.lineWidth = width * this.ratio;
    context.lineJoin = 'round';
    context.beginPath();
    let down = false;
    for (const p of points) {
      const at = p && this.project(p);
      if (!at) {
        down = false;
      } else if (down) {
        context.lineTo(at[0], at[1]);
      } else {
        context.moveTo(at[0], at[1]);
        down = true;
      }
    }
    context.stroke();
  }

  paintLinks() {
    const far = [];
    const near = [];
    for (const [a, b, loop] of this.map.links) {
      const one = this.map.keyframes.get(a), two = this.map.keyframes.get(b);
      if (!one || !two || !one.shown || !two.shown) continue;
      (loop ? far : near).push(one.shown.t, two.shown.t, null);
    }
    this.line(near, SCENE.link, 1);
    this.line(far, SCENE.loop, 2);
  }

  paintGhosts() {
    const now = performance.now();
    this.ghosts = this.ghosts.filter(ghost => now - ghost.since < GHOST_MS);
    for (const {path, since} of this.ghosts) {
      const left = 1 - (now - since) / GHOST_MS;
      this.paintPath(path, () => `rgba(${SCENE.ghost}, ${left.toFixed(3)})`, 1.5);
    }
  }

  paintPath(path, colorOf, width) {
    let piece = [];
    for (let i = 0; i < path.length; ++i) {
      if (i > 0 && path[i].segment !== path[i - 1].segment) {
        this.line(piece, colorOf(path[i - 1].segment), width);
        piece = [];
      }
      piece.push(path[i].p);
    }
    if (piece.length) this.line(piece, colorOf(path[path.length - 1].segment), width);
  }

  paintCameras() {
    const context = this.context;
    context.fillStyle = SCENE.keyframe;
    for (const {shown} of this.map.keyframes.values()) {
      const at = shown && this.project(shown.t);
      if (!at) continue;
      context.beginPath();
      context.arc(at[0], at[1], 2.2 * this.ratio, 0, 2 * Math.PI);
      context.fill();
    }
    const frames = this.map.frames;
    let last = frames.length - 1;
    while (last >= 0 && frames[last].keyframe === null) --last;
    const keyframe = last >= 0 && this.map.keyframes.get(frames[last].keyframe);
    if (!keyframe || !keyframe.shown) return;
    // The corners of the camera pyramid, with a size that stays visible.
    const size = 0.09 * this.radius;
    const ref = rotationOf(keyframe.shown.q), own = rotationOf(frames[last].pose.q);
    const place = p => transform(ref, keyframe.shown.t,
        transform(own, frames[last].pose.t, p));
    const eye = place([0, 0, 0]);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(
        ([x, y]) => place([0.6 * size * x, 0.45 * size * y, size]));
    const color = frames[frames.length - 1].status === 'lost' ? '#ff8a5c' : SCENE.camera;
    this.line([...corners, corners[0], null, eye, corners[0], null, eye, corners[1], null,
               eye, corners[2], null, eye, corners[3]], color, 2);
  }

  // Draws a scale bar of a round length, valid at the distance of the centre.
  paintScale(distance) {
    const context = this.context, ratio = this.ratio;
    const perMetre = this.focal() / distance;
    const length = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find(
        metres => metres * perMetre > 60 * ratio) || 100;
    const right = this.width - 16 * ratio, y = this.height - 16 * ratio;
    context.fillStyle = context.strokeStyle = '#c9d1d9';
    context.lineWidth = 2 * ratio;
    context.beginPath();
    context.moveTo(right - length * perMetre, y);
    context.lineTo(right, y);
    context.stroke();
    context.font = `${12 * ratio}px system-ui, sans-serif`;
    context.textAlign = 'right';
    context.fillText(length < 1 ? `${100 * length} cm` : `${length} m`, right, y - 7 * ratio);
  }
}
