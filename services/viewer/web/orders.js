// Edits of a file of the building: each names the version that it was made for, and the viewer says what became of it.
import {t} from './texts.js';

const PATIENCE_MS = 20_000;  // checking a large building takes seconds
const DOUBT_MS = 5000;

export class Orders {
  // `post(order)` sends one and returns its id; `told.begin()`, `done(order)`, `asks(order, found)` and `refused(why)` say how it
  // gets on; `stale` is the sentence for an edit of an old version.
  constructor(post, stale, told) {
    Object.assign(this, {post, stale, told, waiting: null, outcomes: []});
    setInterval(() => {
      if (this.waiting && performance.now() - this.waiting.since > PATIENCE_MS) this.end('refused', t`No answer from the viewer.`);
    }, 1000);
  }

  async send(order) {
    const mine = {id: 0, since: performance.now(), order};
    this.waiting = mine;
    this.told.begin();
    try {
      mine.id = await this.post(order);
      if (this.waiting === mine) this.look(this.outcomes);
    } catch (error) {
      if (this.waiting === mine) this.end('refused', error.status === 409 ? this.stale : error.message);
    }
  }

  // `outcomes`: what the viewer says of the last edits.
  look(outcomes) {
    this.outcomes = outcomes;
    const outcome = this.waiting && outcomes.find(({id}) => id === this.waiting.id);
    if (!outcome || outcome.fate === 'waiting') return;
    const {order} = this.waiting;
    if (outcome.fate === 'done') this.end('done', order);
    else if (outcome.fate === 'asks') this.end('asks', order, outcome.found);
    else this.end('refused', outcome.said);
  }

  end(how, ...what) {
    this.waiting = null;
    this.told[how](...what);
  }

  forget() { this.waiting = null; }
}

// A press asks, a second one soon after does it.
export function askTwice(button, question, act) {
  const text = button.textContent;
  let doubt = 0;
  const reset = () => { button.textContent = text; button.classList.remove('urgent'); };
  button.addEventListener('click', () => {
    clearTimeout(doubt);
    const isSure = button.classList.contains('urgent');
    reset();
    if (isSure) {
      act();
    } else {
      button.textContent = question;
      button.classList.add('urgent');
      doubt = setTimeout(reset, DOUBT_MS);
    }
  });
}

// What is said of an edit, in the parts `prefix`-said, -said-text and -found of the page.
export function say(prefix, text, found = []) {
  const part = (name) => document.getElementById(`${prefix}-${name}`);
  part('said').hidden = !text;
  part('said-text').textContent = text;
  part('found').replaceChildren(...found.map((what) => Object.assign(document.createElement('li'), {textContent: what})));
}
