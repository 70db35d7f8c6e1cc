// A viewer that is only pretended: serves the page of SOURCE and says what a test wants it to say.
import {existsSync, mkdirSync, readdirSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {userInfo} from 'node:os';

const types = {html: 'text/html', css: 'text/css', js: 'text/javascript', svg: 'image/svg+xml'};

export const hut = {name: 'hut', fixtures: [], elements: [], doors: [], windows: [], zones: [], places: [{name: 'lift', x: 1, y: 2}],
  robot: {maximum_linear: 0.5, maximum_angular: 1, footprint: [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]],
    sonar: {discs: [], opening_angle: 0.3, maximum_range: 3}, sonars: []}};

export const standing = () => ({
  utime: 1e15, ages: {POSE: 0.02, ROBOT_STATUS: 0.02, CONTROL_STATUS: 0.02, NAVIGATION_STATUS: 0.1}, requests: [],
  pose: {state: 2, x: 1, y: 1, theta: 0, covariance: [1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4], reason: '', nis: 1, distance_since_fixture: 0.3},
  robot: {connected: true, motors_enabled: true, stop_engaged: false, stop_button: false, battery_voltage: 12.5, linear: 0, angular: 0, reason: ''},
  control: {state: 0, reason: '', linear: 0, angular: 0, clearance: 1, stop_engaged: false},
  navigation: {state: 0, pose_count: 0, pose_index: 0, distance_left: 0, cause: ''}});

export class PretendedViewer {
  constructor(source, building = hut) {
    Object.assign(this, {web: `${source}/services/viewer/web`, building, state: standing(), answers: true, mayCommand: true, role: 'administer', heard: [],
      refusal: null, edits: 0, picture: null, files: {recordings: [], maps: [], photos: []}, streams: new Set()});
  }

  async listen() {
    this.server = createServer((request, response) => this.answer(request, response));
    await new Promise((listening) => this.server.listen(0, '127.0.0.1', listening));
    this.address = `http://127.0.0.1:${this.server.address().port}/#token=0123456789abcdef`;
    return this;
  }

  // Something else than the state, which goes out 20 times a second.
  say(name, data) { for (const stream of this.streams) stream.write(`event: ${name}\ndata: ${JSON.stringify(data)}\n\n`); }

  answer(request, response) {
    const path = request.url.split('?')[0].replace(/^\/$/, '/index.html');
    if (path === '/events') {
      response.writeHead(200, {'Content-Type': 'text/event-stream'});
      this.streams.add(response);
      const timer = setInterval(() => response.write(`event: state\ndata: ${JSON.stringify(this.state)}\n\n`), 50);
      request.on('close', () => { clearInterval(timer); this.streams.delete(response); });
    } else if (path.startsWith('/api/')) this.obey(path, request, response);
    else if (path === '/building.json') response.end(JSON.stringify(this.building));
    else if (path === '/settings.json') response.end(JSON.stringify({command_port: this.server.address().port, needs_token: true, role: this.role}));
    else if (path === '/qr.svg') {
      this.heard.push(`/qr.svg ${new URL(request.url, 'http://viewer').searchParams.get('text')}`);
      response.writeHead(200, {'Content-Type': 'image/svg+xml'});
      response.end('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"><path d="M0 0h1v1H0z"/></svg>');
    }
    else if (path === '/camera.jpg' && this.picture) response.end(this.picture);
    else if (readdirSync(this.web).includes(path.slice(1))) {
      response.writeHead(200, {'Content-Type': types[path.split('.').at(-1)]});
      response.end(readFileSync(this.web + path));
    } else {
      response.writeHead(404);
      response.end();
    }
  }

  obey(path, request, response) {
    if (!this.answers) return;  // as one that is frozen
    let body = '';
    request.on('data', (piece) => { body += piece; });
    request.on('end', () => {
      this.heard.push(`${path} ${body}`);
      if (path === '/api/files' && request.method === 'GET') { response.end(JSON.stringify(this.files)); return; }
      if (this.refusal && path.startsWith(this.refusal.path)) {
        response.writeHead(this.refusal.status);
        response.end(JSON.stringify({error: this.refusal.error}));
        return;
      }
      response.end(path === '/api/watch' ? JSON.stringify({may_command: this.mayCommand})
        : ['/api/building', '/api/tours'].includes(path) ? `{"id":${++this.edits}}` : '{"id":7}');
    });
  }

  close() {
    this.server.closeAllConnections();
    this.server.close();
  }
}

// Ends with status 77 (skipped) where there is no browser.
export async function startBrowser(folder) {
  const executablePath = process.env.LUMINAV_CHROMIUM ?? '/usr/bin/chromium';
  if (!existsSync(executablePath)) {
    console.log(`skipped: no ${executablePath}`);
    process.exit(77);
  }
  mkdirSync(`${folder}/pictures`, {recursive: true});
  const {chromium} = createRequire(`${folder}/`)('playwright-core');
  return chromium.launch({executablePath, args: userInfo().uid === 0 ? ['--no-sandbox'] : []});
}
