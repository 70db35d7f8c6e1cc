// The last minute of a few numbers, as lines.
const SECONDS = 60;

// [s]; a log that is shown has its own time.
export const time = {now: () => performance.now() / 1000};

export class Chart {
  constructor(parent, title, unit, digits, floor) {
    this.unit = unit;
    this.digits = digits;
    this.floor = floor;  // the scale ends there at least, so that noise does not look like drama
    this.samples = [];   // [seconds, value or null]
    const figure = document.createElement('figure');
    const caption = document.createElement('figcaption');
    this.value = document.createElement('b');
    caption.append(title, this.value);
    this.canvas = document.createElement('canvas');
    figure.append(caption, this.canvas);
    parent.append(figure);
    this.figure = figure;
  }

  hide() { this.figure.hidden = true; }  // until there is something to show

  add(value) {
    const now = time.now();
    this.samples = this.samples.filter(([at]) => at <= now);  // all but after a jump back
    this.figure.hidden = false;
    this.samples.push([now, Number.isFinite(value) ? value : null]);
    while (this.samples.length && this.samples[0][0] < now - SECONDS) this.samples.shift();
    this.value.textContent = Number.isFinite(value) ? `${value.toFixed(this.digits)} ${this.unit}` : '–';
  }

  draw(colour, faint) {
    const ratio = window.devicePixelRatio || 1;
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width) return;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    const known = this.samples.map(([, value]) => value).filter((value) => value !== null);
    const top = Math.max(this.floor, ...known) * 1.1;
    const bottom = Math.min(0, ...known);
    const now = time.now();
    const y = (value) => height - 1 - (height - 2) * (value - bottom) / (top - bottom);
    context.strokeStyle = faint;
    context.beginPath();
    context.moveTo(0, y(0));
    context.lineTo(width, y(0));
    context.stroke();
    context.strokeStyle = colour;
    context.lineWidth = 1.5;
    context.beginPath();
    let pen = false;
    for (const [at, value] of this.samples) {
      if (value === null) { pen = false; continue; }
      const x = width * (1 - (now - at) / SECONDS);
      if (pen) context.lineTo(x, y(value)); else context.moveTo(x, y(value));
      pen = true;
    }
    context.stroke();
  }
}
