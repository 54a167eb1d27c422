
// The run as a live page knows it. Frames are relative to moving keyframes.

const STATUS = ['ok', 'degraded', 'lost'];

// Above this number of points, each keyframe drops half of its points.
const MAX_POINTS = 200000;
const POINT_BYTES = 9;  // see kViewPointBytes

// Reads a pose of the server from index `at`: x, y, z, quaternion x, y, z, w.
function readPose(row, at) {
  return {t: row.slice(at, at + 3), q: row.slice(at + 3, at + 7)};
}

// The rotation matrix of a quaternion, row by row.
function rotationOf([x, y, z, w]) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
          2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}

function transform(r, t, p) {
  return [r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + t[0],
          r[3] * p[0] + r[4] * p[1] + r[5] * p[2] + t[1],
          r[6] * p[0] + r[7] * p[1] + r[8] * p[2] + t[2]];
}

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), c => c.charCodeAt(0));
}

class RunMap {
  constructor() {
    this.frames = [];
    this.keyframes = new Map();  // by id: pose (known), shown (animated)
    this.links = [];
    this.loops = 0;
    this.points = 0;
  }

  // Adds news of the server. Returns events for users.
  add(news) {
    const happened = [];
    for (const row of news.frames) happened.push(...this.addFrame(row));
    for (const [id, points] of news.keyframes) this.addPoints(id, bytesOf(points));
    const closed = news.links.filter(link => link[2]);
    this.links.push(...news.links);
    this.loops += closed.length;
    if (news.poses.length === 0) return happened;
    const before = closed.length ? this.path() : null;
    for (const row of news.poses) this.place(row[0], readPose(row, 1));
    if (before) {
      const moved = this.largestMove(before);
      const [a, b] = closed[0];
      happened.push({
        kind: 'loop', frame: b, before,
        text: `Loop closed: keyframe ${b} sees the same place as keyframe ${a}`
            + `${closed.length > 1 ? ` (${closed.length} pairs)` : ''}. The path moved by `
            + `up to ${digits(moved * lengthUnit(moved).factor, 2)} ${lengthUnit(moved).name}.`,
      });
    }
    return happened;
  }

  addFrame(row) {
    const frame = {
      t: row[0], status: STATUS[row[1]], ms: row[2], matches: row[3], inliers: row[4],
      sigma: row[5], segment: row[6], reason: row[7], keyframe: row[8],
      pose: row[8] === null ? null : readPose(row, 9),
    };
    const last = this.frames[this.frames.length - 1];
    this.frames.push(frame);
    const was = last ? last.status : 'ok';
    if (frame.status === was) return [];
    const number = this.frames.length - 1;
    const text = frame.status === 'ok' ? 'Tracking is ok again.'
        : (frame.status === 'lost' ? 'Lost: ' : 'Degraded: ') + frame.reason + '.';
    return [{kind: frame.status, frame: number, text}];
  }

  addPoints(id, points) {
    this.keyframe(id).points = points;
    this.points += points.length / POINT_BYTES;
    while (this.points > MAX_POINTS) {
      this.points = 0;
      for (const keyframe of this.keyframes.values()) {
        const half = Math.floor(keyframe.points.length / POINT_BYTES / 2);
        keyframe.points = keyframe.points.slice(0, half * POINT_BYTES);
        this.points += half;
      }
    }
  }

  keyframe(id) {
    if (!this.keyframes.has(id)) {
      this.keyframes.set(id, {pose: null, shown: null, points: new Uint8Array(0)});
    }
    return this.keyframes.get(id);
  }

  place(id, pose) {
    const keyframe = this.keyframe(id);
    keyframe.pose = pose;
    if (!keyframe.shown) keyframe.shown = {t: pose.t.slice(), q: pose.q.slice()};
  }

  // Moves the shown poses by a share of the way to the known ones. Returns
  // whether any pose is still moving.
  glide(share) {
    let moving = false;
    for (const {pose, shown} of this.keyframes.values()) {
      if (!pose) continue;
      let far = 0, dot = 0;
      for (let k = 0; k < 3; ++k) far = Math.max(far, Math.abs(pose.t[k] - shown.t[k]));
      for (let k = 0; k < 4; ++k) dot += pose.q[k] * shown.q[k];
      const sign = dot < 0 ? -1 : 1;
      const near = far < 1e-4 && Math.abs(dot) > 1 - 1e-7;
      const part = near ? 1 : share;
      for (let k = 0; k < 3; ++k) shown.t[k] += part * (pose.t[k] - shown.t[k]);
      let norm = 0;
      for (let k = 0; k < 4; ++k) {
        shown.q[k] += part * (sign * pose.q[k] - shown.q[k]);
        norm += shown.q[k] * shown.q[k];
      }
      for (let k = 0; k < 4; ++k) shown.q[k] /= Math.sqrt(norm);
      moving = moving || !near;
    }
    return moving;
  }

  // The position of a frame, as known or as shown; null: lost.
  position(frame, which = 'pose') {
    const keyframe = frame.keyframe === null ? null : this.keyframes.get(frame.keyframe);
    if (!keyframe || !keyframe[which]) return null;
    const {t, q} = keyframe[which];
    return transform(rotationOf(q), t, frame.pose.t);
  }

  // The positions of all frames, thinned for fluent drawing.
  path(which = 'pose') {
    const step = Math.ceil(this.frames.length / 4000) || 1;
    const path = [];
    for (let i = 0; i < this.frames.length; i += step) {
      path.push({at: i, p: this.position(this.frames[i], which),
                 segment: this.frames[i].segment});
    }
    return path;
  }

  largestMove(before) {
    return largest(before.map(({at, p}) => {
      const now = this.position(this.frames[at]);
      return p && now ? Math.hypot(p[0] - now[0], p[1] - now[1], p[2] - now[2]) : 0;
    }));
  }
}
