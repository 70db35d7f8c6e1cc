// What keys do. STOP comes first: space and X, wherever the focus is, but for what is written or toggled with them.
const TAKES_SPACE = 'input, textarea, select, summary';
const TAKES_LETTERS = 'input[type=search], input[type=text], textarea';
const CLICK_MS = 500;  // a click comes that soon after its pointer, and a label's box after the label
const PAN_PX = 60;
const PANS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};

// `press(code)`: with that key.
export function listenForStop(press) {
  const isStop = (event) => {
    const {target} = event;
    if (event.code === 'KeyX') return !(event.ctrlKey || event.metaKey || event.altKey || target.closest?.(TAKES_LETTERS));
    return event.code === 'Space' && !target.closest?.(TAKES_SPACE);
  };
  addEventListener('keydown', (event) => {
    if (!isStop(event)) return;
    event.preventDefault();
    if (!event.repeat) press(event.code);
  }, true);
  addEventListener('keyup', (event) => { if (event.code === 'Space' && isStop(event)) event.preventDefault(); }, true);  // presses no button
  // What was clicked gives the focus back: the next space is a STOP, not the same box once more.
  // At once: a timer would come behind a key that waits already.
  let released = -Infinity;  // [ms] when finger or mouse let go
  addEventListener('pointerup', (event) => { released = event.timeStamp; }, true);
  addEventListener('click', (event) => {
    const held = document.activeElement;
    if (event.timeStamp - released < CLICK_MS && held?.matches?.('button, input[type=checkbox], summary')) held.blur();
  });
}

// Arrows move the map, + and - zoom, Enter chooses its middle. `isSteering()`: the arrows are the robot's.
export function listenOnMap(view, {choose, fit, isSteering}) {
  view.canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const pan = PANS[event.key];
    if (pan && isSteering()) return;
    if (pan) view.pan(pan[0] * PAN_PX, pan[1] * PAN_PX);
    else if (event.key === '+' || event.key === '=') view.zoom(1.4);
    else if (event.key === '-') view.zoom(1 / 1.4);
    else if (event.key === 'Home') fit();
    else if (event.key === 'Enter') choose(...view.centre);
    else return;
    event.preventDefault();
  });
  for (const change of ['focus', 'blur']) view.canvas.addEventListener(change, () => view.changed());
}

// Where Enter would choose; only for who came with the keyboard.
export function drawCrosshair(context, view, colour) {
  if (!view.canvas.matches(':focus-visible')) return;
  const [x, y] = [view.width / 2, view.height / 2];
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  for (const [u, v] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 5 * u, y + 5 * v);
    context.lineTo(x + 16 * u, y + 16 * v);
  }
  context.stroke();
}
