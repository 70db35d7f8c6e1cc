import {t} from './texts.js';

// One value that makes no sense must not keep the rest of the page from being renewed.
const broken = new Map();  // subject -> since when [ms]

export function guarded(subject, action) {
  try {
    action();
    broken.delete(subject);
  } catch (error) {
    if (!broken.has(subject)) {
      broken.set(subject, performance.now());
      console.error(subject, error);
    }
  }
}

// A sentence while something cannot be shown, else ''.
export function whatIsBroken() {
  return broken.size ? t`This page cannot show ${[...broken.keys()].join(', ')}: what stands there is old.` : '';
}
