// What is drawn on the map, one function per layer, from the ground up.
import {hoursOf} from './names.js';

const RESTING = 0.35;  // share of its colour that is left of a zone outside its hours

export const LAYERS = [
  ['walls', 'Walls', true], ['evidence', 'Sonar evidence', true], ['fixtures', 'Light fixtures', true],
  ['ceiling', 'Vents and detectors', false], ['zones', 'Zones', true], ['places', 'Places', true], ['detections', 'Seen on the ceiling', true],
  ['particles', 'Particles', true], ['hypotheses', 'Hypotheses', true], ['sonar', 'Sonar beams', true],
  ['survey', 'Survey', true], ['path', 'Path and goal', true], ['forces', 'Forces', false], ['trail', 'Trail', true], ['odometry', 'Trail of the odometry', false],
  ['truth', 'Truth (simulation)', true], ['people', 'People (simulation)', true],
];

export function trace(context, view, points, close = false) {
  context.beginPath();
  points.forEach(([x, y], i) => {
    const [px, py] = view.toScreen(x, y);
    if (i === 0) context.moveTo(px, py); else context.lineTo(px, py);
  });
  if (close) context.closePath();
}

export function placed([x, y, theta], points) {
  const c = Math.cos(theta);
  const s = Math.sin(theta);
  return points.map(([u, v]) => [x + c * u - s * v, y + s * u + c * v]);
}

function box(length, width) {
  return [[length / 2, width / 2], [-length / 2, width / 2], [-length / 2, -width / 2], [length / 2, -width / 2]];
}

function disc(context, view, x, y, radius) {
  const [px, py] = view.toScreen(x, y);
  context.beginPath();
  context.arc(px, py, radius, 0, 2 * Math.PI);
}

export function isInView(view, [x, y], reach) {
  const [px, py] = view.toScreen(x, y);
  const margin = reach * view.scale;
  return px > -margin && py > -margin && px < view.width + margin && py < view.height + margin;
}

export function fixture(context, view, {shape, pose, length, width}) {
  if (shape === 'round') disc(context, view, pose[0], pose[1], length / 2 * view.scale);
  else trace(context, view, placed(pose, box(length, width)), true);
}

export function drawFixtures(context, view, building, colours) {
  context.lineWidth = 1;
  context.fillStyle = colours.fixture;
  context.strokeStyle = colours.fixtureEdge;
  for (const known of building.fixtures) {
    if (!isInView(view, known.pose, known.length)) continue;
    fixture(context, view, known);
    context.fill();
    if (known.width * view.scale > 2) context.stroke();  // from afar there would be nothing but edges
  }
}

// The known fixtures that are seen now: bright where lit, grey where unlit.
export function drawSeenFixtures(context, view, building, seen, colours) {
  context.lineWidth = 1.5;
  context.strokeStyle = colours.fixtureEdge;
  for (const found of seen) {
    const known = building.fixtures.find(({pose}) => Math.hypot(found.world[0] - pose[0], found.world[1] - pose[1]) < 0.6);
    if (!known) continue;
    fixture(context, view, known);
    context.fillStyle = found.state === 2 ? colours.fixtureUnlit : colours.fixtureSeen;
    context.fill();
    context.stroke();
  }
}

export function drawCeiling(context, view, building, colours) {
  context.strokeStyle = colours.faint;
  context.lineWidth = 1;
  for (const element of building.elements) {
    if (element.kind === 'detector') disc(context, view, element.pose[0], element.pose[1], element.length / 2 * view.scale);
    else trace(context, view, placed(element.pose, box(element.length, element.width)), true);
    context.stroke();
  }
}

// An arrow in the middle of a one-way zone.
function drawDirection(context, view, {polygon, direction}) {
  const mean = (i) => polygon.reduce((sum, corner) => sum + corner[i], 0) / polygon.length;
  trace(context, view, placed([mean(0), mean(1), direction], [[-0.4, 0], [0.4, 0], [0.15, 0.2], [0.4, 0], [0.15, -0.2]]));
  context.stroke();
}

export function drawZones(context, view, building, colours) {
  context.font = '12px system-ui, sans-serif';
  context.textAlign = 'left';
  context.lineWidth = 2;
  for (const zone of building.zones) {
    const colour = zone.kind === 'keep-out' ? colours.keepOut : colours.slowZone;
    const strength = zone.in_force === false ? RESTING : 1;
    trace(context, view, zone.polygon, true);
    context.globalAlpha = 0.15 * strength;
    context.fillStyle = colour;
    context.fill();
    context.globalAlpha = strength;
    context.strokeStyle = colour;
    context.stroke();
    context.globalAlpha = 1;
    if (view.scale < 12) continue;
    if (zone.kind === 'one-way') drawDirection(context, view, zone);
    const [px, py] = view.toScreen(Math.min(...zone.polygon.map(([x]) => x)), Math.max(...zone.polygon.map(([, y]) => y)));
    context.fillStyle = colour;
    context.fillText(zone.name, px + 4, py + 14);
    context.fillText(hoursOf(zone), px + 4, py + 28);
  }
}

export function drawPlaces(context, view, building, colours) {
  context.font = '12px system-ui, sans-serif';
  context.textAlign = 'center';
  const written = [];  // no name over another's: who wants to read them all comes nearer
  for (const place of building.places) {
    const [px, py] = view.toScreen(place.x, place.y);
    context.fillStyle = colours.place;
    context.beginPath();
    context.arc(px, py, 3.5, 0, 2 * Math.PI);
    context.fill();
    if (view.scale < 12) continue;
    context.lineWidth = 3;
    context.strokeStyle = colours.halo;
    const half = context.measureText(place.name).width / 2 + 4;
    const middle = px < 0 || px > view.width ? px : Math.min(Math.max(px, half), view.width - half);
    if (written.some(([x, y, reach]) => Math.abs(x - middle) < reach + half && Math.abs(y - py) < 14)) continue;
    written.push([middle, py, half]);
    context.strokeText(place.name, middle, py - 8);
    context.fillText(place.name, middle, py - 8);
  }
}

export function drawDetections(context, view, seen, colours) {
  context.lineWidth = 2;
  context.strokeStyle = colours.detection;
  for (const found of seen) {
    if (found.shape === 3) continue;  // another element of the ceiling
    if (found.has_theta) trace(context, view, placed(found.world, box(found.length, found.width)), true);
    else disc(context, view, found.world[0], found.world[1], found.length / 2 * view.scale);
    context.setLineDash(found.state === 2 ? [4, 3] : []);  // dashed: unlit
    context.stroke();
  }
  context.setLineDash([]);
}

export function drawHypotheses(context, view, hypotheses, colours) {
  for (const [x, y, theta, weight, sigma] of hypotheses) {
    const [px, py] = view.toScreen(x, y);
    context.globalAlpha = 0.25 + 0.75 * Math.sqrt(weight);
    context.strokeStyle = colours.hypothesis;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(px, py, Math.max(8, 2 * sigma * view.scale), 0, 2 * Math.PI);
    context.moveTo(px, py);
    context.lineTo(px + 18 * Math.cos(theta), py - 18 * Math.sin(theta));
    context.stroke();
    if (hypotheses.length > 1 && weight > 0.03) {
      context.fillStyle = colours.hypothesis;
      context.font = '11px system-ui, sans-serif';
      context.textAlign = 'left';
      context.fillText(`${Math.round(weight * 100)} %`, px + 12, py + 14);
    }
  }
  context.globalAlpha = 1;
}

export function drawSonar(context, view, pose, sonar, robot, colours) {
  context.lineWidth = 1.5;
  robot.sonars.forEach((mount, i) => {
    const range = sonar.ranges[i];
    if (range == null) return;
    const [origin] = placed(pose, [[mount[0], mount[1]]]);
    const heading = pose[2] + mount[2];
    const [px, py] = view.toScreen(...origin);
    context.globalAlpha = Math.max(0.08, 1 - sonar.ages[i]);
    context.beginPath();
    context.moveTo(px, py);
    context.arc(px, py, range * view.scale, -heading - robot.sonar_half_angle, -heading + robot.sonar_half_angle);
    context.closePath();
    context.fillStyle = colours.sonar;
    context.fill();
    context.beginPath();
    context.arc(px, py, range * view.scale, -heading - robot.sonar_half_angle, -heading + robot.sonar_half_angle);
    context.strokeStyle = colours.echo;
    context.stroke();
  });
  context.globalAlpha = 1;
}

export function drawTrail(context, view, points, colour, dash = []) {
  if (points.length < 2) return;
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.setLineDash(dash);
  context.beginPath();
  let pen = false;
  for (const point of points) {
    if (!point) { pen = false; continue; }  // a gap: it was lost, or carried
    const [px, py] = view.toScreen(point[0], point[1]);
    if (pen) context.lineTo(px, py); else context.moveTo(px, py);
    pen = true;
  }
  context.stroke();
  context.setLineDash([]);
}

export function drawPath(context, view, path, navigation, control, colours) {
  if (path?.points.length > 1) {
    trace(context, view, path.points);
    context.lineCap = context.lineJoin = 'round';
    context.lineWidth = 7;
    context.strokeStyle = colours.pathHalo;
    context.stroke();
    context.lineWidth = 2.5;
    context.strokeStyle = colours.path;
    context.stroke();
    context.lineJoin = 'miter';
    context.lineCap = 'butt';
  }
  if (navigation?.target && ![0, 5, 9].includes(navigation.state)) drawGoal(context, view, navigation.target, colours.goal);
  if (control?.look_ahead && control.state === 2) {
    disc(context, view, ...control.look_ahead, 5);
    context.fillStyle = colours.path;
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = colours.halo;
    context.stroke();
  }
}

// A ring, with a knob where the heading points to.
export function drawGoal(context, view, [x, y, theta], colour, knob = 0) {
  const [px, py] = view.toScreen(x, y);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(px, py, 11, 0, 2 * Math.PI);
  context.stroke();
  context.beginPath();
  context.arc(px, py, 3, 0, 2 * Math.PI);
  context.fill();
  if (theta === undefined && !knob) return;
  const reach = knob || 24;
  const [hx, hy] = [px + reach * Math.cos(theta ?? 0), py - reach * Math.sin(theta ?? 0)];
  context.globalAlpha = theta === undefined ? 0.5 : 1;
  context.beginPath();
  context.moveTo(px + 11 * Math.cos(theta ?? 0), py - 11 * Math.sin(theta ?? 0));
  context.lineTo(hx, hy);
  context.stroke();
  context.beginPath();
  context.arc(hx, hy, knob ? 8 : 4, 0, 2 * Math.PI);
  context.fill();
  context.globalAlpha = 1;
}

export function drawForces(context, view, pose, control, colours) {
  const arrow = ([u, v], colour) => {
    const [tip] = placed(pose, [[u, v]]);
    trace(context, view, [[pose[0], pose[1]], tip]);
    context.strokeStyle = colour;
    context.lineWidth = 3;
    context.stroke();
  };
  arrow(control.attractive, colours.attractive);
  arrow(control.repulsive, colours.repulsive);
}

// 95 % of the position's distribution: chi-square of two degrees of freedom, 5.99.
export function drawCovariance(context, view, pose, covariance, colour) {
  const [a, b, c] = [covariance[0], covariance[1], covariance[4]];
  const mean = (a + c) / 2;
  const spread = Math.hypot((a - c) / 2, b);
  if (!(mean + spread < 25)) return;  // a circle larger than the screen says nothing
  const [px, py] = view.toScreen(pose[0], pose[1]);
  context.beginPath();
  context.ellipse(px, py, Math.sqrt(5.99 * (mean + spread)) * view.scale,
    Math.sqrt(5.99 * Math.max(0, mean - spread)) * view.scale, -0.5 * Math.atan2(2 * b, a - c), 0, 2 * Math.PI);
  context.globalAlpha = 0.25;
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.stroke();
}

export function drawRobot(context, view, pose, robot, colour, halo, isSolid) {
  const points = placed(pose, robot.footprint);
  trace(context, view, points, true);
  context.lineWidth = 2;
  if (isSolid) {
    context.fillStyle = colour;
    context.fill();
    context.strokeStyle = halo;
  } else {
    context.strokeStyle = colour;
  }
  context.stroke();
  const front = Math.max(...robot.footprint.map(([x]) => x));
  trace(context, view, placed(pose, [[0.1 * front, 0.55 * front], [0.85 * front, 0], [0.1 * front, -0.55 * front]]));
  context.strokeStyle = isSolid ? '#fff' : colour;
  context.stroke();
  if (view.scale * 0.5 < 10) {  // far away: still to be found
    const [px, py] = view.toScreen(pose[0], pose[1]);
    context.beginPath();
    context.arc(px, py, 9, 0, 2 * Math.PI);
    context.strokeStyle = colour;
    context.stroke();
  }
}

export function drawPeople(context, view, people, colours) {
  for (const [x, y] of people) {
    disc(context, view, x, y, Math.max(4, 0.25 * view.scale));
    context.fillStyle = colours.person;
    context.fill();
    disc(context, view, x, y, Math.max(2, 0.1 * view.scale));
    context.fillStyle = colours.halo;
    context.fill();
  }
}
