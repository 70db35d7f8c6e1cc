// frame_rate.mjs SOURCE FOLDER: how smooth the page is with a map of 4000 x 4000 cells and 5,000 particles, and how soon it
// shows something, in a headless browser that draws in software. FOLDER holds playwright-core. Prints frames per second
// while a hand drags the map and while it lies still, from near and from afar. Needs no robot: it feeds the page itself.
import {readdirSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {userInfo} from 'node:os';
import {deflateSync} from 'node:zlib';

const [source, folder] = process.argv.slice(2);
const web = `${source}/services/viewer/web`;
const COLUMNS = 4000;
const RESOLUTION = 0.05;
const PARTICLES = 5000;
const types = {html: 'text/html', css: 'text/css', js: 'text/javascript', svg: 'image/svg+xml'};

// Rooms of six metres with doors, some sonar evidence in each.
function tile(column, row) {
  const bytes = new Uint8Array(2 * 64 * 64);
  for (let y = 0; y < 64; ++y) {
    for (let x = 0; x < 64; ++x) {
      const [u, v] = [(64 * column + x) % 120, (64 * row + y) % 120];
      bytes[64 * y + x] = (u < 4 && (v < 50 || v > 70)) || (v < 4 && (u < 50 || u > 70)) ? 2 : 1;
      bytes[4096 + 64 * y + x] = (u * 7 + v * 13) % 97 < 3 ? 60 : (u + v) % 50 < 20 ? 216 : 0;
    }
  }
  return {session: 1, revision: 1, resolution: RESOLUTION, origin: [0, 0], columns: COLUMNS, rows: COLUMNS, tile_column: column,
    tile_row: row, data: deflateSync(bytes).toString('base64')};
}

function hypotheses(round) {
  const bytes = Buffer.alloc(6 * PARTICLES);
  for (let i = 0; i < PARTICLES; ++i) {
    bytes.writeInt16LE(((i * 7919 + round * 31) % 18000) - 9000, 6 * i);
    bytes.writeInt16LE(((i * 104729 + round * 17) % 18000) - 9000, 6 * i + 2);
    bytes.writeUInt8((i * 37) % 256, 6 * i + 4);
    bytes.writeUInt8((i * 91) % 256, 6 * i + 5);
  }
  return {utime: 1, hypotheses: [[100, 100, 0.5, 1, 0.3]], particle_count: PARTICLES, origin: [100, 100],
    particles: bytes.toString('base64')};
}

const building = {name: 'large', ceiling_height: 2.8, elements: [], doors: [], windows: [], zones: [], places: [],
  fixtures: Array.from({length: 2000}, (_, i) => ({id: i, shape: 'rectangle', pose: [2 + 4.4 * (i % 45), 2 + 4.4 * Math.floor(i / 45), 0],
    length: 1.2, width: 0.3})),
  robot: {name: 'p3dx', footprint: [[0.21, -0.21], [0.21, 0.21], [-0.3, 0.21], [-0.3, -0.21]], sonars: [], sonar_half_angle: 0.26,
    sonar_maximum_range: 5, maximum_linear: 0.5, maximum_angular: 1}};

function stateAt(round) {
  const covariance = [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01];
  return {utime: 1000 * Date.now(), ages: {POSE: 0.02, ROBOT_STATUS: 0.02}, requests: [],
    pose: {utime: 1, state: 1, reason: 'measuring', x: 100 + 0.02 * round, y: 100, theta: 0, covariance, distance_since_fixture: 0,
      nis: 1}};
}

const tiles = [];
for (let row = 0; row * 64 < COLUMNS; ++row) for (let column = 0; column * 64 < COLUMNS; ++column) tiles.push(tile(column, row));

const server = createServer((request, response) => {
  const path = request.url === '/' ? '/index.html' : request.url.split('?')[0];
  if (path === '/events') {
    response.writeHead(200, {'Content-Type': 'text/event-stream'});
    const send = (name, data) => response.write(`event: ${name}\ndata: ${JSON.stringify(data)}\n\n`);
    let round = 0;
    const timer = setInterval(() => {
      send('state', stateAt(++round));
      if (round % 2 === 0) send('hypotheses', hypotheses(round));
      for (const next of tiles.slice(100 * (round - 1), 100 * round)) send('tile', next);
    }, 100);
    request.on('close', () => clearInterval(timer));
  } else if (path === '/building.json') response.end(JSON.stringify(building));
  else if (path === '/api/watch') response.end('{"may_command":true}');
  else if (path === '/settings.json') response.end('{"command_port":1,"needs_token":false}');
  else if (readdirSync(web).includes(path.slice(1))) {
    response.writeHead(200, {'Content-Type': types[path.split('.').at(-1)]});
    response.end(readFileSync(web + path));
  } else {
    response.writeHead(404);
    response.end();
  }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));

const {chromium} = createRequire(`${folder}/`)('playwright-core');
const browser = await chromium.launch({executablePath: process.env.LUMINAV_CHROMIUM ?? '/usr/bin/chromium',
  args: userInfo().uid === 0 ? ['--no-sandbox'] : []});
const page = await browser.newPage({viewport: {width: 1440, height: 900}});
page.on('pageerror', (error) => console.log(error.stack));
await page.goto(`http://127.0.0.1:${server.address().port}/`);
const paint = await page.evaluate(() => new Promise((seen) => {
  const first = () => performance.getEntriesByName('first-contentful-paint')[0];
  const look = () => (first() ? seen(first().startTime) : requestAnimationFrame(look));
  look();
}));
console.log(`first contentful paint ${paint.toFixed(0)} ms`);
const loading = performance.now();
await page.waitForFunction((count) => Number(document.querySelector('#map').dataset.tiles) === count, tiles.length,
  {polling: 200, timeout: 90_000});
console.log(`all ${tiles.length} tiles shown after ${((performance.now() - loading) / 1000).toFixed(1)} s; they are sent within 4 s`);
await new Promise((resolve) => setTimeout(resolve, 1000));

// Frames while `seconds` pass; with a drag, the map follows a pointer that moves every frame.
const measure = (seconds, isDragging) => page.evaluate(([time, drags]) => new Promise((done) => {
  const canvas = document.querySelector('#map');
  const pointer = (type, step) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, isPrimary: true, bubbles: true,
    clientX: 600 + 150 * Math.sin(step / 20), clientY: 450 + 100 * Math.cos(step / 20)}));
  canvas.setPointerCapture = () => {};
  const gaps = [];
  const before = canvas.dataset.view;
  const start = performance.now();
  let last = start;
  if (drags) pointer('pointerdown', 0);
  requestAnimationFrame(function frame(now) {
    if (gaps.length || now > start) gaps.push(now - last);
    last = now;
    if (drags) pointer('pointermove', gaps.length);
    if (now - start < 1000 * time) requestAnimationFrame(frame);
    else {
      if (drags) pointer('pointerup', gaps.length);
      const moved = canvas.dataset.view !== before;
      gaps.sort((a, b) => a - b);
      done({rate: 1000 * gaps.length / (now - start), slow: gaps[Math.floor(0.95 * gaps.length)], moved});
    }
  });
}), [seconds, isDragging]);

// CPU seconds of the browser with all its processes: on a busy machine this says more than the clock.
function cpuTime() {
  const processes = readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((pid) => {
    try {
      const stat = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
      return [{pid: Number(pid), parent: Number(stat[1]), seconds: (Number(stat[11]) + Number(stat[12])) / 100}];
    } catch { return []; }
  });
  const ours = new Set([process.pid]);
  for (let size = 0; size !== ours.size;) {
    size = ours.size;
    for (const {pid, parent} of processes) if (ours.has(parent)) ours.add(pid);
  }
  return processes.filter(({pid}) => ours.has(pid) && pid !== process.pid).reduce((sum, {seconds}) => sum + seconds, 0);
}

for (const [title, clicks] of [['whole building', 0], ['1/4 of it', 4], ['some rooms', 5]]) {
  for (let i = 0; i < clicks; ++i) await page.click('#zoom-in');
  for (const drags of [false, true]) {
    const before = cpuTime();
    const {rate, slow, moved} = await measure(4, drags);
    const cpu = 1000 * (cpuTime() - before) / (4 * rate);
    if (drags && !moved) throw new Error('the map did not follow the drag');
    console.log(`${title}, ${drags ? 'dragged' : 'at rest'}: ${rate.toFixed(1)} frames/s, 95 % within ${slow.toFixed(0)} ms; ` +
      `${cpu.toFixed(1)} ms of CPU each`);
  }
}
if (process.argv[4]) await page.screenshot({path: process.argv[4]});
await browser.close();
server.close();
process.exit(0);
