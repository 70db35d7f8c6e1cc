// A zone or a place that is being drawn: its shape, what it can be dragged by, and how it looks.
const ARROW_PX = 64;

// The points of a draft; a place has one, or none yet.
export const corners = ({what, item}) => (what === 'zone' ? item.polygon : item.x === undefined ? [] : [[item.x, item.y]]);

export function middleOf(draft) {
  const points = corners(draft);
  const mean = (i) => points.reduce((sum, point) => sum + point[i], 0) / Math.max(1, points.length);
  return [mean(0), mean(1)];
}

export function isInside(polygon, x, y) {
  let inside = false;
  polygon.forEach(([ax, ay], i) => {
    const [bx, by] = polygon.at(i - 1);
    if ((ay > y) !== (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) inside = !inside;
  });
  return inside;
}

// Whether two edges that are no neighbours meet.
export function crosses(polygon) {
  const side = ([ax, ay], [bx, by], [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  const n = polygon.length;
  for (let i = 0; i < n; ++i) {
    for (let k = i + 2; k < n; ++k) {
      if ((k + 1) % n === i) continue;
      const [a, b, c, d] = [polygon[i], polygon[(i + 1) % n], polygon[k], polygon[(k + 1) % n]];
      if (side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0) return true;
    }
  }
  return false;
}

const heading = ({what, item}) => (what === 'zone' ? (item.kind === 'one-way' ? item.direction : undefined) : item.theta);

// {x, y} on the screen, with the `key` of what it drags: a corner's number, or where `isNew` one comes to be.
export function gripsOf(draft, view) {
  const {what, item} = draft;
  const points = corners(draft);
  const at = ([x, y], key, more = {}) => { const [px, py] = view.toScreen(x, y); return {x: px, y: py, key, ...more}; };
  if (points.length === 0) return [];
  const middle = at(middleOf(draft), what === 'zone' ? 'all' : 'point');
  const grips = what === 'zone' ? points.map((point, i) => at(point, i)) : [middle];
  if (what === 'zone' && points.length > 2) {
    grips.push(middle);
    points.forEach(([x, y], i) => {
      const [u, v] = points[(i + 1) % points.length];
      grips.push(at([(x + u) / 2, (y + v) / 2], i + 1, {isNew: true}));
    });
  }
  const theta = heading(draft);
  if (theta !== undefined && (what === 'place' || item.polygon.length > 2)) {
    grips.push({x: middle.x + ARROW_PX * Math.cos(theta), y: middle.y - ARROW_PX * Math.sin(theta), key: 'turn'});
  }
  return grips;
}

function arrow(context, from, to) {
  const theta = Math.atan2(to.y - from.y, to.x - from.x);
  context.beginPath();
  context.moveTo(from.x, from.y);
  context.lineTo(to.x, to.y);
  for (const side of [-1, 1]) {
    context.moveTo(to.x, to.y);
    context.lineTo(to.x - 14 * Math.cos(theta + side * 0.5), to.y - 14 * Math.sin(theta + side * 0.5));
  }
  context.stroke();
}

export function drawDraft(context, view, draft, grips, colours) {
  const colour = draft.what === 'zone' && crosses(draft.item.polygon) ? colours.lost : colours.draft;
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2.5;
  if (draft.what === 'zone') {
    context.beginPath();
    for (const corner of draft.item.polygon) context.lineTo(...view.toScreen(...corner));
    context.closePath();
    context.globalAlpha = 0.2;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
  }
  const middle = grips.find(({key}) => key === 'all' || key === 'point');
  for (const grip of grips) {
    const {x, y, key, isNew} = grip;
    if (key === 'turn') { arrow(context, middle, grip); continue; }
    if (key === 'all') {
      context.beginPath();
      for (const [u, v] of [[9, 0], [0, 9]]) { context.moveTo(x - u, y - v); context.lineTo(x + u, y + v); }
      context.stroke();
      continue;
    }
    context.beginPath();
    context.arc(x, y, isNew ? 4 : 8, 0, 2 * Math.PI);
    context.fillStyle = isNew || key === draft.corner ? colour : colours.halo;
    context.fill();
    context.stroke();
  }
}
