// The panels on the right, from the pointer to what the server says: options that are live, trim, section, comparison,
// problems, history.
import assert from 'node:assert/strict';
import test from 'node:test';
import { panel, slide, state } from './actions.mjs';
import { noBrowser, Studio } from './browser.mjs';
import { changedBox } from './pixels.mjs';

/** A studio on a torus. */
async function torus() {
  const studio = await Studio.open();
  const since = studio.client.events.length;
  await studio.client.request('open', { files: [{ shape: 'torus', points: 6000 }], options: { depth: 6 } });
  await studio.drawn(since);
  return studio;
}

test('depth is live, and one drag is one step that can be undone', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await torus();
  try {
    const before = await studio.client.digest();
    const since = studio.client.events.length;
    await slide(studio, 'opt-depth', 0.35, { steps: 20, pause: 150 });
    const scene = await state(studio, since, now => now.done === 1);
    assert.equal(scene.history[0].operation.op, 'options');
    assert.notEqual(scene.options.depth, 6);
    assert.equal(scene.history.length, 1);
    assert.ok(studio.client.events.slice(since).some(event => event.event === 'mesh' && event.preview), 'a preview came');
    assert.notEqual(await studio.client.digest(), before);
    await panel(studio, 'history');
    await studio.at('history-item-0').waitFor();
    await studio.press('Control+z');
    await state(studio, since, now => now.done === 0 && now.history.length === 1);
    assert.equal(await studio.client.digest(), before);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});

test('trim cuts what was tinted', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open({ args: ['--demo'] });
  try {
    await studio.drawn();
    const whole = (await state(studio, 0, now => now.triangles > 0)).triangles;  // a mesh may be drawn before it is told
    const plain = await studio.picture();
    const since = studio.client.events.length;
    const slider = studio.at('opt-trim');
    await slider.focus();
    for (let i = 0; i < 12; i += 1) await studio.press('ArrowRight');
    await studio.seen('what goes is seen', picture => changedBox(picture, plain));  // the tint comes with the next preview
    const scene = await state(studio, since, now => now.done > 0 && now.options.trim > 0);
    assert.ok(scene.triangles < whole, `${scene.triangles} triangles of ${whole}`);
    assert.equal(scene.surface.closed, false);
  } finally {
    await studio.close();
  }
});

test('a section plane cuts the view, and nothing else', { skip: noBrowser(), timeout: 120_000 }, async () => {
  const studio = await torus();
  try {
    const before = await studio.client.digest();
    const whole = await studio.picture();
    await panel(studio, 'surface');
    await studio.at('section').click();
    await slide(studio, 'section-place', 0.3);
    await studio.seen('half of the torus is gone from the picture', picture => changedBox(picture, whole)?.pixels > 2000);
    assert.equal(await studio.client.digest(), before);
  } finally {
    await studio.close();
  }
});

test('compare with a shape shows a table and a heat map', { skip: noBrowser(), timeout: 120_000 }, async () => {
  const studio = await torus();
  try {
    await studio.client.request('save', { what: 'mesh', name: 'reference.obj' });
    const plain = await studio.picture();
    const since = studio.client.events.length;
    await panel(studio, 'surface');
    await studio.at('compare').click();
    await studio.at('file-reference.obj').click();
    await studio.at('open-confirm').click();
    await studio.at('comparison').waitFor();
    assert.match(await studio.at('comparison').innerText(), /both/);
    const shown = await studio.client.event('mesh', event => event.values.includes('distance'), { since });
    assert.ok(shown.triangles > 0);
    await studio.seen('the distances are seen', picture => changedBox(picture, plain)?.pixels > 2000);
    await studio.at('reference-end').click();
  } finally {
    await studio.close();
  }
});

test('problems are listed, and a click goes there', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open({ args: ['--demo'] });
  try {
    await studio.drawn();
    await panel(studio, 'problems');
    await studio.at('find-problems').click();
    const first = studio.at('problems-item-0');
    await first.waitFor({ timeout: 60_000 });
    const { regions } = await studio.client.request('problems');
    assert.ok(regions.length > 0 && regions[0].score >= regions.at(-1).score);
    const before = await studio.picture();
    await first.click();
    await studio.seen('the camera went there', picture => changedBox(picture, before)?.pixels > 2000);
  } finally {
    await studio.close();
  }
});
