import {translated} from './texts.js';

// What the marks on the map mean, with the colours of the theme that is on.
const rgb = ([red, green, blue]) => `rgb(${red}, ${green}, ${blue})`;

// Name of the layer -> [colour of a theme, shape of the mark, what it means].
export const MEANINGS = {
  walls: [(c) => rgb(c.tiles.wall), 'block', "walls of the building's map; magenta: the sonars doubt them"],
  evidence: [(c) => rgb(c.tiles.hit), 'block', 'what the sonars saw and no map knows; blue shade: they saw nothing there'],
  fixtures: [(c) => c.fixtureSeen, 'block', 'lamps on the ceiling: filled while the camera sees them, grey if unlit'],
  ceiling: [(c) => c.faint, 'box', 'vents, smoke detectors and the like'],
  zones: [(c) => c.keepOut, 'box', 'red: it never enters; amber: it drives slowly, one way or does not wander; pale: not at this hour'],
  places: [(c) => c.place, 'dot', 'places with a name: tap one to go there'],
  detections: [(c) => c.detection, 'box', 'what the camera takes for a lamp, where the robot believes to be; dashed: unlit'],
  particles: [(c) => c.particle, 'dot', 'guesses where the robot may be'],
  hypotheses: [(c) => c.hypothesis, 'ring', 'poses that explain all that was seen so far, with how likely each is'],
  sonar: [(c) => c.echo, 'arc', "the sonars' echoes of this moment"],
  survey: [(c) => c.tracking, 'ring', 'while a survey draws a new map: its lamps with how sure each is; dashed: not estimated yet; red: to be passed once more'],
  path: [(c) => c.path, 'line', 'the way that it drives; the pink ring is its goal'],
  forces: [(c) => c.attractive, 'line', 'what pulls it (green) and what pushes it away (red)'],
  trail: [(c) => c.trail, 'line', 'where it believes that it was'],
  odometry: [(c) => c.odometryTrail, 'dash', 'where its wheels alone say that it was'],
  truth: [(c) => c.truth, 'box', 'where the simulated robot truly is and was'],
  people: [(c) => c.person, 'ring', 'simulated people'],
};

const SHAPES = {
  block: (c) => c.fillRect(2, 3, 16, 10),
  box: (c) => c.strokeRect(3, 3.5, 14, 9),
  dot: (c) => { c.beginPath(); c.arc(10, 8, 4, 0, 7); c.fill(); },
  ring: (c) => { c.beginPath(); c.arc(10, 8, 5.5, 0, 7); c.stroke(); },
  arc: (c) => { c.beginPath(); c.arc(-2, 8, 14, -0.5, 0.5); c.stroke(); },
  line: (c) => { c.beginPath(); c.moveTo(1, 8); c.lineTo(19, 8); c.stroke(); },
  dash: (c) => { c.setLineDash([5, 3]); SHAPES.line(c); },
};

// A picture of one mark, 20 x 16 px.
export function mark(key, colours) {
  const ratio = window.devicePixelRatio || 1;
  const canvas = Object.assign(document.createElement('canvas'), {width: 20 * ratio, height: 16 * ratio, className: 'mark'});
  canvas.setAttribute('aria-hidden', 'true');
  const context = canvas.getContext('2d');
  context.scale(ratio, ratio);
  const [colour, shape] = MEANINGS[key];
  context.fillStyle = context.strokeStyle = colour(colours);
  context.lineWidth = 2.5;
  SHAPES[shape](context);
  return canvas;
}

// Fills the list of all marks.
export function explain(list, layers, colours) {
  list.replaceChildren(...layers.map(([key, label]) => {
    const line = document.createElement('li');
    line.append(mark(key, colours), Object.assign(document.createElement('b'), {textContent: translated(label)}), ` ${translated(MEANINGS[key][2])}`);
    return line;
  }));
}
