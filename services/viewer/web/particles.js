// The particles: strokes that point where each looks, the heavier the darker. Thousands of soft strokes would cost more than
// all the rest of the picture, so a large cloud is drawn dot by dot into a picture of its own.
const LENGTH = 7;    // [px]
const SOFT = 1000;   // as many are still stroked softly
const GRADES = 4;    // of weight

function isOutside(view, px, py) { return px < -10 || py < -10 || px > view.width + 10 || py > view.height + 10; }

function stroke(context, view, {count, x, y, theta, weight}, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  for (let grade = 1; grade <= GRADES; ++grade) {  // one path for each grade
    context.globalAlpha = 0.2 * grade;
    context.beginPath();
    for (let i = 0; i < count; ++i) {
      if (Math.min(GRADES, 1 + Math.floor(weight[i] * GRADES)) !== grade) continue;
      const [px, py] = view.toScreen(x[i], y[i]);
      if (isOutside(view, px, py)) continue;
      context.moveTo(px, py);
      context.lineTo(px + LENGTH * Math.cos(theta[i]), py - LENGTH * Math.sin(theta[i]));
    }
    context.stroke();
  }
  context.globalAlpha = 1;
}

export class Particles {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.seen = {};
  }

  draw(context, view, cloud, colour) {
    if (cloud.count <= SOFT) { stroke(context, view, cloud, colour); return; }
    const key = [...view.centre, view.scale, view.canvas.width, view.canvas.height, colour].join();
    if (this.seen.cloud !== cloud || this.seen.key !== key) {
      this.seen = {cloud, key};
      this.dot(view, cloud, colour);
    }
    context.drawImage(this.canvas, 0, 0, view.width, view.height);
  }

  dot(view, {count, x, y, theta, weight}, colour) {
    const {width, height} = view.canvas;
    if (this.image?.width !== width || this.image?.height !== height) {
      Object.assign(this.canvas, {width, height});
      this.image = new ImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    } else this.pixels.fill(0);
    const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
    const ink = (blue << 16) | (green << 8) | red;
    const ratio = window.devicePixelRatio || 1;
    const steps = Math.round(LENGTH * ratio);
    for (let i = 0; i < count; ++i) {
      const [px, py] = view.toScreen(x[i], y[i]);
      if (isOutside(view, px, py)) continue;
      const [dx, dy] = [Math.cos(theta[i]), -Math.sin(theta[i])];
      const pixel = ink | (Math.round(50 + 205 * weight[i]) << 24);
      for (let step = 0; step <= steps; ++step) {
        const [column, row] = [Math.round(px * ratio + step * dx), Math.round(py * ratio + step * dy)];
        if (column >= 0 && row >= 0 && column < width && row < height) this.pixels[row * width + column] = pixel;
      }
    }
    this.canvas.getContext('2d').putImageData(this.image, 0, 0);
  }
}
