// bridge_test.mjs PACKAGES BIN LOG FOLDER: Foxglove's own client hears through the bridge what `export --mcap` writes of the
// same log, while another client reads nothing and others send what is no request.
import {execFileSync, spawn, spawnSync} from 'node:child_process';
import {mkdirSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {connect} from 'node:net';
import {setTimeout as sleep} from 'node:timers/promises';
import {isDeepStrictEqual} from 'node:util';

const [packages, bin, log, folder] = process.argv.slice(2);
const require = createRequire(`${packages}/`);
const {FoxgloveClient} = require('@foxglove/ws-protocol');
const {McapStreamReader} = require('@mcap/core');
const WebSocket = require('ws');

const URL = 'udpm://239.255.76.67:7667?ttl=0';
const ADDRESS = 'ws://127.0.0.1:8765';
const failures = [];
const expect = (holds, what) => { if (!holds && failures.length < 20) failures.push(what); };
async function until(what, condition) {
  for (let tries = 0; tries < 400; ++tries) {
    if (await condition()) return;
    await sleep(50);
  }
  throw new Error(`in 20 s not: ${what}`);
}

// Of each topic the messages in order. What the time of hearing is in, or how the map comes together, differs by nature;
// NODE_STATUS is the bridge's too.
const DIFFERS = new Set(['/log', '/map', 'NODE_STATUS']);
function exported() {
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder, {recursive: true});
  const file = `${folder}/log.mcap`;
  execFileSync(`${bin}/export`, [log, '--mcap', file]);
  const reader = new McapStreamReader();
  reader.append(readFileSync(file));
  const [names, schemas, topics] = [new Map(), new Map(), new Map()];
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === 'Schema') schemas.set(record.id, Buffer.from(record.data).toString());
    if (record.type === 'Channel' && !names.has(record.id)) {  // once more at the end
      names.set(record.id, record.topic);
      topics.set(record.topic, {schema: schemas.get(record.schemaId), messages: []});
    }
    if (record.type === 'Message') topics.get(names.get(record.channelId)).messages.push(JSON.parse(Buffer.from(record.data)));
  }
  return topics;
}

// A client that subscribes to everything.
class Listener {
  constructor(protocol) {
    this.topics = new Map();
    this.channels = new Map();
    this.statuses = [];
    this.socket = new WebSocket(ADDRESS, [protocol]);
    this.client = new FoxgloveClient({ws: this.socket});
    this.client.on('serverInfo', (info) => { this.info = info; });
    this.client.on('status', (status) => this.statuses.push(status.message));
    this.client.on('error', (error) => failures.push(`${protocol}: ${error}`));
    const topicOf = new Map();
    this.client.on('advertise', (channels) => {
      for (const channel of channels) {
        this.channels.set(channel.topic, channel);
        topicOf.set(this.client.subscribe(channel.id), channel.topic);
      }
    });
    this.client.on('message', ({subscriptionId, timestamp, data}) => {
      const topic = topicOf.get(subscriptionId);
      if (!this.topics.has(topic)) this.topics.set(topic, []);
      const json = JSON.parse(Buffer.from(data.buffer, data.byteOffset, data.byteLength));
      this.topics.get(topic).push(json);
      if (Math.abs(Number(timestamp / 1_000_000n) - Date.now()) > 60_000) failures.push(`${topic}: heard at ${timestamp}`);
    });
  }
  count(topic) { return this.topics.get(topic)?.length ?? 0; }
  forget() { this.topics.clear(); }
  close() { this.client.close(); }
}

const play = (speed = 2) => new Promise((resolve) => {
  spawn('lcm-logplayer', ['-l', URL, '-s', String(speed), log], {stdio: 'ignore'}).on('exit', resolve);
});

// What a handshake is answered: 101, or the status of the refusal.
const handshake = (headers, protocols = ['foxglove.websocket.v1']) => new Promise((resolve) => {
  const socket = new WebSocket(ADDRESS, protocols, {headers});
  socket.on('open', () => { socket.close(); resolve(101); });
  socket.on('unexpected-response', (_, response) => { resolve(response.statusCode); response.destroy(); });
  socket.on('error', () => resolve(0));
});

const wanted = exported();
const bridge = spawn(`${bin}/bridge`, ['--lcm-url', URL, '--origin', 'https://viewer.example'], {stdio: ['ignore', 'pipe', 'inherit']});
let said = '';
bridge.stdout.on('data', (text) => { said += text; });
let ended;
const end = new Promise((resolve) => bridge.on('exit', (status, signal) => { ended = signal ?? status; resolve(); }));
try {
  await until('the bridge serves', () => said.includes(ADDRESS));

  // Who may listen.
  for (const [headers, protocols, status] of [
    [{}, undefined, 101], [{}, ['foxglove.sdk.v1'], 101], [{}, ['other', 'foxglove.sdk.v1'], 101], [{}, [], 400], [{}, ['other'], 400],
    [{Origin: 'https://viewer.example'}, undefined, 101], [{Origin: 'http://localhost:8080'}, undefined, 101],
    [{Origin: 'https://evil.example'}, undefined, 403], [{Origin: 'null'}, undefined, 403], [{Host: 'evil.example'}, undefined, 403]]) {
    const got = await handshake(headers, protocols);
    expect(got === status, `${JSON.stringify([headers, protocols])}: ${got} instead of ${status}`);
  }

  // The first time channels come up while they are played; the second time everything is heard.
  const listener = new Listener('foxglove.websocket.v1');
  const second = new Listener('foxglove.sdk.v1');
  await until('the clients are greeted', () => listener.info && second.info);
  expect(listener.info.name === 'luminav' && listener.info.capabilities.length === 0, JSON.stringify(listener.info));
  await play(4);
  await until('all channels', () => [...wanted.keys()].every((topic) => listener.channels.has(topic)));
  for (const [topic, {schema}] of wanted) {
    const channel = listener.channels.get(topic);
    expect(channel.schema === schema && channel.encoding === 'json' && channel.schemaEncoding === 'jsonschema', `${topic}: another schema`);
  }
  await sleep(500);
  listener.forget();
  second.forget();
  await play();
  const compared = [...wanted.keys()].filter((topic) => !DIFFERS.has(topic) && topic !== '/tf_static');
  await until('all messages', () => compared.every((topic) => listener.count(topic) >= wanted.get(topic).messages.length)).catch(() => {});
  let messages = 0;
  for (const topic of compared) {
    for (const [name, heard] of [['v1', listener], ['sdk', second]]) {
      const [got, all] = [heard.topics.get(topic) ?? [], wanted.get(topic).messages];
      // the pose's first transform is made of the odometry that was heard last, the first time's
      const same = topic === '/tf' ? got.length >= all.length : isDeepStrictEqual(got, all);
      expect(same, `${topic} by ${name}: ${got.length} messages of ${all.length}, or others`);
      messages += got.length;
    }
  }
  expect(listener.statuses.length === 0, `the client is told ${listener.statuses[0]}`);

  // Who comes late gets map, path and where the camera sits.
  const late = new Listener('foxglove.websocket.v1');
  await until('what is kept', () => ['/map', '/path', '/tf_static'].every((topic) => late.count(topic) === 1));
  expect(!late.topics.has('/pose'), 'an old pose is sent to who comes late');
  late.close();

  // A client that reads nothing loses messages; nobody else does, and it goes on when it reads again.
  const slow = new Listener('foxglove.websocket.v1');
  await until('the slow client is greeted', () => slow.channels.size >= wanted.size);
  await sleep(300);
  slow.socket.pause();
  listener.forget();
  const rounds = 8;
  for (let round = 0; round < rounds; ++round) await play(8);
  await until('the others hear everything', () => listener.count('/camera') === rounds * wanted.get('/camera').messages.length);
  slow.socket.resume();
  await until('the slow client is told', () => slow.statuses.some((text) => text.includes('too slow')));
  const before = slow.count('/camera');
  expect(before < rounds * wanted.get('/camera').messages.length, 'the slow client lost nothing');
  await play(4);
  await until('the slow client hears again', () => slow.count('/camera') >= before + wanted.get('/camera').messages.length);
  slow.close();

  // What is no request is answered or ends that client, and only that.
  const rude = new WebSocket(ADDRESS, ['foxglove.websocket.v1']);
  const answers = [];
  rude.on('message', (data, isBinary) => { if (!isBinary) answers.push(JSON.parse(data)); });
  await until('the rude client is greeted', () => answers.some(({op}) => op === 'advertise'));
  const wrong = ['no JSON', '[]', '{}', '{"op":"subscribe"}', '{"op":"subscribe","subscriptions":[{"id":"a","channelId":1}]}',
    '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99999}]}', '{"op":"advertise","channels":[]}'];
  for (const text of wrong) rude.send(text);
  await until('each is answered', () => answers.filter(({op}) => op === 'status').length === wrong.length);
  rude.on('error', () => {});
  rude.send('x'.repeat(200_000));
  await until('a huge request ends its client', () => rude.readyState === WebSocket.CLOSED);
  for (const noise of ['\x16\x03\x01\x02', 'GET / HTTP/1.1\r\n\r\n', `GET / HTTP/1.1\r\nX: ${'y'.repeat(20_000)}\r\n\r\n`, '']) {
    const raw = connect(8765, '127.0.0.1');
    raw.on('error', () => {});
    raw.write(noise);
    setTimeout(() => raw.destroy(), 1000);
  }
  const many = Array.from({length: 60}, () => connect(8765, '127.0.0.1').on('error', () => {}));
  await sleep(1500);
  for (const one of many) one.destroy();
  listener.forget();
  await play(4);
  await until('the first client hears all the same', () => listener.count('/pose') === wanted.get('/pose').messages.length);
  expect(ended === undefined, `the bridge has ended: ${ended}`);
  const usage = spawnSync('ps', ['-o', 'rss=,time=', '-p', String(bridge.pid)], {encoding: 'utf8'}).stdout.trim();
  console.log(`${messages} messages on ${compared.length} topics agree; the bridge: ${usage} (kB, CPU time)`);
  listener.close();
  second.close();
  bridge.kill('SIGTERM');
  await end;
  expect(ended === 0, `the bridge ends with ${ended}`);
} catch (error) {
  failures.push(error.stack);
} finally {
  bridge.kill('SIGKILL');
}
console.log(failures.length ? failures.join('\n') : 'passed');
process.exit(failures.length ? 1 : 0);
