// One person's window onto the robot: what they see and what they press.
import {until} from './running_system.mjs';

export class Page {
  static async open(browser, address, folder, name, options) {
    const context = await browser.newContext(options);
    const page = new Page();
    Object.assign(page, {context, folder, name, isTouch: Boolean(options.hasTouch), complaints: []});
    page.page = await context.newPage();
    page.page.on('pageerror', (error) => page.complaints.push(`${name}: ${error.message}`));
    await page.page.addInitScript(() => {
      addEventListener('pointerdown', (event) => { window.pressedAt = performance.timeOrigin + event.timeStamp; }, true);
    });
    await page.page.goto(address);
    return page;
  }

  text(selector) { return this.page.textContent(selector).then((text) => text.trim()); }

  // Waits until an element says something.
  says(selector, pattern, seconds = 5) {
    return until(`${this.name}: ${selector} says ${pattern}`, seconds, async () => pattern.test(await this.text(selector)),
      () => '');
  }

  isShown(selector) { return this.page.isVisible(selector); }

  async press(selector) {
    if (this.isTouch) await this.page.tap(selector); else await this.page.click(selector);
  }

  // Where a point of the world is on the screen.
  async onScreen(x, y) {
    return this.page.$eval('#map', (canvas, [worldX, worldY]) => {
      const [centreX, centreY, scale] = canvas.dataset.view.split(' ').map(Number);
      const box = canvas.getBoundingClientRect();
      return [box.left + box.width / 2 + (worldX - centreX) * scale, box.top + box.height / 2 - (worldY - centreY) * scale];
    }, [x, y]);
  }

  async tapWorld(x, y) {
    await this.page.$eval('#map', (canvas) => canvas.scrollIntoView({block: 'end'}));
    const [px, py] = await this.onScreen(x, y);
    if (this.isTouch) await this.page.touchscreen.tap(px, py); else await this.page.mouse.click(px, py);
  }

  // Goes there by a tap on the map; with a heading, drags the knob that the tap brings up.
  async goTo(x, y, theta) {
    await this.tapWorld(x, y);
    if (theta !== undefined) await this.turnKnob(x, y, theta);
    await this.press('#ask-go');
  }

  async turnKnob(x, y, theta) {
    const knob = 44;  // [px] from the goal, first to the east
    const [px, py] = await this.onScreen(x, y);
    await this.page.mouse.move(px + knob, py);
    await this.page.mouse.down();
    for (let part = 1; part <= 4; ++part) {
      await this.page.mouse.move(px + knob * Math.cos(theta * part / 4), py - knob * Math.sin(theta * part / 4));
    }
    await this.page.mouse.up();
  }

  pressedAt() { return this.page.evaluate(() => window.pressedAt); }  // [ms] since the epoch

  async inTheme(theme) {
    const now = await this.page.$eval('html', (html) => html.dataset.theme);
    if (now !== theme) await this.press('#theme-button');
  }

  async picture(title) {
    await this.page.evaluate(() => new Promise((painted) => requestAnimationFrame(() => requestAnimationFrame(painted))));
    await this.page.screenshot({path: `${this.folder}/${title}.png`, animations: 'disabled'});
  }
}
