// Debian's chromium on a page of the studio, driven by real pointer and key events.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { Client } from './client.mjs';
import { require } from './packages.mjs';
import { Program } from './program.mjs';
import { decode } from './pixels.mjs';

const { chromium } = require('playwright-core');

const candidates = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
export const executablePath = candidates.find(path => path && existsSync(path));

/** A reason to skip where there is no chromium; with POINTSKIN_REQUIRE_CHROMIUM=1 there must be one. */
export function noBrowser() {
  if (executablePath) return false;
  if (process.env.POINTSKIN_REQUIRE_CHROMIUM === '1') throw new Error('there is no chromium, and it is required');
  return 'there is no chromium';
}

const flags = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-background-networking', '--mute-audio'];

/** The picture of a page's canvas, when all that was asked for is drawn, with all its pixels. */
export async function pictureOf(page) {
  const canvas = page.getByTestId('viewport');
  await canvas.and(page.locator('[data-frame="whole"]')).waitFor();
  return decode(await canvas.screenshot());
}

/** A program, a page on it and a client that hears what the server says. */
export class Studio {
  /**
   * @param {{args?: string[], folder?: string, width?: number, height?: number, ratio?: number, theme?: 'dark'|'light',
   *          query?: string}} options
   */
  static async open(options = {}) {
    const self = new Studio();
    self.program = await Program.start(options);
    self.client = await Client.connect(self.program);
    self.browser = await chromium.launch({ executablePath, args: flags });
    self.context = await self.browser.newContext({
      viewport: { width: options.width ?? 1280, height: options.height ?? 800 },
      deviceScaleFactor: options.ratio ?? 1, colorScheme: options.theme ?? 'dark', reducedMotion: 'reduce' });
    self.page = await self.newPage(options.query);
    return self;
  }

  problems = [];

  /** One more tab, which hears keys. */
  async newPage(query = '?test=1') {
    const page = await this.context.newPage();
    page.on('pageerror', error => this.problems.push(String(error)));
    page.on('console', message => { if (message.type() === 'error') this.problems.push(message.text()); });
    const { origin, token } = this.program;
    await page.goto(`${origin}/${query}#${token}`);
    await page.locator('psk-top-bar').waitFor();  // the canvas is there before the keys are listened to
    return page;
  }

  at(id) { return this.page.getByTestId(id); }

  /** Waits until the page has drawn a mesh that was announced at or after the event number `since`. */
  async drawn(since = 0, accepts = event => !event.preview) {
    const mesh = await this.client.event('mesh', accepts, { since });
    await this.page.waitForFunction(version => performance.getEntriesByName('psk:mesh-drawn')
      .some(mark => mark.detail?.version >= version), mesh.version, { timeout: 60_000 });
    return mesh;
  }

  /** The canvas in pixels of the page: {x, y, width, height}. */
  canvas() { return this.at('viewport').boundingBox(); }

  /** The picture of the canvas; of one that moves all the time, as it is now. */
  async picture({ moves = false } = {}) {
    return moves ? decode(await this.at('viewport').screenshot()) : pictureOf(this.page);
  }

  /** Takes pictures until one is as it should be, however slow the machine is; after a minute fails, saying `what`. */
  async seen(what, accepts, options) {
    const end = Date.now() + 60_000;
    while (!accepts(await this.picture(options))) {
      assert.ok(Date.now() < end, what);
      await this.page.waitForTimeout(100);
    }
  }

  /** Presses, moves through the places (pixels of the page) and releases. */
  async drag(places, { button = 'left', steps = 6, modifiers = [] } = {}) {
    const { keyboard, mouse } = this.page;
    for (const key of modifiers) await keyboard.down(key);
    await mouse.move(...places[0]);
    await mouse.down({ button });
    for (const place of places.slice(1)) await mouse.move(...place, { steps });
    await mouse.up({ button });
    for (const key of modifiers) await keyboard.up(key);
  }

  press(key) { return this.page.keyboard.press(key); }

  async close() {
    await this.browser?.close();
    this.client?.close();
    await this.program?.kill();
  }
}
