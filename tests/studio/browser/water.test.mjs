// Water: a scene that is simulated live and pushed by the mouse, and frames of a sequence with their timeline.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import test from 'node:test';
import { placeIn } from './actions.mjs';
import { noBrowser, Studio } from './browser.mjs';
import { changedBox, colours } from './pixels.mjs';
import { runProgram, temporaryFolder } from './program.mjs';

const frames = studio => studio.client.events.filter(event => event.event === 'frame');

test('live water is pushed by the mouse', { skip: noBrowser(), timeout: 240_000 }, async () => {
  const studio = await Studio.open();
  try {
    await studio.press('w');
    await studio.at('fluid-scene').selectOption('stir').catch(() => {});
    await studio.at('fluid-start').click();
    await studio.client.event('frame', frame => frame.index >= 3, { timeout: 120_000 });
    await studio.seen('the water is seen', picture => colours(picture) > 20, { moves: true });
    const { x, y, width, height } = await studio.canvas();
    const calm = frames(studio).at(-1).max_speed;
    const pushing = frames(studio).length;
    const { mouse } = studio.page;
    await mouse.move(x + 0.4 * width, y + 0.55 * height);
    await mouse.down();
    for (let i = 0; i < 40 || frames(studio).length < pushing + 8; i += 1) {
      await mouse.move(x + (0.4 + 0.2 * Math.abs(Math.sin(i / 4))) * width, y + 0.55 * height);
      await studio.page.waitForTimeout(60);
    }
    const pushed = Math.max(...frames(studio).slice(-8).map(frame => frame.max_speed));
    await mouse.up();
    assert.ok(pushed > calm, `${pushed} m/s where it was ${calm}`);
    await studio.at('fluid-stop').click();
    const stopped = async () => (await studio.client.ask('fluid')).error?.code === 'usage';  // there is no water any more
    while (!await stopped()) await studio.page.waitForTimeout(50);
    const count = frames(studio).length;
    await studio.page.waitForTimeout(700);
    assert.equal(frames(studio).length, count, 'stopped');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});

test('a sequence is played, stepped and scrubbed', { skip: noBrowser(), timeout: 240_000 }, async () => {
  const folder = temporaryFolder();
  const made = runProgram('fluid', '--simulate', 'drop', '--particles', '1500', '--frames', '6', '--particles-out',
    join(folder, 'frame_{}.ply'), '-q');
  assert.equal(made.status, 0, made.stderr);
  const studio = await Studio.open({ folder });
  try {
    await studio.press('Control+o');
    await studio.at('file-frame_{}.ply').click();
    await studio.at('open-confirm').click();
    await studio.at('timeline').waitFor();
    await studio.client.event('frame', frame => frame.index === 0, { timeout: 60_000 });
    await studio.seen('the first frame is seen', picture => colours(picture) > 20);
    const first = await studio.picture();
    await studio.at('timeline-next').click();
    await studio.client.event('frame', frame => frame.index === 1);
    const scrub = studio.at('timeline-scrub');
    await studio.page.mouse.click(...(await placeIn(scrub, 0.98)));
    await studio.client.event('frame', frame => frame.index === 5);
    await studio.seen('the last frame is another one', picture => changedBox(picture, first));
    const since = studio.client.events.length;
    await studio.at('timeline-play').click();
    for (const index of [0, 1, 2]) await studio.client.event('frame', frame => frame.index === index, { since });
    await studio.at('timeline-play').click();
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
