import {t} from './texts.js';

// The camera's picture with what was found in it: rectangle green, pose blue, as in the paper.
const GREEN = '#22c55e';
const BLUE = '#3b82f6';
const OLD_S = 2;  // several pictures did not come

export class Picture {
  constructor(canvas, caption, none) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.caption = caption;
    this.none = none;
    this.isLoading = false;
    this.isOld = false;
    // nobody looks: nothing is fetched
    this.isVisible = true;
    new IntersectionObserver(([entry]) => { this.isVisible = entry.isIntersecting; }).observe(canvas.parentElement);
  }

  // A picture that stays looks so.
  watch(ages) {
    const age = ages.CAMERA_IMAGE;
    this.isOld = age > OLD_S;
    this.canvas.classList.toggle('old', this.isOld);
    if (this.isOld && !this.canvas.hidden) this.caption.textContent = t`picture is ${Math.round(age)} s old`;
  }

  async show(about) {
    if (this.isLoading || !this.isVisible || document.hidden) return;
    this.isLoading = true;
    try {
      const answer = await fetch(`camera.jpg?sequence=${about.sequence}`);
      if (answer.ok) this.draw(await createImageBitmap(await answer.blob()), about);
      else if (answer.status === 404) await this.showNewest();
    } catch { /* the next one comes in half a second */ } finally {
      this.isLoading = false;
    }
  }

  // A link so slow that the picture was gone before it was asked for: another one, without what was found in that one.
  async showNewest() {
    const answer = await fetch('camera.jpg');
    if (!answer.ok) return;
    this.paint(await createImageBitmap(await answer.blob()));
    this.caption.textContent = t`the link is slow: what was found is not shown`;
  }

  paint(bitmap) {
    this.canvas.hidden = false;
    this.none.hidden = true;
    this.canvas.width = bitmap.width;
    this.canvas.height = bitmap.height;
    this.context.drawImage(bitmap, 0, 0);
  }

  draw(bitmap, about) {
    this.paint(bitmap);
    const seen = about.seen?.detections ?? [];
    for (const found of seen) if (found.shape !== 3) this.outline(found);
    const lights = seen.filter((found) => found.shape !== 3);
    const lit = lights.filter((found) => found.state === 1).length;
    const count = lights.length === 1 ? t`1 fixture` : t`${lights.length} fixtures`;
    this.caption.textContent = `${about.seen ? t`${count}, ${lit} lit` : t`no detector`} · ` +
      `${(about.exposure_us / 1000).toFixed(1)} ms${about.health ? ` · ${about.health}` : ''}`;
  }

  outline(found) {
    const corners = [0, 2, 4, 6].map((i) => [found.corners_px[i], found.corners_px[i + 1]]);
    const context = this.context;
    context.lineWidth = 3;
    context.strokeStyle = GREEN;
    context.setLineDash(found.clipped ? [10, 6] : []);
    context.beginPath();
    corners.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
    context.stroke();
    context.setLineDash([]);
    const [cx, cy] = found.centre_px;
    context.strokeStyle = context.fillStyle = BLUE;
    context.beginPath();
    context.arc(cx, cy, 6, 0, 2 * Math.PI);
    context.fill();
    if (!found.has_theta) return;
    // the axis: the middle of the shorter side that lies farther along
    const sides = corners.map((corner, i) => [corner, corners[(i + 1) % 4]]);
    const length = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]);
    const [a, b] = sides.reduce((shortest, side) => (length(side) < length(shortest) ? side : shortest));
    context.lineWidth = 4;
    context.beginPath();
    context.moveTo(cx, cy);
    context.lineTo((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
    context.stroke();
  }
}
