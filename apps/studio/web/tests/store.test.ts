import assert from "node:assert/strict";
import { test } from "node:test";
import { backOff } from "../src/engine/connection";
import type { Histogram, MeshEvent, SceneState, StepRecord } from "../src/engine/protocol";
import { isCoarser, Store } from "../src/engine/store";
import { densityOf, placeOf } from "../src/panels/histogram";
import { chipText } from "../src/app/chip";
import { nextFrame } from "../src/app/sequence";
import { joined, parentOf, withExtension } from "../src/app/paths";
import { stageShares } from "../src/app/stages";

const scene = (done: number, size: number) => ({ done, history: Array(size).fill({}), options: { depth: 8, trim: 0 }, clouds: [] }) as unknown as SceneState;

test("many updates in a task make one change", async () => {
  const store = new Store();
  let changes = 0;
  store.addEventListener("change", () => changes++);
  store.update({ panel: "history" });
  store.setView({ wireframe: true });
  await Promise.resolve();
  assert.equal(changes, 1);
  assert.equal(store.view.wireframe, true);
  assert.equal(store.view.grid, true, "the other settings stay");
  store.update();
  await Promise.resolve();
  assert.equal(changes, 2);
});

test("a surface of fewer triangles than there are is a coarser one, unless it is a preview", () => {
  const mesh = { preview: false, triangles: 100, full_triangles: 400 } as MeshEvent;
  assert.equal(isCoarser(mesh), true);
  assert.equal(isCoarser({ ...mesh, preview: true }), false);
  assert.equal(isCoarser({ ...mesh, triangles: 400 }), false);
});

test("options being dragged lie over those applied", () => {
  const store = new Store();
  store.update({ scene: scene(0, 0), pendingOptions: { depth: 9 } });
  assert.deepEqual(store.options, { depth: 9, trim: 0 });
});

test("undo and redo follow the place in the history", () => {
  const store = new Store();
  assert.deepEqual([store.canUndo, store.canRedo], [false, false]);
  store.update({ scene: scene(1, 2) });
  assert.deepEqual([store.canUndo, store.canRedo], [true, true]);
  store.update({ scene: scene(2, 2) });
  assert.deepEqual([store.canUndo, store.canRedo], [true, false]);
});

test("a notice is said once, and four are shown at most", () => {
  const store = new Store();
  assert.equal(store.addNotice("info", "a"), store.addNotice("info", "a"));
  for (const text of ["b", "c", "d", "e"]) store.addNotice("warning", text);
  assert.deepEqual(store.notices.map((notice) => notice.text), ["b", "c", "d", "e"]);
  store.dropNotice(store.notices[0]!.id);
  assert.equal(store.notices.length, 3);
});

test("attempts to connect come at 250 ms first and every 8 s at last", () => {
  assert.deepEqual([0, 1, 2, 5, 30].map(backOff), [250, 500, 1000, 8000, 8000]);
});

test("the chip says what changed and no more", () => {
  const topology = (components: number, genus: number) => ({ components, genus, euler: 2 * (components - genus) });
  const record = { operation: "guide", added: 1204, removed: 0, points: 1, triangles: 1, edit_ms: 1, reconstruct_ms: 1, total_ms: 2 };
  const of = (patch: object) => chipText({ ...record, before: topology(2, 3), after: topology(1, 1), ...patch } as StepRecord);
  assert.equal(of({}), "+1,204 points, genus 3 → 1, components 2 → 1");
  assert.equal(of({ added: 0, removed: 7, after: topology(2, 3) }), "−7 points");
  assert.equal(of({ added: 0, after: topology(2, 3) }), "topology unchanged");
  assert.equal(of({ after: null }), "+1,204 points", "until it is measured");
  assert.equal(of({ added: 0, flipped: 5, after: null }), "5 normals turned");
});

test("a quantile of the densities is found between the engine's", () => {
  const histogram: Histogram = { densities: { edges: [1, 10, 100], counts: [0.25, 0.75], log: true }, quantiles: [[0, 0], [0.1, 2], [0.5, 20]] };
  assert.equal(densityOf(histogram, 0), 0);
  assert.equal(densityOf(histogram, 0.05), 1);
  assert.ok(Math.abs(densityOf(histogram, 0.3) - 11) < 1e-12);
  assert.equal(densityOf(histogram, 0.9), 20);
  assert.equal(placeOf(histogram, 10), 0.5);
  assert.equal(placeOf(histogram, 0.5), 0);
  assert.equal(placeOf(histogram, 1000), 1);
});

test("playing goes on, loops or ends", () => {
  assert.equal(nextFrame({ index: 3, frames: 10, loop: false }), 4);
  assert.equal(nextFrame({ index: 9, frames: 10, loop: true }), 0);
  assert.equal(nextFrame({ index: 9, frames: 10, loop: false }), null);
  assert.equal(nextFrame({ index: 0, frames: 1, loop: true }), null);
});

test("stages are shares of what was measured", () => {
  const shares = stageShares({ octree: 10, solve: 30, total: 999 });
  assert.deepEqual(shares, [
    { stage: "octree", ms: 10, share: 0.25 },
    { stage: "solve", ms: 30, share: 0.75 },
  ]);
});

test("folders end at the roots", () => {
  assert.equal(parentOf("/scans/old", ["/scans"]), "/scans");
  assert.equal(parentOf("/scans", ["/scans"]), null);
  assert.equal(parentOf("/scans2/x", ["/scans"]), null);
  assert.equal(parentOf("/a", ["/"]), "/");
  assert.equal(joined("/scans/", "a.ply"), "/scans/a.ply");
  assert.equal(joined("", "a.ply"), "a.ply");
  assert.equal(withExtension("hand.v2.ply", ".obj"), "hand.v2.obj");
});
