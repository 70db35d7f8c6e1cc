// The part of the picture that changes seldom. Painted with a margin around the view, so that dragging only moves it.
const MARGIN = 256;  // [px]

export class Ground {
  constructor(view, paint) {
    this.view = view;
    this.paint = paint;  // (context, window): draws what `window` looks at, which has the methods and sizes of a view
    this.canvas = document.createElement('canvas');
    this.painted = null;  // the window it was painted for
  }

  change() { this.painted = null; }

  draw() {
    const {view} = this;
    const ratio = window.devicePixelRatio || 1;
    if (!this.fits()) this.repaint(ratio);
    // whole pixels, or all would be blurred
    const [right, down] = this.shift().map((shift) => Math.round(shift * ratio) / ratio);
    view.context.drawImage(this.canvas, right - MARGIN, down - MARGIN, this.painted.width, this.painted.height);
  }

  // [px] by how much what was in the middle then has moved since.
  shift() {
    const {view, painted} = this;
    return [(painted.centre[0] - view.centre[0]) * view.scale, (view.centre[1] - painted.centre[1]) * view.scale];
  }

  fits() {
    const {view, painted} = this;
    return painted && painted.scale === view.scale && painted.width === view.width + 2 * MARGIN
      && painted.height === view.height + 2 * MARGIN && this.shift().every((shift) => Math.abs(shift) <= MARGIN);
  }

  repaint(ratio) {
    const {view, canvas} = this;
    this.painted = {centre: [...view.centre], scale: view.scale, width: view.width + 2 * MARGIN,
      height: view.height + 2 * MARGIN, toScreen: view.toScreen};
    const [width, height] = [Math.round(this.painted.width * ratio), Math.round(this.painted.height * ratio)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    const context = canvas.getContext('2d', {alpha: false});
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.paint(context, this.painted);
  }
}
