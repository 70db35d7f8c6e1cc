// viewer_load.mjs ADDRESS PID [CLIENTS] [SECONDS] [STALLED]: what watching costs the viewer with process number PID. CLIENTS
// read the events and fetch each camera picture; STALLED more connect and never read. Prints bytes and states per second
// and client, CPU and memory, and how long a command takes meanwhile.
import {readFileSync} from 'node:fs';
import {connect} from 'node:net';
import {setTimeout as sleep} from 'node:timers/promises';

const [address, pid, clients = 1, seconds = 20, stalled = 0] = process.argv.slice(2);
const seen = Array.from({length: Number(clients)}, () => ({bytes: 0, states: 0}));

async function watch(mine) {
  const answer = await fetch(`${address}/events`);
  for await (const piece of answer.body) {
    const text = Buffer.from(piece).toString('latin1');
    mine.bytes += text.length;
    mine.states += text.split('event: state\n').length - 1;
    if (text.includes('event: picture\n')) {
      fetch(`${address}/camera.jpg`).then((picture) => picture.arrayBuffer()).then((jpeg) => { mine.bytes += jpeg.byteLength; });
    }
  }
}

function stall() {
  const {hostname, port} = new URL(address);
  const socket = connect({host: hostname, port, onread: {buffer: Buffer.alloc(1), callback: () => false}});
  socket.write(`GET /events HTTP/1.1\r\nHost: ${hostname}\r\n\r\n`);
  socket.on('error', () => {});
}

// CPU seconds used so far, and resident memory in MB.
function cost() {
  const stat = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  const memory = /VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1] / 1000;
  return {cpu: (Number(stat[11]) + Number(stat[12])) / 100, memory};
}

for (const mine of seen) watch(mine);
for (let i = 0; i < stalled; ++i) stall();
await sleep(5000);  // the map has come
const before = cost();
for (const mine of seen) Object.assign(mine, {bytes: 0, states: 0});
const began = performance.now();
const answers = [];
while (performance.now() - began < 1000 * seconds) {
  const asked = performance.now();
  await (await fetch(`${address}/settings.json`)).text();
  answers.push(performance.now() - asked);
  await sleep(200);
}
const time = (performance.now() - began) / 1000;
const after = cost();
answers.sort((a, b) => a - b);
const sum = (key) => seen.reduce((total, mine) => total + mine[key], 0) / seen.length / time;
console.log(`${clients} clients, ${stalled} stalled: ${(sum('bytes') / 1000).toFixed(0)} kB/s and ${sum('states').toFixed(1)} states/s each; ` +
  `CPU ${(100 * (after.cpu - before.cpu) / time).toFixed(1)} % of a core, ${after.memory.toFixed(0)} MB; ` +
  `an answer takes ${answers[answers.length >> 1].toFixed(1)} ms, at most ${answers.at(-1).toFixed(1)} ms`);
process.exit(0);
