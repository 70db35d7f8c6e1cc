// The map's tiles, inflated and painted into sheets of 8 x 8 tiles, so that a large map is a few pictures to draw. Each
// sheet keeps halves, quarters, ... of itself for looking from afar: no more pixels are read than the screen has.
const SIDE = 64;
const PER_SHEET = 8;
const SHEET = SIDE * PER_SHEET;
const SMALLEST = 4;  // level; 2^4 = 16 times smaller than the sheet

const PRIOR = new ImageData(SIDE, SIDE);  // one tile at a time
const EVIDENCE = new ImageData(SIDE, SIDE);
const BLANK = new ImageData(SIDE, SIDE);
const SETTLED_MS = 1500;  // tiles follow each other ten times a second

const canvasOf = (side) => Object.assign(document.createElement('canvas'), {width: side, height: side});

// A picture and its smaller copies, made when they are looked at.
class Pyramid {
  constructor() {
    this.levels = [canvasOf(SHEET)];
    this.made = 0;  // levels up to this one show what level 0 shows
  }

  put(image, x, y) {
    this.levels[0].getContext('2d').putImageData(image, x, y);
    this.made = 0;
  }

  at(level) {
    for (; this.made < level; ++this.made) {
      const side = SHEET >> (this.made + 1);
      const smaller = this.levels[this.made + 1] ??= canvasOf(side);
      const context = smaller.getContext('2d');
      context.clearRect(0, 0, side, side);
      context.drawImage(this.levels[this.made], 0, 0, side, side);
    }
    return this.levels[level];
  }
}

async function inflate(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export class Tiles {
  constructor(onChange) {
    this.onChange = onChange;
    this.renewed = 0;  // [ms]
    this.geometry = null;
    this.cells = new Map();   // "column,row" -> {column, row, revision, bytes}
    this.shown = new Set();   // keys of those that can be seen
    this.sheets = new Map();  // "column,row" of the sheet -> {prior, evidence}
    this.priorInk = null;     // colour by value of the cell
    this.evidenceInk = null;
  }

  // What is shown is of another time: it stays until its like comes, or until nothing more comes.
  outdate() {
    for (const cell of this.cells.values()) cell.isOld = true;
    this.renewed = performance.now();
  }

  // To be called now and then.
  dropOld() {
    if (performance.now() - this.renewed < SETTLED_MS) return;
    for (const [key, cell] of this.cells) {
      if (!cell.isOld) continue;
      this.cells.delete(key);
      this.shown.delete(key);
      this.put(cell, BLANK, BLANK);
      this.onChange(false);
    }
  }

  async take(tile) {
    if (this.geometry?.session !== tile.session) {
      this.cells.clear();
      this.shown.clear();
      this.sheets.clear();
      this.geometry = {session: tile.session, resolution: tile.resolution, origin: tile.origin, columns: tile.columns,
        rows: tile.rows};
      this.onChange(true);
    }
    const key = `${tile.tile_column},${tile.tile_row}`;
    // shows what it showed until the new bytes are inflated
    const cell = {column: tile.tile_column, row: tile.tile_row, revision: tile.revision, bytes: this.cells.get(key)?.bytes ?? null};
    const session = tile.session;
    this.cells.set(key, cell);
    this.renewed = performance.now();
    const bytes = await inflate(tile.data).catch(() => null);
    if (bytes?.length !== 2 * SIDE * SIDE || this.geometry.session !== session || this.cells.get(key) !== cell) return;
    cell.bytes = bytes;
    this.shown.add(key);
    this.paint(cell);
    this.onChange(false);
  }

  setColours({free, wall, disputed, hit, open}) {
    const ink = ([red, green, blue], alpha) => ((alpha << 24) | (blue << 16) | (green << 8) | red) >>> 0;
    this.priorInk = Uint32Array.from([0, ink(free, 255), ink(wall, 255), ink(disputed, 255)]);
    this.evidenceInk = Uint32Array.from({length: 256}, (_, byte) => {
      const logOdds = (byte << 24) >> 24;  // 20 = log-odds 1
      if (logOdds > 4) return ink(hit, Math.min(255, 40 + 4 * logOdds));
      return logOdds < -4 ? ink(open, Math.min(90, -2 * logOdds)) : 0;
    });
    for (const cell of this.cells.values()) if (cell.bytes) this.paint(cell);
  }

  sheetOf(cell) {
    const column = Math.floor(cell.column / PER_SHEET);
    const row = Math.floor(cell.row / PER_SHEET);
    const key = `${column},${row}`;
    let sheet = this.sheets.get(key);
    if (!sheet) {
      sheet = {column, row, prior: new Pyramid(), evidence: new Pyramid()};
      this.sheets.set(key, sheet);
    }
    return sheet;
  }

  paint(cell) {
    if (!this.priorInk) return;
    const [prior, evidence] = [new Uint32Array(PRIOR.data.buffer), new Uint32Array(EVIDENCE.data.buffer)];
    for (let row = 0; row < SIDE; ++row) {
      const to = (SIDE - 1 - row) * SIDE;  // pictures begin at the top
      for (let column = 0; column < SIDE; ++column) {
        const from = row * SIDE + column;
        prior[to + column] = this.priorInk[cell.bytes[from]] ?? 0;
        evidence[to + column] = this.evidenceInk[cell.bytes[SIDE * SIDE + from]];
      }
    }
    this.put(cell, PRIOR, EVIDENCE);
  }

  put(cell, prior, evidence) {
    const sheet = this.sheetOf(cell);
    const x = (cell.column % PER_SHEET) * SIDE;
    const y = SHEET - SIDE - (cell.row % PER_SHEET) * SIDE;
    sheet.prior.put(prior, x, y);
    sheet.evidence.put(evidence, x, y);
  }

  draw(context, view, layers) {
    if (!this.geometry) return;
    const {resolution, origin} = this.geometry;
    const cell = view.scale * resolution * (window.devicePixelRatio || 1);  // [px] on the screen
    const level = Math.max(0, Math.min(SMALLEST, Math.floor(-Math.log2(cell))));
    context.imageSmoothingEnabled = cell < 1.5;
    for (const sheet of this.sheets.values()) {
      const size = SHEET * resolution;
      const [left, bottom] = view.toScreen(origin[0] + sheet.column * size, origin[1] + sheet.row * size);
      const [right, top] = view.toScreen(origin[0] + (sheet.column + 1) * size, origin[1] + (sheet.row + 1) * size);
      if (right < 0 || left > view.width || bottom < 0 || top > view.height) continue;
      const place = [Math.round(left), Math.round(top), Math.round(right) - Math.round(left),
        Math.round(bottom) - Math.round(top)];
      if (layers.walls) context.drawImage(sheet.prior.at(level), ...place);
      if (layers.evidence) context.drawImage(sheet.evidence.at(level), ...place);
    }
  }

  // Whether a wall or something that the sonars saw lies within `radius` [m] of a point.
  isOccupiedNear(x, y, radius) {
    if (!this.geometry) return false;
    const {resolution, origin} = this.geometry;
    const cells = Math.ceil(radius / resolution);
    const [column, row] = [Math.floor((x - origin[0]) / resolution), Math.floor((y - origin[1]) / resolution)];
    for (let v = -cells; v <= cells; ++v) {
      for (let u = -cells; u <= cells; ++u) {
        if (Math.hypot(u, v) * resolution <= radius && this.isOccupied(column + u, row + v)) return true;
      }
    }
    return false;
  }

  isOccupied(column, row) {
    const bytes = this.cells.get(`${Math.floor(column / SIDE)},${Math.floor(row / SIDE)}`)?.bytes;
    if (!bytes) return false;
    const index = (row % SIDE) * SIDE + column % SIDE;
    return bytes[index] === 2 || ((bytes[SIDE * SIDE + index] << 24) >> 24) > 20;
  }

  bounds() {
    if (!this.geometry) return null;
    const {origin, resolution, columns, rows} = this.geometry;
    return [origin[0], origin[1], origin[0] + columns * resolution, origin[1] + rows * resolution];
  }
}
