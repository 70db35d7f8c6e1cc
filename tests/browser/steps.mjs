// What the two people do, step by step. Each step waits for what a person would wait for; truth is the simulator's.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {setTimeout as sleep} from 'node:timers/promises';

import {until} from './running_system.mjs';
import {judgeStop} from './stopping.mjs';

const TRACKING = 2;
const ARRIVED = 5;
const FOLLOWING = 3;
const cm = (metres) => `${(100 * metres).toFixed(1)} cm`;

export const isDriving = (system) => Math.abs(system.state.robot?.linear ?? 0) > 0.15;

export async function arrives(system, x, y, within, seconds) {
  await until(`the robot arrives at ${x}, ${y}`, seconds,
    () => system.state.navigation.state === ARRIVED && system.distanceTo(x, y) < 1,  // not the arrival before
    () => JSON.stringify([system.truth, system.state.navigation]));
  const off = system.distanceTo(x, y);
  assert(off < within, `arrived ${cm(off)} beside the goal`);
  return off;
}

export async function everyLook(page, title) {
  for (const theme of ['light', 'dark']) {
    await page.inTheme(theme);
    await page.picture(`${title}-${page.name}-${theme}`);
  }
}

export const localizing = {
  async 'the page shows the building at once'({system, desk}) {
    await desk.says('#building', /laboratory/);
    await until('the system runs', 40, () => system.state.navigation && system.state.robot?.motors_enabled && system.state.pose,
      () => system.tail('launch'));
    await desk.says('#doing', /Stands still|Looks for/);
  },

  async 'a tap on the map makes it look for where it is'({system, desk, phone}) {
    assert.notEqual(system.state.pose.state, TRACKING);
    await phone.says('#pose-state', /LOST|AMBIGUOUS/);
    await desk.goTo(8.6, 6.4);
    await desk.says('#doing', /Looks for where it is/);
    await sleep(1000);
    await everyLook(desk, 'localizing');
    await everyLook(phone, 'localizing');
  },

  async 'it finds out'({system, desk, phone}) {
    await until('the robot knows where it is', 90, () => system.state.pose?.state === TRACKING,
      () => JSON.stringify(system.state.pose));
    await desk.says('#pose-state', /TRACKING/);
    await phone.says('#pose-state', /TRACKING/);
    const off = system.distanceTo(system.state.pose.x, system.state.pose.y);
    assert(off < 0.5, `TRACKING ${cm(off)} beside the truth`);
    return `${cm(off)} off`;
  },

  async 'and arrives where the tap was'({system, desk}) {
    const off = await arrives(system, 8.6, 6.4, 0.3, 60);
    await desk.says('#doing', /Arrived/);
    return `${cm(off)} off`;
  },
};

export const driving = {
  async 'a goal with a heading, dragged on the desktop'({system, desk, phone}) {
    await desk.goTo(6.4, 6.2, Math.PI / 2);
    await until('the robot follows a path', 10, () => system.state.navigation.state === FOLLOWING && isDriving(system));
    await everyLook(desk, 'driving');
    await everyLook(phone, 'driving');
    const off = await arrives(system, 6.4, 6.2, 0.3, 40);
    const turned = Math.abs(Math.atan2(Math.cos(system.truth.theta), Math.sin(system.truth.theta)));
    assert(turned < 0.25, `the heading is off by ${turned} rad`);
    return `${cm(off)}, ${(turned * 180 / Math.PI).toFixed(1)}° off`;
  },
};

export const stopping = {
  async 'STOP on the phone'({system, desk, phone, folder}) {
    const log = `${folder}/stop.lcm`;
    system.record(log);
    await phone.goTo(9.6, 6.4);
    await until('it drives', 15, () => isDriving(system));
    await sleep(500);
    await phone.press('#stop');
    await until('it stands', 5, () => Math.abs(system.truth.linear) < 0.02 && Math.abs(system.truth.angular) < 0.02);
    await desk.says('#doing', /Stopped/);
    await phone.says('#doing', /Stopped/);
    for (const page of [desk, phone]) await page.says('#stop-state', /The robot stands/);
    await sleep(500);
    await system.end('logger', 'SIGINT');
    const seen = judgeStop(system.bin, log, await phone.pressedAt());
    const deceleration = Number(/^linear_deceleration = ([0-9.]+)/m.exec(
      readFileSync(`${system.source}/launch/robots/p3dx.toml`, 'utf8'))[1]);
    const limit = seen.speed / deceleration + 0.15 + seen.hiccup;
    const said = `from ${seen.speed.toFixed(2)} m/s in ${seen.stopping.toFixed(2)} s, limit ${limit.toFixed(2)} s; ` +
      `the tap itself took ${(1000 * seen.tapLatency).toFixed(0)} ms`;
    assert(seen.stopping < limit, said);
    return said;
  },

  async 'the release lies under the thumb, and lets it stay where it is'({system, desk, phone}) {
    await everyLook(desk, 'stopped');
    await everyLook(phone, 'stopped');
    const box = await (await phone.page.$('#release')).boundingBox();
    assert(box.y > 0 && box.y + box.height < 844, `the button lies at ${box.y}`);
    await phone.press('#release');
    await until('the stop is released', 5, () => !system.state.robot.stop_engaged && !system.state.control.stop_engaged);
    await desk.says('#doing', /Pauses/);
    const {x, y} = system.truth;
    await sleep(1500);
    assert(system.distanceTo(x, y) < 0.01, 'it moved because a stop was released');
  },

  async 'stopped and released once more, it goes on if a person wants that'({system, desk, phone}) {
    await desk.page.keyboard.press('Space');
    await until('it is stopped', 5, () => system.state.robot.stop_engaged && system.state.control.stop_engaged);
    await phone.press('#release-go');
    await until('the stop is released', 5, () => !system.state.robot.stop_engaged && !system.state.control.stop_engaged);
    await phone.press('#pause');
    if (await phone.isShown('#motors')) await phone.press('#motors');
    const off = await arrives(system, 9.6, 6.4, 0.3, 40);
    return `${cm(off)} off`;
  },
};
