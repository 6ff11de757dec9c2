import assert from "node:assert/strict";
import { test } from "node:test";
import type { Pixel } from "../../src/engine/protocol";
import { type Gesture, LassoGesture, PolygonGesture, RectangleGesture, StrokeGesture, handlesOf, withHandle } from "../../src/tools/shared/gestures";

function drag(gesture: Gesture, points: Pixel[], add = false): void {
  gesture.down(points[0]!, add);
  for (const p of points.slice(1)) gesture.move(p);
  gesture.up(points[points.length - 1]!);
}
const click = (gesture: Gesture, p: Pixel, add = false) => drag(gesture, [p], add);
const loop = (x: number, side: number): Pixel[] => [[x, x], [x + side, x], [x + side, x + side], [x, x + side]];

test("a drag is a stroke, and a click is a stroke of one point", () => {
  const stroke = new StrokeGesture();
  drag(stroke, [[0, 0], [10, 0], [20, 0], [20, 30]]);
  assert.deepEqual(stroke.shape(), { kind: "stroke", points: [[0, 0], [20, 0], [20, 30]] });
  click(stroke, [5, 5]);
  assert.deepEqual(stroke.shape(), { kind: "stroke", points: [[5, 5]] });
});

test("a rectangle does not depend on the corner it begins at", () => {
  const rectangle = new RectangleGesture();
  drag(rectangle, [[30, 40], [10, 5]]);
  assert.deepEqual(rectangle.shape(), { kind: "rectangle", corners: [10, 5, 30, 40] });
  click(rectangle, [30, 40]);
  assert.equal(rectangle.shape(), null);
});

test("Alt or Shift adds loops to a lasso, without them it begins anew", () => {
  const lasso = new LassoGesture();
  drag(lasso, loop(0, 100));
  drag(lasso, loop(30, 20), true);
  const shape = lasso.shape();
  assert.equal(shape?.kind === "area" && shape.loops.length, 2);
  drag(lasso, loop(0, 50));
  const again = lasso.shape();
  assert.equal(again?.kind === "area" && again.loops.length, 1);
});

test("a loop that is too small leaves the loops before as they are", () => {
  const lasso = new LassoGesture();
  drag(lasso, loop(0, 100));
  drag(lasso, [[50, 50], [51, 50], [51, 51]], true);
  const shape = lasso.shape();
  assert.equal(shape?.kind === "area" && shape.loops.length, 1);
});

test("a polygon is closed by a click on its first corner", () => {
  const polygon = new PolygonGesture();
  for (const p of loop(0, 100)) click(polygon, p);
  assert.equal(polygon.shape(), null);
  click(polygon, [4, 3]);
  assert.deepEqual(polygon.shape(), { kind: "area", loops: [loop(0, 100)] });
});

test("Backspace takes the last corner back, Enter closes", () => {
  const polygon = new PolygonGesture();
  for (const p of [...loop(0, 100), [500, 500] as Pixel]) click(polygon, p);
  assert.ok(polygon.key("Backspace"));
  assert.ok(polygon.key("Enter"));
  assert.deepEqual(polygon.shape(), { kind: "area", loops: [loop(0, 100)] });
  assert.ok(!polygon.key("Enter"), "the next Enter is for the tool, which commits");
});

test("two corners do not close", () => {
  const polygon = new PolygonGesture();
  click(polygon, [0, 0]);
  click(polygon, [50, 0]);
  polygon.key("Enter");
  assert.equal(polygon.shape(), null);
  assert.ok(polygon.drawing);
  polygon.key("Backspace");
  polygon.key("Backspace");
  assert.ok(!polygon.drawing);
});

test("handles of a rectangle keep it a rectangle", () => {
  const shape = { kind: "rectangle" as const, corners: [0, 0, 10, 20] as [number, number, number, number] };
  handlesOf(shape).forEach(([x, y], i) => {
    const bigger = withHandle(shape, i, [x === 0 ? -5 : 15, y === 0 ? -5 : 25]);
    const corners = bigger.kind === "rectangle" ? bigger.corners : [];
    assert.equal((corners[2]! - corners[0]!) * (corners[3]! - corners[1]!), 15 * 25);
  });
});

test("handles of loops are counted through all of them", () => {
  const shape = { kind: "area" as const, loops: [loop(0, 100), loop(30, 20)] };
  const changed = withHandle(shape, 5, [60, 30]);
  assert.deepEqual(changed.kind === "area" && changed.loops[1]![1], [60, 30]);
  assert.deepEqual(changed.kind === "area" && changed.loops[0], loop(0, 100));
});
