// What runs where: by the processes' own word, and by the sheriff's protocol if the system was started with it.
import * as commands from './commands.js';
import {NODE, nameOf, said} from './names.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const GONE_S = 3;
const isRecorder = (command) => command.name === 'recorder' || command.group.startsWith('recording');

function setText(element, text) { if (element.textContent !== text) element.textContent = text; }
function cell(text) { return Object.assign(document.createElement('td'), {textContent: text}); }

export class Processes {
  // `ask(subject, send, what)` sends a request and reports; `note(subject, text, tone)` says something.
  constructor(ask, note) {
    Object.assign(this, {ask, note, nodes: [], commands: [], recorder: null, reported: undefined, rows: new Map(), recordingSince: 0});
    $('record').addEventListener('click', () => {
      const action = this.recorder?.running ? 'stop' : 'start';
      this.ask('record', () => commands.process(this.recorder.name, action), action === 'start' ? t`a log` : t`no more`);
    });
    $('save-map').addEventListener('click', () => this.ask('map', () => commands.map('save'), t`to be saved`));
    $('clear-map').addEventListener('click', () => this.forget());
  }

  // Asks once more: what the sonars saw does not come back.
  forget() {
    const button = $('clear-map');
    const isSure = button.classList.contains('urgent');
    clearTimeout(this.doubt);
    const reset = () => { button.textContent = t`Forget sonar marks`; button.classList.remove('urgent'); };
    if (isSure) {
      reset();
      this.ask('map', () => commands.map('clear_evidence'), t`without sonar marks`);
    } else {
      button.textContent = t`Really forget them all?`;
      button.classList.add('urgent');
      this.doubt = setTimeout(reset, 5000);
    }
  }

  showNodes({nodes, rates, delays}) {
    this.nodes = nodes;
    this.show();
    $('channels').tBodies[0].replaceChildren(...Object.entries(rates).map(([channel, rate]) => {
      const row = document.createElement('tr');
      const delay = delays[channel];
      row.append(cell(channel), cell(`${rate.toFixed(1)} Hz`), cell(delay === undefined ? '' : `${(1000 * delay).toFixed(0)} ms`));
      return row;
    }));
  }

  showCommands({commands: list, order}) {
    this.recorder = list.find(isRecorder);
    this.commands = list.filter((command) => !isRecorder(command));
    $('record').hidden = !this.recorder;
    $('record').setAttribute('aria-pressed', String(Boolean(this.recorder?.running)));
    $('record').lastChild.textContent = this.recorder?.running ? t`Stop recording` : t`Record a log`;
    const outcome = order && `${order.id} ${order.fate}`;
    if (this.reported !== undefined && outcome !== this.reported && order) {
      if (order.fate === 'done') this.note('process', this.done(order), '', 6);
      if (order.fate === 'failed') this.note('process', t`${order.name}: ${translated(order.action)} failed: ${order.said}`, 'bad');
    }
    this.reported = outcome;
    this.show();
  }

  done({name, action}) {
    if (!isRecorder({name, group: ''})) return t`${name}: ${translated(action)} done`;
    const took = Math.round((performance.now() - this.recordingSince) / 1000);
    if (action === 'start') this.recordingSince = performance.now();
    return action === 'start' ? t`records all that is said, into drive-DATE.lcm in the robot's state folder`
      : t`recorded ${this.recordingSince ? `${Math.floor(took / 60)} min ${took % 60} s` : t`a log`} into drive-DATE.lcm in the robot's state folder`;
  }

  show() {
    const names = new Set(this.commands.map((command) => command.name));
    const rows = this.commands.map((command) => this.row(command, this.nodes.find(({status}) => status.process === command.name)));
    for (const node of this.nodes) if (!names.has(node.status.process)) rows.push(this.row(null, node));
    const body = $('processes').tBodies[0];
    if (rows.length !== body.rows.length || rows.some((row, i) => body.rows[i] !== row)) body.replaceChildren(...rows);
  }

  // One row for each process, changed in place: what is pressed or has the focus stays.
  row(command, node) {
    const name = command?.name ?? node.status.process;
    const row = this.rows.get(name) ?? this.newRow(name);
    const isGone = !node || node.age > GONE_S;
    const {status} = node ?? {};
    let word = isGone ? (node ? t`silent for ${Math.round(node.age)} s` : t`silent`) : said(NODE, status.state);
    if (isGone && command && !command.running) word = translated(command.condition);
    const isElsewhere = command && !command.running && !isGone;  // somebody started it without the deputy
    const isStopped = isGone && command && !command.running && command.condition === 'stopped';
    row.dataset.state = isStopped ? 'stopped' : isGone ? 'gone' : nameOf(NODE, status.state);
    const isLive = node && !isGone;
    const isReady = isLive && status.state === 1;
    const detail = command?.detail?.startsWith('no status') ? '' : command?.detail;  // that is what "silent" says
    setText(row.cells[1], isLive ? `${(100 * status.cpu_fraction).toFixed(1)} %` : '');
    setText(row.cells[2], isLive ? `${(status.memory_bytes / 1e6).toFixed(0)} MB` : '');
    setText(row.cells[3], command && !isElsewhere ? String(command.restarts) : '');
    setText(row.cells[4], isLive ? String(status.dropped_inputs) : '');
    setText(row.querySelector('small'), isReady ? '' : isGone ? [word, detail].filter(Boolean).join(': ') : status.reason || word);
    // what a ready process once refused is no warning any more
    row.title = [word, isReady ? '' : status?.reason, status && t`on ${status.host}, longest step ${(status.worst_step_us / 1000).toFixed(1)} ms`,
      isReady && status.dropped_inputs ? t`refused ${status.dropped_inputs} messages, the last: ${status.reason}` : '', detail].filter(Boolean).join(' · ');
    this.showButton(row.cells[5].firstChild, isElsewhere ? null : command);
    return row;
  }

  newRow(name) {
    const row = document.createElement('tr');
    row.append(cell(name), ...[1, 2, 3, 4, 5].map(() => cell('')));
    for (const i of [1, 2, 4]) row.cells[i].className = 'numbers';
    row.cells[0].append(document.createElement('small'));
    const button = Object.assign(document.createElement('button'), {className: 'small'});
    button.dataset.process = name;
    button.addEventListener('click', () => this.ask('process', () => commands.process(name, button.dataset.action),
      `${name}: ${translated(button.dataset.action)}`));
    row.cells[5].append(button);
    this.rows.set(name, row);
    return row;
  }

  showButton(button, command) {
    button.hidden = !command;
    if (!command) return;
    button.dataset.action = command.running ? 'restart' : 'start';
    setText(button, command.running ? '↻' : '▶');
    button.title = `${translated(button.dataset.action)}: ${command.name}`;
    button.setAttribute('aria-label', button.title);
  }
}
