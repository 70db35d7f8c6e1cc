// A job that a scanned code asks for: shown large, and ordered by a tap. Opening the address alone moves nothing.
import {t} from './texts.js';

const $ = (id) => document.getElementById(id);

// What a code says below it, and what one tap then orders. `word`: a robot that waits there for it is told so instead.
export const OFFERS = {
  guide: {title: (place) => t`Guide me to ${place}`, question: () => '', stops: (place) => [place], count: 1},
  load: {title: (place) => t`Load here: ${place}`, question: (place) => t`It comes to ${place} and is loaded here. Where shall it bring it?`,
    stops: (place, other) => [place, other], count: 2, word: 'loaded', said: () => t`It is loaded`},
  unload: {title: (place) => t`Unload here: ${place}`, question: (place) => t`It brings something to ${place}. Where is it fetched?`,
    stops: (place, other) => [other, place], count: 2, word: 'unloaded', said: () => t`It is unloaded`},
};

export function addressOf(origin, job, place, token) {
  return `${origin.replace(/\/+$/, '')}/?job=${job}&place=${encodeURIComponent(place)}${token ? `#token=${token}` : ''}`;
}

// The offer of an address; null = it holds none.
export function offerOf(search) {
  const asked = new URLSearchParams(search);
  const [job, place] = [asked.get('job'), asked.get('place')];
  return Object.hasOwn(OFFERS, job ?? '') && place ? {job, place} : null;
}

export class Offer {
  // `send(body)` orders, confirms; `jobs()`: the queue; `mayCommand()`: whether anything would be obeyed.
  constructor({send, jobs, mayCommand}) {
    Object.assign(this, {send, jobs, mayCommand, places: null, shown: '', offer: offerOf(location.search)});
    $('offer-close').addEventListener('click', () => this.close());
    document.body.classList.toggle('offered', Boolean(this.offer));
    this.render();
  }

  setPlaces(places) {
    this.places = places.map(({name}) => name);
    this.render();
  }

  close() {
    this.offer = null;
    document.body.classList.remove('offered');
    history.replaceState(null, '', location.pathname);  // a reload offers it no second time
    this.render();
  }

  order(body) {
    this.send(body);
    this.close();
    $('jobs-card').scrollIntoView({block: 'nearest'});
  }

  // The robot that stands at the place and waits for the word.
  waiting({place}, word) {
    return word && this.jobs().find(({state, waits_for: waits, stops, stop}) => state === 'at_stop' && waits === word && place.startsWith(stops[stop]));
  }

  choices({job, place}) {
    const {count, stops, word, said, title} = OFFERS[job];
    const waiting = this.waiting({place}, word);
    if (waiting) return [[said(), {action: 'confirm', job: waiting.id, word}]];
    const order = (places) => ({action: 'add', kind: job === 'guide' ? 'guide' : 'carry', stops: places.map((name) => ({place: name}))});
    return count === 1 ? [[title(place), order(stops(place))]]
      : this.places.filter((name) => name !== place).map((name) => [name, order(stops(place, name))]);
  }

  render() {
    $('offer').hidden = !this.offer;
    if (!this.offer) return;
    const {job, place} = this.offer;
    const {title, question, word} = OFFERS[job];
    const isUnknown = this.places && !this.places.includes(place);
    const text = !this.places ? t`Waiting for the robot …` : isUnknown ? t`This building has no place of that name any more.`
      : !this.mayCommand() ? t`The code holds no token, or an old one: this page may look and press STOP, no more.`
        : this.waiting({place}, word) ? t`The robot is here and waits for you.` : question(place);
    const choices = !this.places || isUnknown || !this.mayCommand() ? [] : this.choices(this.offer);
    const said = JSON.stringify([text, choices]);
    if (said === this.shown) return;
    this.shown = said;
    $('offer-title').textContent = title(place);
    $('offer-text').textContent = text;
    $('offer-text').hidden = !text;
    $('offer-choices').replaceChildren(...choices.map(([name, body]) => {
      const button = Object.assign(document.createElement('button'), {textContent: name, className: choices.length === 1 ? 'primary' : ''});
      button.addEventListener('click', () => this.order(body));
      return button;
    }));
  }
}
