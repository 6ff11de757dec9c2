import assert from "node:assert/strict";
import { test } from "node:test";
import type { SceneState, Vec3 } from "../../src/engine/protocol";
import { bendOf, booleanOf, flipOf, guideOf, insertOf, latticeOf, orientOf, removeOf } from "../../src/tools/shared/documents";
import { cellWidth, describeInterval, sceneBox, stepInterval } from "../../src/tools/shared/interval";
import { poseAt } from "../../src/tools/shared/pose";
import { lookAt } from "./support";

const camera = lookAt([5, -4, 3], [1, 1, 1]);
const rectangle = { kind: "rectangle" as const, corners: [1, 2, 30, 40] as [number, number, number, number] };
const settings = { interval: 0.1, normals: "stroke" as const, insideOnly: false };

test("a guide has a stroke or an area, never both", () => {
  const stroke = guideOf(camera, { kind: "stroke", points: [[1, 2], [3, 4]] }, settings);
  assert.deepEqual(stroke, { op: "guide", camera, stroke: [[1, 2], [3, 4]], interval: 0.1, normals: "stroke", inside_only: false });
  const area = guideOf(camera, rectangle, settings);
  assert.deepEqual(area, { op: "guide", camera, rectangle: [1, 2, 30, 40], interval: 0.1, normals: "cloud", inside_only: false });
});

test("a click guides with the cloud's normals, as a stroke without a length has none", () => {
  assert.equal(guideOf(camera, { kind: "stroke", points: [[1, 2]] }, settings).normals, "cloud");
});

test("removals and flips say their layers, and take no stroke", () => {
  assert.deepEqual(removeOf(camera, rectangle, true, "front"), { op: "remove", camera, rectangle: [1, 2, 30, 40], originals: true, layers: "front" });
  assert.deepEqual(flipOf(camera, rectangle, "through"), { op: "flip", camera, rectangle: [1, 2, 30, 40], layers: "through" });
  assert.throws(() => removeOf(camera, { kind: "stroke", points: [[1, 2]] }, true, "front"), TypeError);
});

test("an insertion has a box or a lasso only where there is one", () => {
  const part = { source: { shape: "hand" }, pose: poseAt([1, 2, 3]), pivot: [0, 0, 0] as Vec3, box: null, snap: true, lasso: null };
  assert.deepEqual(insertOf(part), {
    op: "insert", shape: "hand", scale: 1, rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [1, 2, 3], snap: true,
  });
  const lasso = { camera, area: [[[0, 0], [9, 0], [9, 9]]] as [number, number][][], pose: poseAt([0, 0, 0]) };
  const cut = insertOf({ ...part, lasso, box: { lower: [0, 0, 0], upper: [1, 1, 1] } });
  assert.deepEqual([cut.area, cut.box], [lasso.area, { lower: [0, 0, 0], upper: [1, 1, 1] }]);
  assert.deepEqual(JSON.stringify(cut.camera), JSON.stringify(camera), "the lasso was drawn on the part where it lies by itself");
});

test("a handle at rest holds, a dragged one moves, rigidly or not", () => {
  const rest = { centre: [0, 0, 0] as Vec3, radius: 1, pose: poseAt([0, 0, 0]) };
  const gone = { centre: [5, 0, 0] as Vec3, radius: 2, pose: poseAt([5, 1, 0]) };
  const rigid = bendOf([rest, gone], false);
  assert.deepEqual(rigid.handles![0], { region: { ball: { centre: [0, 0, 0], radius: 1 } } });
  assert.deepEqual(rigid.handles![1]!.rigid, { axis: [0, 0, 1], point: [5, 0, 0], degrees: 0, translation: [0, 1, 0] });
  assert.equal(rigid.handles![1]!.affine, undefined);
  const affine = bendOf([rest, gone], true);
  assert.deepEqual(affine.handles![1]!.affine, { matrix: [[1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 1, 0]], pivot: [5, 0, 0] });
});

test("a lattice names the control points that were moved", () => {
  const box = { lower: [0, 0, 0] as Vec3, upper: [1, 1, 1] as Vec3 };
  const moves = new Map<string, Vec3>([["0,1,2", [0, 0, 1]], ["1,1,1", [0, 0, 0]]]);
  const { lattices } = latticeOf({ box, spans: [2, 2, 2], moves, outside: "stay" });
  assert.deepEqual(lattices, [{ box, spans: [2, 2, 2], moves: [{ at: [0, 1, 2], by: [0, 0, 1] }], outside: "stay" }]);
});

test("a combination places the second solid", () => {
  const json = booleanOf({ operation: "difference", source: { file: "b.ply" }, pose: poseAt([1, 0, 0]), pivot: [0, 0, 0], creases: "none" });
  assert.deepEqual([json.operation, json.with, json.translation, json.creases], ["difference", { file: "b.ply" }, [1, 0, 0], "none"]);
});

test("sensors decide an estimate, turning all needs none", () => {
  assert.deepEqual(orientOf("estimate", [[1, 2, 3]]), { op: "orient", method: "estimate", sensors: [[1, 2, 3]] });
  assert.deepEqual(orientOf("estimate", []), { op: "orient", method: "estimate" });
  assert.deepEqual(orientOf("turn", [[1, 2, 3]]), { op: "orient", method: "turn" });
});

// ---- intervals ----

const cloud = (lower: Vec3, upper: Vec3) => ({ name: "c", points: 1, normals: true, box: { lower, upper }, shift: [0, 0, 0] as Vec3, dropped: 0 });
const scene = { clouds: [cloud([0, 0, 0], [1, 2, 1]), cloud([0, -2, 0], [1, 0, 1])], options: { depth: 5 } } as unknown as SceneState;

test("cells are those of the cube around all clouds", () => {
  assert.deepEqual(sceneBox(scene), { lower: [0, -2, 0], upper: [1, 2, 1] });
  assert.equal(cellWidth(scene), (1.1 * 4) / 32);
  assert.equal(cellWidth(null), null);
});

test("four steps double the interval, and one cell is written as 0", () => {
  assert.ok(Math.abs(stepInterval(0, 0.5, 4) - 1) < 1e-12);
  assert.equal(stepInterval(stepInterval(0, 0.5, 3), 0.5, -3), 0);
  assert.equal(stepInterval(0, 0.5, 100), 8);
  assert.equal(stepInterval(0, 0.5, -100), 0.125);
});

test("an interval is told in world units and cells", () => {
  assert.equal(describeInterval(0, 0.1375), "0.138 = 1 cell");
  assert.equal(describeInterval(0.275, 0.1375), "0.275 = 2 cells");
  assert.equal(describeInterval(0, null), "one cell");
});
