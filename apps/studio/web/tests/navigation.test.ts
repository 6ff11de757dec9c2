import assert from "node:assert/strict";
import { test } from "node:test";
import { pinch, wheelFactor } from "../src/view/controls";
import { roundUp } from "../src/view/grid";

test("the wheel away goes farther, and back by the same", () => {
  const away = wheelFactor({ deltaY: 100, deltaMode: 0 });
  assert.ok(away > 1);
  assert.ok(Math.abs(away * wheelFactor({ deltaY: -100, deltaMode: 0 }) - 1) < 1e-12);
});

test("lines count as pixels, and one event never jumps", () => {
  assert.equal(wheelFactor({ deltaY: 3, deltaMode: 1 }), wheelFactor({ deltaY: 54, deltaMode: 0 }));
  assert.equal(wheelFactor({ deltaY: 1e6, deltaMode: 0 }), wheelFactor({ deltaY: 240, deltaMode: 0 }));
});

test("two fingers spread to half the distance and carry the middle along", () => {
  const moved = pinch([{ x: 0, y: 0 }, { x: 10, y: 0 }], [{ x: 0, y: 4 }, { x: 20, y: 4 }]);
  assert.deepEqual(moved, { dx: 5, dy: 4, factor: 0.5 });
});

test("the grid's step is 1, 2 or 5 times a power of ten", () => {
  assert.equal(roundUp(0.3), 0.5);
  assert.equal(roundUp(1), 1);
  assert.equal(roundUp(1.2), 2);
  assert.equal(roundUp(70), 100);
  assert.ok(Math.abs(roundUp(0.001) - 0.001) < 1e-15);
});
