// Two tabs on one scene see the same, whichever of them works on it. When the program is killed and started again with
// its session, the tabs say that it asks for its new address, and go on by themselves when one of them has opened it.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, pictureOf, Studio } from './browser.mjs';
import { Client } from './client.mjs';
import { Program } from './program.mjs';
import { changedBox } from './pixels.mjs';
import { ghostsOf, openShape, step } from './steps.mjs';

/** Waits until the page has drawn that version of the mesh. */
const drawn = (page, version) => page.waitForFunction(least => performance.getEntriesByName('psk:mesh-drawn')
  .some(mark => mark.detail?.version >= least), version, { timeout: 60_000 });

/** Waits until the page says that the scene has so many points. */
async function showsPoints(page, points) {
  await page.getByTestId('status-points').filter({ hasText: points.toLocaleString('en') }).waitFor({ timeout: 60_000 });
}

/** Both tabs from the same side, without what floats over the view. @returns how many pixels differ */
async function difference(first, second) {
  const pictures = [];
  for (const page of [first, second]) {
    await page.bringToFront();
    await page.getByTestId('tool-navigate').click();
    await page.getByTestId('viewport').focus();
    await page.keyboard.press('1');
    await page.keyboard.press('f');
    await page.mouse.move(640, 790);
    await page.getByTestId('chip').waitFor({ state: 'hidden', timeout: 30_000 });
    pictures.push(await pictureOf(page));
  }
  return changedBox(...pictures)?.pixels ?? 0;
}

test('two tabs see the same, and go on after a restart', { skip: noBrowser(), timeout: 300_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    const second = await studio.newPage();
    await second.bringToFront();
    await showsPoints(second, scene.points);
    await second.keyboard.press('5');  // orthographic, as the first tab is

    await studio.page.bringToFront();
    await studio.press('r');
    await ghostsOf(studio, () => studio.drag([at([0.5, -0.2, 0]), at([0.9, 0.2, 0])]));
    const done = await step(studio, 1, () => studio.press('Enter'));
    await second.bringToFront();
    await showsPoints(second, done.scene.points);
    const { version } = studio.client.events.filter(event => event.event === 'mesh' && !event.preview).at(-1);
    await drawn(second, version);
    assert.equal(await difference(studio.page, second), 0, 'both tabs show the same');

    await second.bringToFront();
    await second.keyboard.press('Control+z');
    await studio.page.bringToFront();
    await showsPoints(studio.page, scene.points);
    assert.equal(await studio.client.digest(), digest, 'undone in the other tab');
    await studio.press('Control+Shift+Z');
    await showsPoints(second, done.scene.points);
    assert.deepEqual(studio.problems, []);

    await restarted(studio, second, done);
  } finally {
    await studio.close();
  }
});

/** Kills the program, starts it on the same port with its session, and signs in in the second tab. */
async function restarted(studio, second, done) {
  const { folder, origin } = studio.program;
  await studio.program.kill('SIGKILL');
  await studio.at('connection-banner').waitFor();
  studio.client.close();
  studio.program = await Program.start({ folder, args: ['--resume', '--port', new URL(origin).port] });
  assert.equal(studio.program.origin, origin, 'the same port');
  for (const page of [studio.page, second]) {
    await page.bringToFront();
    const banner = page.getByTestId('refused-banner');
    await banner.waitFor({ timeout: 60_000 });
    assert.match(await banner.innerText(), /open the address that it printed/i, 'what to do is said');
  }
  await second.goto(studio.program.url);  // differs after # alone: nothing is loaded anew
  for (const page of [second, studio.page]) {
    await page.bringToFront();
    await page.getByTestId('refused-banner').waitFor({ state: 'hidden', timeout: 60_000 });
    await showsPoints(page, done.scene.points);
  }
  assert.equal(new URL(second.url()).hash, '', 'the secret is not in the address');
  studio.client = await Client.connect(studio.program);
  assert.equal(await studio.client.digest(), done.digest, 'nothing is lost');
  const since = studio.client.events.length;
  await studio.at('viewport').focus();
  await studio.press('Control+z');
  await studio.client.event('state', event => event.scene.done === 0, { since });
}
