import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3 } from "../../src/engine/protocol";
import { add, axisAngleOf, degreesOf, distance, dot, matrixOf, mul, sub, transform, turnAbout, turnAfter, turnOfDegrees } from "../../src/tools/shared/vec";
import { View, cameraOfPart, meetPlane, nearestOnAxis, sameCamera } from "../../src/tools/shared/view";
import { lookAt } from "./support";

const close = (a: Vec3, b: Vec3, within = 1e-9) => assert.ok(distance(a, b) < within, `${a} is not ${b}`);

for (const perspective of [true, false]) {
  const view = new View(lookAt([5, -4, 3], [1, 1, 1], perspective));
  const kind = perspective ? "perspective" : "orthographic";

  test(`${kind}: what is looked at is in the middle`, () => {
    const pixel = view.project([1, 1, 1])!;
    assert.ok(Math.hypot(pixel.x - 450, pixel.y - 300) < 1e-9);
  });

  test(`${kind}: the ray through a pixel meets the point that it shows`, () => {
    for (const p of [[1, 1, 1], [0.3, 2, -1], [2, 0, 1.5]] as Vec3[]) {
      const { x, y } = view.project(p)!;
      const ray = view.ray(x, y);
      close(add(ray.origin, mul(ray.direction, dot(sub(p, ray.origin), ray.direction))), p);
    }
  });

  test(`${kind}: a point dragged by pixels is seen so many pixels further`, () => {
    const p: Vec3 = [0.3, 2, -1];
    const before = view.project(p)!;
    const after = view.project(view.dragged(p, 30, -12))!;
    assert.ok(Math.hypot(after.x - before.x - 30, after.y - before.y + 12) < 1e-9);
  });

  test(`${kind}: a part's own camera sees it where the scene's sees it placed`, () => {
    const rotation = matrixOf(turnAbout([1, 2, 3], 0.8));
    const placed = (p: Vec3) => add(mul(transform(rotation, p), 1.7), [0.2, -0.4, 0.9]);
    const camera = cameraOfPart(view.camera, 1.7, rotation, [0.2, -0.4, 0.9]);
    for (const p of [[0, 0, 0], [0.5, 0.2, -0.4]] as Vec3[]) {
      const [own, scene] = [new View(camera).project(p)!, view.project(placed(p))!];
      assert.ok(Math.hypot(own.x - scene.x, own.y - scene.y) < 1e-9);
    }
    const row = camera.view.slice(0, 3) as Vec3;
    assert.ok(Math.abs(dot(row, row) - 1) < 1e-12, "a view is a rotation");
  });
}

test("what is behind the eye is nowhere", () => {
  assert.equal(new View(lookAt([5, 0, 0], [0, 0, 0])).project([6, 0, 0]), null);
});

test("the nearest place on an axis, and none on one seen end on", () => {
  const ray = { origin: [2, 5, 0] as Vec3, direction: [0, -1, 0] as Vec3 };
  assert.ok(Math.abs(nearestOnAxis([0, 0, 0], [1, 0, 0], ray)! - 2) < 1e-12);
  assert.equal(nearestOnAxis([0, 0, 0], [0, 1, 0], ray), null);
});

test("planes behind the eye or along the ray are not met", () => {
  const ray = { origin: [0, 0, 1] as Vec3, direction: [0, 0, -1] as Vec3 };
  close(meetPlane([3, 4, 0], [0, 0, 1], ray)!, [0, 0, 0]);
  assert.equal(meetPlane([0, 0, 2], [0, 0, 1], ray), null);
  assert.equal(meetPlane([0, 0, 0], [1, 0, 0], ray), null);
});

test("cameras are the same only to the last number", () => {
  const camera = lookAt([5, 0, 0], [0, 0, 0]);
  assert.ok(sameCamera(camera, structuredClone(camera)));
  assert.ok(!sameCamera(camera, { ...camera, width: 901 }));
  assert.ok(!sameCamera(camera, lookAt([5, 0, 1e-9], [0, 0, 0])));
});

test("turns: axis and angle, degrees and composition come back", () => {
  const q = turnAfter(turnAbout([0, 0, 1], 0.4), turnAbout([1, 0, 0], 1.1));
  const { axis, angle } = axisAngleOf(q);
  close(transform(matrixOf(turnAbout(axis, angle)), [1, 2, 3]), transform(matrixOf(q), [1, 2, 3]));
  close(transform(matrixOf(turnOfDegrees(degreesOf(q))), [1, 2, 3]), transform(matrixOf(q), [1, 2, 3]));
  close(degreesOf(turnOfDegrees([10, 20, 30])), [10, 20, 30]);
});
