// What tests of tools have in common: a generated shape seen from the front, a step that is done by the hand, and the
// step undone.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { colours } from './pixels.mjs';
import { frontView } from './projection.mjs';

/**
 * Opens a generated shape and looks at it from the front, orthographically.
 * @returns {Promise<{scene, at: (place: number[]) => number[], digest: string}>} `at`: pixels of the page of a place
 */
export async function openShape(studio, shape, { points = 5000, depth = 6 } = {}) {
  await studio.client.request('open', { files: [{ shape, points }], options: { depth } });
  await studio.drawn();
  const { scene } = await studio.client.event('state', event => event.scene?.surface);
  const at = await frontView(studio, scene.box);
  await assertSeen(studio);
  return { scene, at, digest: await studio.client.digest() };
}

/** The canvas is not blank. */
export async function assertSeen(studio) {
  assert.ok(colours(await studio.picture()) > 20, 'the canvas shows something');
}

/**
 * Does `act`, which makes the step number `done` (from 1) of the history, and waits until the page shows it.
 * @returns {Promise<{operation, record, scene, digest}>} what the server says of it
 */
export async function step(studio, done, act) {
  const since = studio.client.events.length;
  await act();
  await studio.drawn(since);
  const measured = ({ scene }) => scene.done === done && scene.surface && scene.history[done - 1].record.after.components > 0;
  const { scene } = await studio.client.event('state', measured, { since });
  await studio.at('chip').waitFor();
  await assertSeen(studio);
  return { ...scene.history[done - 1], scene, digest: await studio.client.digest() };
}

/** Undoes the step number `done` by its keys; the mesh is then the bytes that it was. */
export async function undo(studio, done, digest) {
  const since = studio.client.events.length;
  await studio.at('viewport').focus();
  await studio.press('Control+z');
  await studio.client.event('state', event => event.scene.done === done - 1, { since });
  assert.equal(await studio.client.digest(), digest, `step ${done} undone: the old bytes`);
  await studio.drawn(since);
}

/** Waits for a preview of points that `act` asks for. @returns its numbers: {added, removed} */
export async function ghostsOf(studio, act) {
  const since = studio.client.events.length;
  await act();
  return studio.client.event('ghosts', event => event.added + event.removed > 0, { since });
}

/** The operations with all their numbers, as the program saves them. */
export async function script({ client, program }) {
  await client.request('save', { what: 'script', name: 'script.json', folder: '', overwrite: true });
  return JSON.parse(readFileSync(join(program.folder, 'script.json'), 'utf8')).operations;
}

/** The box in the world of the newest committed mesh, from the header of its blob. */
export async function meshBox({ client }) {
  const { blob } = client.events.filter(event => event.event === 'mesh' && !event.preview).at(-1);
  const data = await client.get(`/blob/${blob}?coding=raw`);
  return JSON.parse(data.subarray(16, 16 + data.readUInt32LE(8)).toString('utf8')).box;
}

/** Places around the origin of the plane of the picture. */
export function circle(radius, corners = 24) {
  return Array.from({ length: corners + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / corners;
    return [radius * Math.cos(angle), radius * Math.sin(angle), 0];
  });
}

/** Volume of the part of the cube from -1 to 1 where `inside` is true. */
export function volumeOf(inside) {
  const n = 100;
  const place = i => (2 * i + 1) / n - 1;
  let found = 0;
  for (let i = 0; i < n; i += 1)
    for (let j = 0; j < n; j += 1)
      for (let k = 0; k < n; k += 1) found += inside(place(i), place(j), place(k)) ? 1 : 0;
  return 8 * found / n ** 3;
}

/** `actual` is `expected` to within a share of it. */
export function assertNear(actual, expected, share, what) {
  assert.ok(Math.abs(actual - expected) <= share * Math.abs(expected), `${what}: ${actual}, expected about ${expected}`);
}

/** Where a part of the gizmo or another mark of the overlay is on the page. */
export async function markAt(studio, id) {
  const mark = studio.at(id).first();
  const canvas = await studio.canvas();
  return [canvas.x + Number(await mark.getAttribute('data-x')), canvas.y + Number(await mark.getAttribute('data-y'))];
}

/** Chooses an entry of a list by typing its first letters, as the keyboard does. */
export async function choose(studio, id, label) {
  await studio.at(id).focus();
  await studio.page.keyboard.type(label);
  await studio.at('viewport').focus();
}
