// Where the robot was: as it believed, in truth, and by its odometry alone.
const LONGEST = 4000;  // points

function extend(points, x, y, isKnown) {
  const last = points.at(-1);
  if (!isKnown) { if (last) points.push(null); return; }
  const step = last ? Math.hypot(x - last[0], y - last[1]) : Infinity;
  if (step < 0.04) return;
  if (last && step > 1.5) points.push(null);  // carried, or corrected
  points.push([x, y]);
  if (points.length > LONGEST) points.shift();
}

export class Trails {
  constructor() { this.clear(); }

  clear() {
    this.pose = [];
    this.truth = [];
    this.odometry = [];
    this.anchor = null;  // {session, x, y, theta}: world_from_odom when the robot first knew where it was
  }

  extend({pose, truth, odometry, ages}, stale) {
    const isKnown = pose?.state === 2;
    if (pose && ages.POSE < stale) extend(this.pose, pose.x, pose.y, isKnown);
    if (truth && ages.SIM_TRUTH < stale) extend(this.truth, truth.x, truth.y, !truth.carried);
    if (!odometry || !(ages.ODOMETRY < stale)) return;
    if (this.anchor?.session !== odometry.session) this.anchor = isKnown ? this.anchorAt(pose, odometry) : null;
    if (!this.anchor) return;
    const {x, y, theta} = this.anchor;
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    extend(this.odometry, x + c * odometry.x - s * odometry.y, y + s * odometry.x + c * odometry.y, true);
  }

  anchorAt(pose, odometry) {
    const theta = pose.theta - odometry.theta;
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    this.odometry.push(null);
    return {session: odometry.session, theta, x: pose.x - c * odometry.x + s * odometry.y,
      y: pose.y - s * odometry.x - c * odometry.y};
  }
}
