// Driving by hand, losing the server, and what else a person does from the page.
import assert from 'node:assert/strict';
import {readdirSync, statSync} from 'node:fs';
import {setTimeout as sleep} from 'node:timers/promises';

import {ADDRESS, until} from './running_system.mjs';

const stands = (system) => Math.abs(system.truth.linear) < 0.02 && Math.abs(system.truth.angular) < 0.02;
// From half a metre per second: half a second of braking, 0.3 s of the dead man's patience, and the events' own rhythm.
const STANDS_WITHIN = 2;

export const byHand = {
  async 'the arrow keys drive while they are held'({system, desk}) {
    await desk.press('#keys');
    const {x, y} = system.truth;
    await desk.page.keyboard.down('ArrowUp');
    await until('it drives by hand', 5, () => system.truth.linear > 0.2);
    await sleep(600);
    await desk.says('#doing', /driven by hand/);
    await desk.page.keyboard.up('ArrowUp');
    await until('it stands after the key', STANDS_WITHIN, () => stands(system));
    await desk.page.keyboard.down('KeyA');
    await until('it turns left', 5, () => system.truth.angular > 0.2);
    await desk.page.keyboard.up('KeyA');
    await until('it stands after the key', STANDS_WITHIN, () => stands(system));
    await desk.press('#keys');
    return `${(100 * system.distanceTo(x, y)).toFixed(0)} cm`;
  },

  async 'the stick under a finger drives; a lost connection stops'({system, phone}) {
    const stick = await phone.page.$('#stick');
    await stick.scrollIntoViewIfNeeded();
    const box = await stick.boundingBox();
    const touch = await phone.context.newCDPSession(phone.page);
    const finger = (type, dy) => touch.send('Input.dispatchTouchEvent',
      {type, touchPoints: type === 'touchEnd' ? [] : [{x: box.x + box.width / 2, y: box.y + box.height / 2 + dy}]});
    await finger('touchStart', 0);
    await finger('touchMove', box.height / 3);  // towards oneself: backwards
    await until('it drives by the stick', 5, () => system.truth.linear < -0.15);
    await phone.picture('steering-phone');
    await phone.context.setOffline(true);
    await until('it stands without the connection', STANDS_WITHIN, () => stands(system));
    await phone.context.setOffline(false);
    await finger('touchEnd');
    await until('the phone is back', 10, async () => !(await phone.isShown('#stale')));
    await finger('touchStart', 0);
    await finger('touchMove', -box.height / 3);
    await until('it drives again', 5, () => system.truth.linear > 0.15);
    await finger('touchEnd');
    await until('it stands after the finger', STANDS_WITHIN, () => stands(system));
  },
};

export const connection = {
  async 'the server dies: both say that their picture is old, and go on when it is back'({system, desk, phone}) {
    await system.end('viewer', 'SIGKILL');
    for (const page of [desk, phone]) await page.says('#stale', /this picture is old/);
    await desk.picture('stale-desktop');
    await system.view();
    for (const page of [desk, phone]) {
      await until(`${page.name} is alive again`, 15, async () => !(await page.isShown('#stale')));
      await page.says('#pose-state', /TRACKING/);
    }
  },
};

export const managing = {
  async 'the motors are off: the page says so and switches them on'({system, phone}) {
    await fetch(`${ADDRESS}/api/motors`,
      {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({enable: false})});
    await phone.says('#doing', /motors are off/);
    await phone.press('#motors');
    await until('the motors are on', 5, () => system.state.robot.motors_enabled);
  },

  async 'a route of two stops, as a patrol, until it is cancelled'({system, desk}) {
    await desk.tapWorld(9.0, 6.4);
    await desk.press('#ask-add');
    await desk.tapWorld(8.2, 6.4);
    await desk.press('#ask-add');
    await desk.press('#route-loop');
    await desk.press('#route-go');
    await until('it is on its patrol', 10, () => system.state.navigation.pose_count === 2 && system.state.navigation.state === 3);
    await desk.picture('patrol-desktop');
    await desk.press('#cancel');
    await desk.says('#doing', /cancelled/);
    await desk.press('#route-clear');
    await until('it stands', 5, () => stands(system));
  },

  async 'a place by its name, paused and resumed'({system, phone}) {
    await phone.page.tap('#places button:text("lab-door")');
    await phone.says('#doing', /lab-door/);
    await phone.press('#pause');
    await phone.says('#doing', /Pauses/);
    await phone.press('#pause');
    await phone.says('#doing', /(Drives|Turns|Plans).* to lab-door/);
    await phone.press('#cancel');
    await phone.says('#doing', /cancelled/);
    await until('it stands', 5, () => stands(system));
  },

  async 'the detector is restarted'({system, desk}) {
    await desk.press('#processes button[data-process=detector]');
    await until('the detector starts anew', 15, () => {
      const {commands, order} = system.news.processes;
      const detector = commands.find((command) => command.name === 'detector');
      return order?.fate === 'done' && detector.condition === 'ready' && detector.uptime < 15;
    }, () => JSON.stringify(system.news.processes));
  },

  async 'the localizer is told where the robot is'({system, desk}) {
    const {x, y, theta} = system.truth;
    await desk.tapWorld(x, y);
    await desk.turnKnob(x, y, theta);
    await desk.press('#ask-here');
    await until('the localizer takes it up', 5, () => system.state.requests.some(
      (request) => request.kind === 'initial_pose' && request.fate === 'answered'));
    const {pose} = system.state;
    assert(system.distanceTo(pose.x, pose.y) < 0.6, `the pose is ${JSON.stringify(pose)}`);
  },

  async 'a log is recorded and the map saved'({system, desk}) {
    const logs = () => readdirSync(system.stateFolder).filter((file) => file.startsWith('drive-'));
    await desk.press('#record');
    await desk.says('#record', /Stop recording/, 15);
    await until('the log grows', 10, () => logs().some((file) => statSync(`${system.stateFolder}/${file}`).size > 100_000));
    await desk.press('#save-map');
    await until('the map is saved', 10, () => readdirSync(`${system.stateFolder}/p3dx`).includes('map.yaml'));
    await desk.press('#record');
    await desk.says('#record', /Record a log/, 15);
    return logs().join(', ');
  },
};
