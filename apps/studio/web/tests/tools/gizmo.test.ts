import assert from "node:assert/strict";
import { test } from "node:test";
import type { Pixel, Vec3 } from "../../src/engine/protocol";
import { GizmoDrag, type GizmoOptions, type Part, gripAt, gripsOf, poseByKey } from "../../src/tools/shared/gizmo";
import { type Pose, affineOf, isAtRest, poseAt, rigidOf, similarityOf, turned } from "../../src/tools/shared/pose";
import { add, axisAngleOf, distance, mul, transform, turn } from "../../src/tools/shared/vec";
import { View } from "../../src/tools/shared/view";
import { lookAt } from "./support";

const view = new View(lookAt([5, -4, 3], [1, 1, 1]));
const start = poseAt([1, 1, 1]);
const all: GizmoOptions = { move: true, turn: true, scale: "axes" };
const close = (a: Vec3, b: Vec3, within = 1e-9) => assert.ok(distance(a, b) < within, `${a} is not ${b}`);

function pixelAt(p: Vec3): Pixel {
  const { x, y } = view.project(p)!;
  return [x, y];
}
/// The pose after a drag of a part from one world point on the screen to another.
function dragged(part: Part, from: Vec3, to: Vec3): Pose {
  return new GizmoDrag(part, start, view, pixelAt(from)).to(pixelAt(to));
}

test("every part is gripped where it is drawn", () => {
  const grips = gripsOf(view, start, all);
  assert.equal(grips.length, 14);
  for (const grip of grips.filter((g) => g.part.kind !== "turn")) {
    const [ax, ay] = grip.points[0]!;
    const [bx, by] = grip.points[Math.floor(grip.points.length / 2)]!;
    const middle: Pixel = grip.points.length > 1 ? [(ax + bx) / 2, (ay + by) / 2] : [ax, ay];
    const place = grip.part.kind === "plane" ? grip.points[2]! : middle;
    assert.equal(gripAt(grips, place)?.id, grip.id);
  }
});

test("nothing is gripped far from it, and nothing that is not offered", () => {
  const grips = gripsOf(view, start, { move: true, turn: true, scale: "none", moveAxes: [2], turnAxes: [0] });
  assert.deepEqual(grips.map((g) => g.id), ["move-z", "turn-x"]);
  assert.equal(gripAt(grips, [5, 5]), null);
});

test("an arrow moves along its axis by as much as the pointer does", () => {
  const pose = dragged({ kind: "move", axis: 0 }, [1.2, 1, 1], [1.9, 1, 1]);
  close(pose.position, [1.7, 1, 1]);
});

test("a square moves in its plane", () => {
  const pose = dragged({ kind: "plane", axis: 2 }, [1.1, 1.1, 1], [1.5, 0.3, 1]);
  close(pose.position, [1.4, 0.2, 1]);
});

test("the middle follows the pointer in the plane of the picture", () => {
  const pose = dragged({ kind: "free" }, start.position, add(start.position, mul(view.up, 0.5)));
  close(pose.position, add(start.position, mul(view.up, 0.5)));
});

test("a ring turns a point on it to where the pointer goes", () => {
  const to: Vec3 = [1 + 0.3 * Math.cos(1.1), 1 + 0.3 * Math.sin(1.1), 1];
  const pose = dragged({ kind: "turn", axis: 2 }, [1.3, 1, 1], to);
  close(turn(pose.rotation, [0.3, 0, 0]), [to[0] - 1, to[1] - 1, 0]);
});

test("whole turns of a drag count", () => {
  const drag = new GizmoDrag({ kind: "turn", axis: 2 }, start, view, pixelAt([1.3, 1, 1]));
  let pose = start;
  for (let i = 1; i <= 60; ++i) {
    const angle = (i / 60) * 3 * Math.PI; // one turn and a half
    pose = drag.to(pixelAt([1 + 0.3 * Math.cos(angle), 1 + 0.3 * Math.sin(angle), 1]));
  }
  assert.ok(Math.abs(rigidOf(pose, [1, 1, 1]).degrees! - 540) < 1e-6);
});

test("turns one after another about one axis add up, also when it points the other way", () => {
  const once = turned(start, [0, 0, 1], 3);
  assert.equal(rigidOf(turned(once, [0, 0, 1], 3), [1, 1, 1]).degrees, (6 * 180) / Math.PI);
  assert.equal(rigidOf(turned(once, [0, 0, -1], 1), [1, 1, 1]).degrees, (2 * 180) / Math.PI);
});

test("turning about another axis afterwards forgets whole turns and keeps the turn", () => {
  const pose = turned(turned(start, [0, 0, 1], 0.5), [1, 0, 0], 0.5);
  assert.equal(pose.spin, undefined);
  const { degrees, axis } = rigidOf(pose, [1, 1, 1]);
  const same = axisAngleOf(pose.rotation);
  assert.deepEqual([degrees, axis], [(same.angle * 180) / Math.PI, same.axis]);
});

test("with steps a turn is a multiple of 15 degrees", () => {
  const drag = new GizmoDrag({ kind: "turn", axis: 2 }, start, view, pixelAt([1.3, 1, 1]));
  const pose = drag.to(pixelAt([1 + 0.3 * Math.cos(0.6), 1 + 0.3 * Math.sin(0.6), 1]), true);
  assert.ok(Math.abs(rigidOf(pose, [1, 1, 1]).degrees! - 30) < 1e-9);
});

test("twice as far from the middle is twice the size, along one axis or all", () => {
  const centre = pixelAt(start.position);
  const from: Pixel = [centre[0] + 40, centre[1]];
  const to: Pixel = [centre[0], centre[1] - 80];
  assert.deepEqual(new GizmoDrag({ kind: "size" }, start, view, from).to(to).scale.map((s) => s.toFixed(6)), ["2.000000", "2.000000", "2.000000"]);
  assert.deepEqual(new GizmoDrag({ kind: "scale", axis: 1 }, start, view, from).to(to).scale.map((s) => s.toFixed(6)), ["1.000000", "2.000000", "1.000000"]);
});

test("own axes turn with the pose", () => {
  const leaning = turned(start, [0, 1, 0], Math.PI / 2); // its z axis is the world's x axis
  const part: Part = { kind: "move", axis: 2, own: true };
  const pose = new GizmoDrag(part, leaning, view, pixelAt([1.2, 1, 1])).to(pixelAt([1.9, 1, 1]));
  close(pose.position, [1.7, 1, 1]);
});

test("an axis seen end on is not gripped", () => {
  const along = new View(lookAt([9, 1, 1], [1, 1, 1]));
  const grips = gripsOf(along, start, { move: true, turn: false, scale: "none" });
  assert.ok(grips.find((g) => g.id === "move-x")!.faint);
  assert.ok(!grips.find((g) => g.id === "move-y")!.faint);
});

test("a ring seen from its edge turns with the hand", () => {
  const side = new View(lookAt([1, -8, 1], [1, 1, 1]));
  const centre = side.project([1, 1, 1])!;
  const drag = new GizmoDrag({ kind: "turn", axis: 2 }, start, side, [centre.x, centre.y]);
  const { degrees } = rigidOf(drag.to([centre.x + 66, centre.y]), [1, 1, 1]);
  assert.ok(Math.abs(degrees! - 180 / Math.PI) < 1e-6, `${degrees}`);
});

const key = (name: string, more: Partial<KeyboardEvent> = {}) => ({ key: name, shiftKey: false, ctrlKey: false, ...more }) as KeyboardEvent;

test("arrow keys move by pixels of the picture, ten with Shift", () => {
  const before = pixelAt(start.position);
  const after = pixelAt(poseByKey(key("ArrowRight"), start, view, all)!.position);
  assert.ok(Math.abs(after[0] - before[0] - 1) < 1e-9 && Math.abs(after[1] - before[1]) < 1e-9);
  const far = pixelAt(poseByKey(key("ArrowUp", { shiftKey: true }), start, view, all)!.position);
  assert.ok(Math.abs(far[1] - before[1] + 10) < 1e-9);
});

test("with Ctrl arrow keys turn, + scales, other keys are not the gizmo's", () => {
  const pose = poseByKey(key("ArrowRight", { ctrlKey: true, shiftKey: true }), start, view, all)!;
  assert.ok(Math.abs(rigidOf(pose, [1, 1, 1]).degrees! - 10) < 1e-9);
  assert.ok(Math.abs(poseByKey(key("+"), start, view, all)!.scale[0] - 1.01) < 1e-12);
  assert.equal(poseByKey(key("x"), start, view, all), null);
  assert.equal(poseByKey(key("+"), start, view, { ...all, scale: "none" }), null);
});

test("similarity, rigid and affine documents put the pivot where the gizmo is", () => {
  const pivot: Vec3 = [2, -1, 0.5];
  const pose: Pose = { ...turned(poseAt([4, 4, 4]), [0, 0, 1], 0.7), scale: [2, 2, 2] };
  const s = similarityOf(pose, pivot);
  close(add(mul(transform(s.rotation, pivot), s.scale), s.translation), pose.position);
  const { matrix } = affineOf(pose, pivot);
  const image = (p: Vec3) => matrix.map((row) => row[0]! * p[0] + row[1]! * p[1] + row[2]! * p[2] + row[3]!) as Vec3;
  close(image(pivot), pose.position);
  close(image(add(pivot, [1, 0, 0])), add(pose.position, mul(turn(pose.rotation, [1, 0, 0]), 2)));
  const rigid = rigidOf(pose, pivot);
  close(add(rigid.point!, rigid.translation!), pose.position);
});

test("a pose at rest says so, also turned by whole turns it does not", () => {
  assert.ok(isAtRest(poseAt([1, 2, 3]), [1, 2, 3]));
  assert.ok(!isAtRest(poseAt([1, 2, 4]), [1, 2, 3]));
  assert.ok(!isAtRest(turned(poseAt([1, 2, 3]), [0, 0, 1], 2 * Math.PI), [1, 2, 3]));
});
