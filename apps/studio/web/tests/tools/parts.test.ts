import "./page";
import assert from "node:assert/strict";
import { test } from "node:test";
import type { BooleanOperation, Box, InsertOperation, Pixel, Vec3 } from "../../src/engine/protocol";
import { combine } from "../../src/tools/combine";
import { copyPart } from "../../src/tools/copy_part";
import { section, turnTo } from "../../src/tools/section";
import { boxOfLayer } from "../../src/tools/shared/ghost_box";
import { dragFace, faceAt, placed } from "../../src/tools/shared/part_box";
import { poseAt, turned } from "../../src/tools/shared/pose";
import { distance, turn } from "../../src/tools/shared/vec";
import { View } from "../../src/tools/shared/view";
import { forceOf, insideTank, placeInWater, readFacts } from "../../src/tools/shared/water";
import type { Source } from "../../src/tools/shared/documents";
import type { Tool } from "../../src/tools/tool";
import { fakeContext, key, settled } from "./fake_context";
import { lookAt } from "./support";

const view = new View(lookAt([5, -4, 3], [1, 1, 1]));
const box: Box = { lower: [0, 0, 0], upper: [1, 1, 1] };
const pivot: Vec3 = [0.5, 0.5, 0.5];
const pose = { ...turned(poseAt([1, 1, 1]), [0, 0, 1], Math.PI / 2), scale: [2, 2, 2] as Vec3 };
const close = (a: Vec3, b: Vec3, within = 1e-9) => assert.ok(distance(a, b) < within, `${a} is not ${b}`);
const pixel = (p: Vec3): Pixel => [view.project(p)!.x, view.project(p)!.y];

test("a part is placed with its middle at the gizmo, turned and scaled", () => {
  close(placed(pivot, pose, pivot), [1, 1, 1]);
  close(placed([1, 0.5, 0.5], pose, pivot), [1, 2, 1]);
});

test("a face of the box is dragged along its own axis, in the part's own units", () => {
  const face = faceAt(view, box, pose, pivot, pixel([1, 2, 1]));
  assert.deepEqual(face, { axis: 0, side: "upper" });
  const drag = { face: face!, box, from: pixel([1, 2, 1]), view };
  const bigger = dragFace(drag, pose, pivot, pixel([1, 2.6, 1]));
  assert.ok(Math.abs(bigger.upper[0] - 1.3) < 1e-9);
  const flat = dragFace(drag, pose, pivot, pixel([1, -3, 1]));
  assert.equal(flat.upper[0], 0, "a box is not turned inside out");
});

test("the box of points on the screen is where their layer puts them", () => {
  const object = (position: Vec3, scale: Vec3) => ({ position: { toArray: () => position }, scale: { toArray: () => scale } });
  const children = [object([1, 2, 3], [1, 1, 1]), object([0, 2, 3], [1, 1, 5])];
  assert.deepEqual(boxOfLayer({ children } as never), { lower: [0, 2, 3], upper: [2, 3, 8] });
  assert.equal(boxOfLayer({ children: [] }), null);
});

test("the section turns its z axis to the normal, also to the opposite one", () => {
  for (const normal of [[0, 0, 1], [0, 0, -1], [0.6, 0, 0.8], [-1, 0, 0]] as Vec3[]) close(turn(turnTo(normal), [0, 0, 1]), normal);
});

test("the section opens facing the view, moves along its normal and closes", () => {
  const fake = fakeContext();
  const tool = section(fake.context);
  tool.activate!();
  const plane = () => fake.view.section as { point: Vec3; normal: Vec3 } | null;
  close(plane()!.normal, [0, -1, 0]); // the axis that points most nearly to the eye
  const before = plane()!.point;
  assert.ok(tool.keyDown!(key("]", { shiftKey: true })));
  const moved = plane()!.point.map((v, a) => v - before[a]!) as Vec3;
  assert.ok(moved.reduce((sum, v, a) => sum + v * plane()!.normal[a]!, 0) > 0);
  assert.ok(tool.keyDown!(key("Escape")));
  assert.equal(plane(), null);
});

// ---- water ----

test("the pointer is in the tank, however far beside it is seen", () => {
  const tank: Vec3 = [2, 2, 2];
  close(placeInWater(view, pixel([1, 1, 1]), [1, 1, 1], tank)!, [1, 1, 1]);
  const far = placeInWater(view, [-5000, 300], [1, 1, 1], tank)!;
  assert.ok(far.every((v, a) => v >= 0 && v <= tank[a]!));
  assert.deepEqual(insideTank([-1, 1, 5], tank, 0.25), [0.25, 1, 1.75]);
});

test("a push follows the hand and rests with it, a swirl needs no way", () => {
  const hand = { radius: 0.2, strength: 40, back: [0, 0, 1] as Vec3 };
  const push = forceOf("push", [0, 0, 0], [0.15, 0, 0], 0.05, hand);
  assert.deepEqual([push!.direction, push!.centre, push!.strength], [[1, 0, 0], [0.15, 0, 0], 40]);
  assert.ok(Math.abs(forceOf("push", [0, 0, 0], [0.015, 0, 0], 0.02, hand)!.strength - 20) < 1e-9);
  assert.equal(forceOf("push", [1, 1, 1], [1, 1, 1], 0.05, hand), null);
  assert.deepEqual(forceOf("swirl", [1, 1, 1], [1, 1, 1], 0.05, hand)!.direction, [0, 0, 1]);
});

test("frames of files say nothing of a tank", () => {
  assert.equal(readFacts({ index: 3 }), null);
  assert.deepEqual(readFacts({ tank: [1, 2, 3], obstacle: null }), { tank: [1, 2, 3], obstacle: null });
});

// ---- parts and solids ----

/// The chooser of a tool, as a click on a name uses it.
function pickerOf(tool: Tool): { choose(source: Source): void } {
  return (tool as unknown as { picker: { choose(source: Source): void } }).picker;
}

/// A layer of ghosts as large as `size`, that comes a moment after the reply.
function ghostsArrive(fake: ReturnType<typeof fakeContext>, size: number): void {
  const object = { position: { toArray: () => [0, 0, 0] }, scale: { toArray: () => [size, size, size] } };
  (fake.context.viewport.ghosts.group as unknown as { children: unknown[] }).children = [object];
  fake.store.update({ ghosts: { blob: 1, added: 9, removed: 0 } });
}

test("a part is measured first, then shown beside the scene, and Enter adds it where it is", async () => {
  const fake = fakeContext();
  const tool = copyPart(fake.context);
  pickerOf(tool).choose({ shape: "torus" });
  await settled();
  assert.deepEqual(fake.sent.map((s) => s.body.operation), [{ op: "insert", shape: "torus" }]);
  ghostsArrive(fake, 1);
  await settled();
  const shown = fake.sent[1]!.body.operation as InsertOperation;
  const camera = new View(fake.view.camera);
  const middle = [0, 1, 2].map((a) => shown.translation![a]! + 0.5) as Vec3;
  assert.ok(camera.project(middle)!.x > camera.project([2, 2, 0])!.x, "on the right of the scene");
  assert.ok(tool.keyDown!(key("Enter")));
  await settled();
  assert.deepEqual([fake.sent[2]!.verb, fake.sent[2]!.body.operation], ["apply", shown]);
});

test("a part that is far too large is made to fit", async () => {
  const fake = fakeContext();
  const tool = copyPart(fake.context);
  pickerOf(tool).choose({ file: "scan.ply" });
  await settled();
  ghostsArrive(fake, 2000);
  await settled();
  const { scale } = fake.sent[1]!.body.operation as InsertOperation;
  assert.ok(Math.abs(scale! - 0.5 / 1000) < 1e-12);
});

test("a solid whose points cannot be shown is combined where it lies", async () => {
  const fake = fakeContext();
  const tool = combine(fake.context);
  fake.view.replies["preview"] = new Error("the part has no normals");
  pickerOf(tool).choose({ file: "cube.stl" });
  await settled();
  fake.view.replies["preview"] = {};
  assert.deepEqual(fake.notices, []);
  tool.keyDown!(key("Enter"));
  await settled();
  const { scale, translation, ...rest } = fake.sent[fake.sent.length - 1]!.body.operation as BooleanOperation;
  assert.deepEqual([scale, translation, rest.with, rest.operation], [1, [0, 0, 0], { file: "cube.stl" }, "union"]);
});
