// What runs where: by the processes' own word, and by the sheriff's protocol if the system was started with it.
import * as commands from './commands.js';
import {NODE, nameOf} from './names.js';

const $ = (id) => document.getElementById(id);
const GONE_S = 3;
const isRecorder = (command) => command.name === 'recorder' || command.group.startsWith('recording');

function cell(text) { return Object.assign(document.createElement('td'), {textContent: text}); }

export class Processes {
  // `ask(subject, send, what)` sends a request and reports; `note(subject, text, tone)` says something.
  constructor(ask, note) {
    Object.assign(this, {ask, note, nodes: [], commands: [], recorder: null, reported: undefined});
    $('record').addEventListener('click', () => {
      const action = this.recorder?.running ? 'stop' : 'start';
      this.ask('record', () => commands.process(this.recorder.name, action), action === 'start' ? 'a log' : 'no more');
    });
    $('save-map').addEventListener('click', () => this.ask('map', () => commands.map('save'), 'to be saved'));
    $('clear-map').addEventListener('click', () => this.ask('map', () => commands.map('clear_evidence'), 'without sonar marks'));
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
    $('record').lastChild.textContent = this.recorder?.running ? 'Stop recording' : 'Record a log';
    const said = order && `${order.id} ${order.fate}`;
    if (this.reported !== undefined && said !== this.reported && order) {
      if (order.fate === 'done') this.note('process', `${order.name}: ${order.action} done`, '', 3);
      if (order.fate === 'failed') this.note('process', `${order.name}: ${order.action} failed: ${order.said}`, 'bad');
    }
    this.reported = said;
    this.show();
  }

  show() {
    const names = new Set(this.commands.map((command) => command.name));
    const rows = this.commands.map((command) => this.row(command, this.nodes.find(({status}) => status.process === command.name)));
    for (const node of this.nodes) if (!names.has(node.status.process)) rows.push(this.row(null, node));
    $('processes').tBodies[0].replaceChildren(...rows);
  }

  row(command, node) {
    const row = document.createElement('tr');
    const isGone = !node || node.age > GONE_S;
    const {status} = node ?? {};
    let word = isGone ? (node ? `silent for ${Math.round(node.age)} s` : 'silent') : nameOf(NODE, status.state);
    if (isGone && command && !command.running) word = command.condition;
    const isElsewhere = command && !command.running && !isGone;  // somebody started it without the deputy
    const isStopped = isGone && command && !command.running && command.condition === 'stopped';
    row.dataset.state = isStopped ? 'stopped' : isGone ? 'gone' : nameOf(NODE, status.state);
    const isLive = node && !isGone;
    row.append(cell(command?.name ?? status.process), cell(isLive ? `${(100 * status.cpu_fraction).toFixed(1)} %` : ''),
      cell(isLive ? `${(status.memory_bytes / 1e6).toFixed(0)} MB` : ''), cell(command && !isElsewhere ? String(command.restarts) : ''),
      cell(isLive ? String(status.dropped_inputs) : ''), this.restart(isElsewhere ? null : command));
    row.title = [word, status?.reason, status && `on ${status.host}, longest step ${(status.worst_step_us / 1000).toFixed(1)} ms`,
      command?.detail].filter(Boolean).join(' · ');
    if (isGone || status.state !== 1) {
      const small = document.createElement('small');
      small.textContent = isGone ? [word, command?.detail].filter(Boolean).join(': ') : status.reason || word;
      row.firstChild.append(small);
    }
    return row;
  }

  restart(command) {
    const last = document.createElement('td');
    if (!command) return last;
    const action = command.running ? 'restart' : 'start';
    const button = Object.assign(document.createElement('button'),
      {textContent: command.running ? '↻' : '▶', title: `${action} ${command.name}`, className: 'small'});
    button.dataset.process = command.name;
    button.addEventListener('click', () => this.ask('process', () => commands.process(command.name, action),
      `${command.name} to ${action}`));
    last.append(button);
    return last;
  }
}
