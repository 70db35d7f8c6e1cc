// The window onto the world: pan by dragging, zoom by wheel or two fingers, taps in world coordinates.
const TAP_PX = 6;
const ON_GRIP_PX = 12;  // a tap that near means the grip, one farther off the map beside it

export class MapView extends EventTarget {
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.centre = [0, 0];  // [m]
    this.scale = 30;       // [px/m]
    this.pointers = new Map();
    this.handle = null;    // {x, y} on the screen: a drag that begins there is a 'handle' event, not a pan
    this.grips = [];       // the same for many: each {x, y} of them is handed on in a 'grip' event
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.up(event));
    // else a click follows the tap, and hits the button that the tap has just brought up under the finger
    canvas.addEventListener('touchend', (event) => event.preventDefault(), {passive: false});
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, {passive: false});
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.dispatchEvent(new Event('resize'));
    this.changed();
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.centre[0]) * this.scale, this.height / 2 - (y - this.centre[1]) * this.scale];
  }

  toWorld(px, py) {
    return [this.centre[0] + (px - this.width / 2) / this.scale, this.centre[1] - (py - this.height / 2) / this.scale];
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toWorld(px, py);
    this.scale = Math.min(400, Math.max(2, this.scale * factor));
    const [newX, newY] = this.toWorld(px, py);
    this.centre = [this.centre[0] + x - newX, this.centre[1] + y - newY];
    this.changed();
  }

  // By pixels of the screen, to the right and up.
  pan(right, up) {
    this.centre = [this.centre[0] + right / this.scale, this.centre[1] + up / this.scale];
    this.dispatchEvent(new Event('pan'));
    this.changed();
  }

  fit([left, bottom, right, top]) {
    this.centre = [(left + right) / 2, (bottom + top) / 2];
    this.scale = Math.min(400, Math.max(2, 0.94 * Math.min(this.width / (right - left), this.height / (top - bottom))));
    this.changed();
  }

  down(event) {
    if (event.button > 0) return;
    this.canvas.setPointerCapture(event.pointerId);
    const {offsetX: x, offsetY: y} = event;
    this.pointers.set(event.pointerId, {x, y});
    const reach = event.pointerType === 'mouse' ? 16 : 30;
    const far = ({x: u, y: v}) => Math.hypot(x - u, y - v);
    this.grip = this.grips.filter((grip) => far(grip) < reach).sort((a, b) => far(a) - far(b))[0];
    this.gesture = this.pointers.size > 1 ? 'pinch' : this.grip ? 'grip'
      : this.handle && Math.hypot(x - this.handle.x, y - this.handle.y) < reach ? 'handle' : 'tap';
    this.start = {x, y};
    this.isPulled = false;
  }

  // A finger is thick: what is not pulled was a tap beside the grip, unless it is right on it.
  letGo(x, y) {
    const {grip} = this;
    const isOnIt = !grip.isNew && Math.hypot(x - grip.x, y - grip.y) < ON_GRIP_PX;
    if (isOnIt) this.dispatchEvent(new CustomEvent('grip', {detail: {grip, at: this.toWorld(grip.x, grip.y)}}));
    else this.dispatchEvent(new CustomEvent('tap', {detail: this.toWorld(x, y)}));
  }

  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const {offsetX: x, offsetY: y} = event;
    if (this.gesture === 'tap' && Math.hypot(x - this.start.x, y - this.start.y) > TAP_PX) {
      this.gesture = 'pan';
      this.dispatchEvent(new Event('pan'));
    }
    this.isPulled ||= Math.hypot(x - this.start.x, y - this.start.y) > TAP_PX;
    if (this.gesture === 'grip') {
      if (this.isPulled) this.dispatchEvent(new CustomEvent('grip', {detail: {grip: this.grip, at: this.toWorld(x, y)}}));
    } else if (this.gesture === 'handle') {
      this.dispatchEvent(new CustomEvent('handle', {detail: this.toWorld(x, y)}));
    } else if (this.gesture === 'pan') {
      this.centre = [this.centre[0] - (x - pointer.x) / this.scale, this.centre[1] + (y - pointer.y) / this.scale];
    } else if (this.gesture === 'pinch') {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
        const after = Math.hypot(x - other.x, y - other.y);
        this.centre = [this.centre[0] - (x - pointer.x) / 2 / this.scale, this.centre[1] + (y - pointer.y) / 2 / this.scale];
        if (before > 0) this.zoom(after / before, (x + other.x) / 2, (y + other.y) / 2);
      }
    }
    pointer.x = x;
    pointer.y = y;
    this.changed();
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.gesture === 'tap' && event.type === 'pointerup') {
      this.dispatchEvent(new CustomEvent('tap', {detail: this.toWorld(event.offsetX, event.offsetY)}));
    }
    if (this.gesture === 'grip' && event.type === 'pointerup' && !this.isPulled) this.letGo(event.offsetX, event.offsetY);
    if (this.pointers.size === 0) this.gesture = null;
    else if (this.gesture === 'pinch') this.gesture = 'pan';
  }

  changed() { this.dispatchEvent(new Event('change')); }
}
