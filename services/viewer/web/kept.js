// Recordings and saved maps of the machine on which the viewer runs: how large, how old; to be fetched and deleted.
import * as commands from './commands.js';
import {locale, t} from './texts.js';

const RENEWED_MS = 5000;
const DOUBT_MS = 5000;

export function sizeOf(bytes) {
  const [value, unit] = bytes < 1e6 ? [bytes / 1e3, 'kB'] : bytes < 1e9 ? [bytes / 1e6, 'MB'] : [bytes / 1e9, 'GB'];
  return `${value < 10 ? value.toFixed(1) : Math.round(value)} ${unit}`;
}

const dateOf = (seconds) => new Date(seconds * 1000).toLocaleString(locale, {dateStyle: 'medium', timeStyle: 'short'});

export class Kept {
  // `details` is opened to see the list; `ask(subject, send, what)` sends a request and reports.
  constructor({details, list}, ask) {
    Object.assign(this, {details, list, ask, seen: ''});
    details.addEventListener('toggle', () => this.renew());
    setInterval(() => { if (!document.hidden) this.renew(); }, RENEWED_MS);
  }

  async renew() {
    if (!this.details.open) return;
    const said = await fetch('api/files').then((answer) => answer.text()).catch(() => '');
    if (!said || said === this.seen || this.list.querySelector('.urgent')) return;  // somebody is being asked
    this.seen = said;
    const {recordings, maps} = JSON.parse(said);
    const lines = [...recordings.map((item) => this.line('recording', item)), ...maps.map((item) => this.line('map', item))];
    const focused = document.activeElement?.dataset.kept;
    this.list.replaceChildren(...lines);
    if (focused) [...this.list.querySelectorAll('[data-kept]')].find(({dataset}) => dataset.kept === focused)?.focus();
  }

  line(kind, item) {
    const line = document.createElement('li');
    const about = document.createElement('span');
    about.append(Object.assign(document.createElement('b'), {textContent: kind === 'map' ? t`map ${item.name}` : item.name}),
      Object.assign(document.createElement('small'), {textContent: [sizeOf(item.bytes), dateOf(item.modified),
        item.growing ? t`is being written` : ''].filter(Boolean).join(' · ')}));
    line.append(about, ...item.files.map((file) => this.link(kind, file)), this.deleter(kind, item));
    return line;
  }

  link(kind, file) {
    const link = Object.assign(document.createElement('a'), {href: `api/file?kind=${kind}&name=${encodeURIComponent(file)}`,
      download: file, textContent: kind === 'map' ? `↓ ${file.split('.').at(-1)}` : '↓', title: t`Download ${file}`});
    link.setAttribute('aria-label', link.title);
    link.dataset.kept = file;
    return link;
  }

  // Asks once more: it does not come back.
  deleter(kind, {name, growing}) {
    const button = Object.assign(document.createElement('button'), {className: 'small', textContent: '✕', disabled: growing});
    const reset = () => {
      Object.assign(button, {textContent: '✕', className: 'small', title: t`Delete ${name}`});
      button.setAttribute('aria-label', button.title);
    };
    reset();
    button.dataset.kept = `delete ${name}`;
    let doubt = 0;
    button.addEventListener('click', async () => {
      clearTimeout(doubt);
      const isSure = button.classList.contains('urgent');
      reset();
      if (isSure) {
        await this.ask('delete', () => commands.remove(kind, name), name);
        this.seen = '';
        this.renew();
      } else {
        Object.assign(button, {textContent: t`Really delete it?`, className: 'small urgent'});
        button.removeAttribute('aria-label');
        doubt = setTimeout(reset, DOUBT_MS);
      }
    });
    return button;
  }
}
