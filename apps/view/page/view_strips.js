
// Plots in strips with a common time axis, and the status below.

const STATUS_COLORS = {ok: COLOR.green, degraded: COLOR.orange, lost: COLOR.vermillion};

class Strips {
  constructor(canvas, map) {
    this.canvas = canvas;
    this.map = map;
    new ResizeObserver(() => this.paint()).observe(canvas);
  }

  paint() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const context = this.context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    const frames = this.map.frames;
    if (frames.length === 0) return;
    const left = 12, right = width - 12;
    const begin = frames[0].t, end = Math.max(frames[frames.length - 1].t, begin + 1);
    this.x = t => left + (right - left) * (t - begin) / (end - begin);
    this.strip(frames, 24, 74, 'Tracking, ms per frame', frame => frame.ms, COLOR.blue);
    this.strip(frames, 104, 154, 'Inliers, % of matches',
        frame => (frame.matches ? 100 * frame.inliers / frame.matches : null),
        COLOR.purple, 100);
    // Draw worse statuses last and wider, to keep them visible.
    for (const status of ['ok', 'degraded', 'lost']) {
      context.fillStyle = STATUS_COLORS[status];
      frames.forEach((frame, i) => {
        if (frame.status !== status) return;
        const from = this.x(frame.t);
        const next = i + 1 < frames.length ? this.x(frames[i + 1].t) : from + 1;
        context.fillRect(from, 160, Math.max(status === 'ok' ? 1 : 1.5, next - from + 0.5), 6);
      });
    }
    this.text(`${digits(0, 1)} s`, left, 182, 'left');
    this.text(`${(frames[frames.length - 1].t - begin).toFixed(1)} s`, right, 182, 'right');
  }

  text(words, x, y, align, color = '#57606a') {
    const context = this.context;
    context.font = '12px system-ui, sans-serif';
    context.textAlign = align;
    context.fillStyle = color;
    context.fillText(words, x, y);
  }

  // Draws a curve between `top` and `bottom` for 0 to `most`. Where a pixel
  // column holds many frames, it covers their minimum to maximum.
  strip(frames, top, bottom, title, valueOf, color, most) {
    const context = this.context;
    const values = frames.map(valueOf);
    const high = most || 1.15 * quantileOf(values, 0.995) || 1;
    const columns = new Map();
    frames.forEach((frame, i) => {
      if (!known(values[i])) return;
      const x = Math.round(this.x(frame.t));
      const value = Math.min(values[i], high);
      const column = columns.get(x);
      if (column) {
        column[0] = Math.min(column[0], value);
        column[1] = Math.max(column[1], value);
      } else {
        columns.set(x, [value, value]);
      }
    });
    const y = value => bottom - (bottom - top) * value / high;
    context.strokeStyle = '#d8dee4';
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(12, bottom + 0.5);
    context.lineTo(this.canvas.clientWidth - 12, bottom + 0.5);
    context.stroke();
    context.strokeStyle = color;
    context.lineWidth = 1.4;
    context.beginPath();
    let down = false;
    for (const [x, [low, top2]] of [...columns].sort((a, b) => a[0] - b[0])) {
      context[down ? 'lineTo' : 'moveTo'](x, y(low));
      context.lineTo(x, y(top2));
      down = true;
    }
    context.stroke();
    this.text(title, 12, top - 8, 'left', '#1b1f24');
    this.text(`0 to ${digits(high, 2)}`, this.canvas.clientWidth - 12, top - 8,
        'right');
  }
}

function quantileOf(values, share) {
  const sorted = values.filter(known).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.floor(share * (sorted.length - 1))] : 0;
}
