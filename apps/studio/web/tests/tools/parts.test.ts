import "./page";
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Box, Pixel, Vec3 } from "../../src/engine/protocol";
import { section, turnTo } from "../../src/tools/section";
import { boxOfLayer } from "../../src/tools/shared/ghost_box";
import { dragFace, faceAt, placed } from "../../src/tools/shared/part_box";
import { poseAt, turned } from "../../src/tools/shared/pose";
import { distance, turn } from "../../src/tools/shared/vec";
import { View } from "../../src/tools/shared/view";
import { forceOf, insideTank, placeInWater, readFacts } from "../../src/tools/shared/water";
import { fakeContext, key } from "./fake_context";
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
