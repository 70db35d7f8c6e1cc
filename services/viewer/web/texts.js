// What the page says, in the reader's language. Texts stand in English where they are used; german.js has them by those words.
// What the robot says itself (reasons, causes) stays English.
import {GERMAN} from './german.js';

export const LANGUAGES = {en: null, de: GERMAN};

function chosen() {
  let kept = null;
  try { kept = localStorage.getItem('language'); } catch { /* a browser that keeps nothing */ }
  if (kept in LANGUAGES) return kept;
  const wished = (globalThis.navigator?.languages ?? []).map((language) => language.slice(0, 2));
  return wished.find((language) => language in LANGUAGES) ?? 'en';
}
export const language = chosen();
const table = LANGUAGES[language];
// For dates: the reader's own where it is of that language.
export const locale = globalThis.navigator?.language?.startsWith(language) ? undefined : language;

// t`Drives to ${place}`: in the table stands "Drives to {}"; there {0}, {1} name the values where their order differs.
export function t(parts, ...values) {
  const english = parts.join('{}');
  let next = 0;
  return (table?.[english] ?? english).replace(/\{(\d?)\}/g, (_, number) => values[number === '' ? next++ : Number(number)]);
}
// Of a text that stands in a list.
export const translated = (english) => table?.[english] ?? english;

const SPOKEN = ['title', 'aria-label', 'placeholder'];
// Calls `visit(text, put)` with all that the page's own markup says.
export function eachText(root, visit) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const own = node;
    const text = own.data.trim().replace(/\s+/g, ' ');
    if (text) visit(text, (said) => { own.data = own.data.replace(/\S(.*\S)?/s, () => said); });
  }
  for (const name of SPOKEN) {
    for (const element of root.querySelectorAll(`[${name}]`)) {
      visit(element.getAttribute(name), (said) => element.setAttribute(name, said));
    }
  }
}

// Puts the markup into the reader's language; `button`, if any, switches to the other one.
export function speak(button) {
  document.documentElement.lang = language;
  if (table) eachText(document.body, (text, put) => { if (table[text]) put(table[text]); });
  if (!button) return;
  const other = language === 'en' ? 'de' : 'en';
  Object.assign(button, {textContent: other.toUpperCase(), lang: other, title: other === 'de' ? 'Deutsch' : 'English'});
  button.setAttribute('aria-label', button.title);
  button.addEventListener('click', () => {
    localStorage.setItem('language', other);
    location.reload();
  });
}
