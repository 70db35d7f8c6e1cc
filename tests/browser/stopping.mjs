// How the robot came to a stand after a STOP, from a log of SIM_TRUTH and STOP.
import {execFileSync} from 'node:child_process';
import {readFileSync, rmSync} from 'node:fs';

const STILL = 0.02;  // [m/s, rad/s]

function table(file) {
  const [head, ...lines] = readFileSync(file, 'utf8').trim().split('\n');
  const names = head.split(',').map((name) => name.replace(/"| *\[.*/g, '').trim());
  return lines.map((line) => Object.fromEntries(line.split(',').map((cell, i) => [names[i], Number(cell)])))
    .map((row) => ({...row, received: row.received * 1e-6}));
}

// Times in seconds; `pressedAt` in ms since the epoch. `hiccup` is how much later than expected the machine delivered
// the worst of the messages in between: time in which its processes did not run.
export function judgeStop(bin, log, pressedAt) {
  const folder = `${log}.csv`;
  rmSync(folder, {recursive: true, force: true});
  execFileSync(`${bin}/export`, ['--csv', folder, log], {stdio: 'ignore'});
  const truth = table(`${folder}/SIM_TRUTH.csv`);
  const stop = table(`${folder}/STOP.csv`).find((row) => row.received >= pressedAt / 1000 - 0.05);
  const after = truth.filter((row) => row.received >= stop.received);
  const moving = after.findLastIndex((row) => Math.abs(row.linear) >= STILL || Math.abs(row.angular) >= STILL);
  const stood = after[moving + 1];
  const during = after.slice(0, moving + 2);
  const gaps = during.slice(1).map((row, i) => row.received - during[i].received - 0.01);
  return {tapLatency: stop.received - pressedAt / 1000, speed: Math.abs(after[0].linear), stopping: stood.received - stop.received,
    hiccup: Math.max(0, ...gaps)};
}
