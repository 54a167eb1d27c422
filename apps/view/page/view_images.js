
// The current image with its matches, and its depth image.

// Plasma without its darkest part, as in the images of --debug_images.
const WEIGHT_COLORS = ['#7e03a8', '#a82296', '#cb4679', '#e56b5d', '#f89441', '#fdc328',
                       '#f0f921'];
// Viridis, from near to far.
const DEPTH_COLORS = ['#fde725', '#90d743', '#35b779', '#21918c', '#31688e', '#443983',
                      '#440154'];

function rgbOf(hex) {
  return [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16));
}

// The colour at a position from 0 to 1 in a list of colours.
function colorAt(colors, share) {
  const place = Math.min(1, Math.max(0, share)) * (colors.length - 1);
  const low = Math.min(colors.length - 2, Math.floor(place));
  const a = rgbOf(colors[low]), b = rgbOf(colors[low + 1]);
  return a.map((value, k) => Math.round(value + (place - low) * (b[k] - value)));
}

function gradientOf(colors) {
  return `linear-gradient(90deg, ${colors.join(', ')})`;
}

const WEIGHT_STEPS = [...Array(32).keys()].map(
    i => `rgb(${colorAt(WEIGHT_COLORS, i / 31).join(',')})`);

class Images {
  constructor(image, depth) {
    this.image = image;
    this.depth = depth;
    this.far = 2;  // m; grows with the depths seen
    document.querySelector('.bar.weights').style.background = gradientOf(WEIGHT_COLORS);
    document.querySelector('.bar.depths').style.background = gradientOf(DEPTH_COLORS);
  }

  // Shows the images of an event; skipped while the previous ones are decoded.
  async show(event) {
    if (this.busy) return;
    this.busy = true;
    try {
      const [gray, depth] = await Promise.all(
          [['jpeg', event.gray], ['png', event.depth]].map(async ([kind, base64]) => {
            const picture = new Image();
            picture.src = `data:image/${kind};base64,${base64}`;
            await picture.decode();
            return picture;
          }));
      this.paintImage(gray, event);
      this.paintDepth(depth, event.depth_step);
    } finally {
      this.busy = false;
    }
  }

  paintImage(picture, event) {
    const canvas = this.image, context = canvas.getContext('2d');
    canvas.width = 640;
    canvas.height = Math.round(640 * event.height / event.width);
    canvas.style.aspectRatio = `${event.width} / ${event.height}`;
    context.filter = 'brightness(0.62)';
    context.drawImage(picture, 0, 0, canvas.width, canvas.height);
    context.filter = 'none';
    const scale = canvas.width / event.width;
    // Draws the best matches on top.
    const matches = event.matches.slice().sort((a, b) => a[4] - b[4]);
    context.lineWidth = 1.3;
    for (const [u0, v0, u1, v1, weight] of matches) {
      const color = weight < 0 ? '#c8c8c8' : WEIGHT_STEPS[Math.round(31 * weight)];
      context.strokeStyle = context.fillStyle = color;
      context.beginPath();
      context.moveTo(scale * u0, scale * v0);
      context.lineTo(scale * u1, scale * v1);
      context.stroke();
      context.beginPath();
      context.arc(scale * u1, scale * v1, 2.4, 0, 2 * Math.PI);
      context.fill();
    }
    document.getElementById('image-text').textContent =
        `Image ${event.index} and its ${event.matches.length} matches`;
  }

  paintDepth(picture, step) {
    const canvas = this.depth;
    const context = canvas.getContext('2d', {willReadFrequently: true});
    canvas.width = picture.width;
    canvas.height = picture.height;
    canvas.style.aspectRatio = `${picture.width} / ${picture.height}`;
    context.drawImage(picture, 0, 0);
    const image = context.getImageData(0, 0, canvas.width, canvas.height);
    const counts = new Uint32Array(256);
    for (let i = 0; i < image.data.length; i += 4) ++counts[image.data[i]];
    const known = canvas.width * canvas.height - counts[0];
    let below = 0, value = 1;
    while (value < 255 && (below += counts[value]) < 0.98 * known) ++value;
    this.far = Math.max(this.far, Math.ceil(value * step));
    const table = [...Array(256).keys()].map(
        v => (v === 0 ? SCENE.ground : colorAt(DEPTH_COLORS, v * step / this.far)));
    for (let i = 0; i < image.data.length; i += 4) {
      const color = table[image.data[i]];
      image.data[i] = color[0];
      image.data[i + 1] = color[1];
      image.data[i + 2] = color[2];
    }
    context.putImageData(image, 0, 0);
    document.getElementById('far').textContent = `${this.far} m`;
  }
}
