import "./page";
import assert from "node:assert/strict";
import { test } from "node:test";
import type { DeformOperation, Pixel, Vec3 } from "../../src/engine/protocol";
import { bend } from "../../src/tools/bend";
import { lattice } from "../../src/tools/lattice";
import { controlPoints, dragBy, edges, grown, pointAt, pointsIn } from "../../src/tools/shared/lattice_grid";
import { Snapshots } from "../../src/tools/shared/snapshots";
import { distance } from "../../src/tools/shared/vec";
import { View } from "../../src/tools/shared/view";
import { fakeContext, key, pointer, settled } from "./fake_context";

function pixelOf(view: View, p: Vec3): Pixel {
  const at = view.project(p)!;
  return [at.x, at.y];
}
const hit = (point: Vec3) => ({ hit: { point, normal: [0, 0, 1] as Vec3 } });

/// A bend tool with a handle that holds at the origin and one at (2, 2, 2), which is chosen.
function bendWithTwo() {
  const fake = fakeContext();
  const tool = bend(fake.context);
  tool.activate!();
  const view = new View(fake.view.camera);
  for (const p of [[0, 0, 0], [2, 2, 2]] as Vec3[]) {
    assert.ok(tool.pointerDown!(pointer(...pixelOf(view, p), hit(p))));
    tool.pointerUp!(pointer(...pixelOf(view, p)));
  }
  return { ...fake, tool, view };
}

test("clicks set handles, and setting them moves nothing", async () => {
  const { sent } = bendWithTwo();
  await settled();
  assert.deepEqual(sent, []);
});

test("a drag previews every move and is one step when it ends", async () => {
  const { tool, sent, view } = bendWithTwo();
  const [x, y] = pixelOf(view, [2, 2, 2]);
  tool.pointerDown!(pointer(x, y));
  for (let i = 1; i <= 5; ++i) {
    tool.pointerMove!(pointer(x + 10 * i, y));
    await settled();
  }
  tool.pointerUp!(pointer(x + 50, y));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "preview", "preview", "preview", "preview", "apply"]);
  const { handles } = sent[5]!.body.operation as DeformOperation;
  assert.deepEqual(Object.keys(handles![0]!), ["region"], "the other one holds");
  const to = view.dragged([2, 2, 2], 50, 0);
  assert.ok(distance(handles![1]!.rigid!.translation!, [to[0] - 2, to[1] - 2, to[2] - 2]) < 1e-9);
});

test("the next drag begins where the last has ended", async () => {
  const { tool, sent, view } = bendWithTwo();
  const [x, y] = pixelOf(view, [2, 2, 2]);
  for (const from of [x, x + 50]) {
    tool.pointerDown!(pointer(from, y));
    tool.pointerMove!(pointer(from + 50, y));
    tool.pointerUp!(pointer(from + 50, y));
    await settled();
  }
  const steps = sent.filter((s) => s.verb === "apply").map((s) => (s.body.operation as DeformOperation).handles![1]!);
  assert.equal(steps.length, 2);
  const centre = (steps[1]!.region["ball"] as { centre: Vec3 }).centre;
  assert.ok(distance(centre, view.dragged([2, 2, 2], 50, 0)) < 1e-9);
});

test("undo brings the handle back to where it was", async () => {
  const { tool, sent, view, store } = bendWithTwo();
  const [x, y] = pixelOf(view, [2, 2, 2]);
  tool.pointerDown!(pointer(x, y));
  tool.pointerMove!(pointer(x + 50, y));
  tool.pointerUp!(pointer(x + 50, y));
  await settled();
  store.update({ scene: { ...store.scene!, done: 1 } });
  await settled();
  store.update({ scene: { ...store.scene!, done: 0 } });
  await settled();
  tool.pointerDown!(pointer(x, y));
  tool.pointerMove!(pointer(x, y - 30));
  tool.pointerUp!(pointer(x, y - 30));
  await settled();
  assert.equal(sent.filter((s) => s.verb === "apply").length, 2, "the gizmo is where it was");
  const last = (sent[sent.length - 1]!.body.operation as DeformOperation).handles![1]!;
  assert.deepEqual((last.region["ball"] as { centre: Vec3 }).centre, [2, 2, 2]);
});

test("keys move a handle without applying it, Enter applies, Esc takes it back", async () => {
  const { tool, sent } = bendWithTwo();
  assert.ok(tool.keyDown!(key("ArrowRight", { shiftKey: true })));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview"]);
  assert.ok(tool.keyDown!(key("Escape")));
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "preview_end"]);
  tool.keyDown!(key("ArrowRight"));
  tool.keyDown!(key("Enter"));
  await settled();
  assert.equal(sent[sent.length - 1]!.verb, "apply");
});

test("a click beside the surface turns the view, and Delete removes a handle", async () => {
  const { tool, sent } = bendWithTwo();
  assert.equal(tool.pointerDown!(pointer(20, 20)), false);
  assert.ok(tool.keyDown!(key("Delete")));
  assert.ok(tool.keyDown!(key("Delete")));
  assert.ok(!tool.keyDown!(key("Delete")));
  assert.deepEqual(sent, []);
});

// ---- lattice ----

const cube = { box: { lower: [0, 0, 0] as Vec3, upper: [2, 2, 2] as Vec3 }, spans: [2, 1, 1] as Vec3, moves: new Map<string, Vec3>(), outside: "extend" as const };

test("control points are where the engine has them, the moved ones with their moves", () => {
  const points = controlPoints({ ...cube, moves: new Map([["1,0,1", [0, 0, 0.5]]]) });
  assert.equal(points.length, 12);
  assert.deepEqual(points[0], { key: "0,0,0", at: [0, 0, 0] });
  assert.deepEqual(points.find((p) => p.key === "1,0,1")!.at, [1, 0, 2.5]);
  assert.equal(edges(cube).length, 2 * 4 + 3 * 2 + 3 * 2);
});

test("of control points behind one another the nearest is gripped", () => {
  const { view } = fakeContext();
  const front = new View({ ...view.camera, view: [1, 0, 0, -1, 0, 0, 1, -1, 0, -1, 0, -9, 0, 0, 0, 1] }); // looks along +y
  const points = controlPoints({ ...cube, spans: [1, 1, 1] });
  const [x, y] = pixelOf(front, [0, 0, 0]);
  assert.equal(pointAt(points, front, [x + 2, y], 9)?.key, "0,0,0");
  assert.equal(pointAt(points, front, [x + 200, y], 9), null);
  assert.deepEqual(pointsIn(points, front, [0, 0, 900, 600]).length, 8);
});

test("a control point follows the pointer in the view, or keeps to an axis", () => {
  const view = new View(fakeContext().view.camera);
  const from: Vec3 = [2, 2, 2];
  const [before, now] = [pixelOf(view, from), pixelOf(view, [2.4, 2, 2])];
  assert.ok(distance(dragBy(view, from, before, now, "x"), [0.4, 0, 0]) < 1e-9);
  const free = dragBy(view, from, before, now, "view");
  const [px, py] = pixelOf(view, [from[0] + free[0], from[1] + free[1], from[2] + free[2]]);
  assert.ok(Math.hypot(px - now[0], py - now[1]) < 1e-6);
});

test("a drag of a control point of the tool is one step with one move", async () => {
  const { context, sent, view } = fakeContext();
  const tool = lattice(context);
  tool.activate!();
  const box = grown(context.viewport.box, 0.04);
  const camera = new View(view.camera);
  const [x, y] = pixelOf(camera, box.upper);
  assert.ok(tool.pointerDown!(pointer(x, y)));
  tool.pointerMove!(pointer(x + 20, y - 20));
  tool.pointerUp!(pointer(x + 20, y - 20));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "apply"]);
  const [json] = (sent[1]!.body.operation as DeformOperation).lattices!;
  assert.deepEqual([json!.box, json!.spans, json!.outside], [box, [2, 2, 2], "extend"]);
  assert.equal(json!.moves!.length, 1);
  assert.deepEqual(json!.moves![0]!.at, [2, 2, 2]);
});

test("snapshots: a new step forgets those that were undone", () => {
  const snapshots = new Snapshots<string>();
  snapshots.step(0, "a", "b");
  snapshots.step(1, "b", "c");
  assert.equal(snapshots.arrive(0), "a");
  assert.equal(snapshots.arrive(0), null, "nothing has moved");
  snapshots.step(0, "a", "d");
  assert.equal(snapshots.arrive(1), "d");
  assert.equal(snapshots.arrive(2), null);
});
