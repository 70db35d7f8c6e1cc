// The map as a picture to keep: walls, what the sonars saw, lamps and places, at the map's own resolution.
import * as draw from './layers.js';

const MAX_PX = 6000;  // of a side; browsers have limits

export function mapPicture(tiles, building, colours) {
  const [left, bottom, right, top] = tiles.bounds();
  const scale = Math.min(Math.max(1 / tiles.geometry.resolution, 20), MAX_PX / Math.max(right - left, top - bottom));  // [px/m]
  const canvas = document.createElement('canvas');
  canvas.width = Math.round((right - left) * scale);
  canvas.height = Math.round((top - bottom) * scale);
  const view = {scale, width: canvas.width, height: canvas.height, toScreen: (x, y) => [(x - left) * scale, (top - y) * scale]};
  const context = canvas.getContext('2d');
  context.fillStyle = colours.outside;
  context.fillRect(0, 0, canvas.width, canvas.height);
  tiles.draw(context, view, {walls: true, evidence: true});
  if (building) {
    draw.drawFixtures(context, view, building, colours);
    draw.drawZones(context, view, building, colours);
    draw.drawPlaces(context, view, building, colours);
  }
  return canvas;
}

export function download(blob, name) {
  const link = Object.assign(document.createElement('a'), {download: name, href: URL.createObjectURL(blob)});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
