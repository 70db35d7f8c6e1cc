// The page's modules for a program that is no browser.
import {copyFileSync, mkdirSync, readdirSync, writeFileSync} from 'node:fs';

// Puts those of SOURCE into a folder below `folder` where Node takes them for modules, and returns it.
export function copyModules(source, folder) {
  const web = `${source}/services/viewer/web`;
  const copied = `${folder}/modules`;
  mkdirSync(copied, {recursive: true});
  writeFileSync(`${copied}/package.json`, '{"type": "module"}\n');
  for (const name of readdirSync(web).filter((file) => file.endsWith('.js'))) copyFileSync(`${web}/${name}`, `${copied}/${name}`);
  return copied;
}
