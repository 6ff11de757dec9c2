import assert from "node:assert/strict";
import { test } from "node:test";
import type { Box, CameraJson, Vec3 } from "../src/engine/protocol";
import { ViewCamera, add, centreOf, dot } from "../src/view/camera";

const kBox: Box = { lower: [499990, 5399995, 300], upper: [500010, 5400005, 306] };

function cameraAt(patch: Partial<ViewCamera> = {}): ViewCamera {
  const camera = Object.assign(new ViewCamera(), { width: 800, height: 600 }, patch);
  camera.fit(kBox);
  return Object.assign(camera, patch);
}

/// What include/pointskin/camera.hpp says a document means: world to eye to clip to pixels from the upper left.
function pixelOf({ view, projection, width, height }: CameraJson, point: Vec3): [number, number] {
  const times = (m: number[], v: number[]) => [0, 1, 2, 3].map((r) => v.reduce((sum, x, c) => sum + m[4 * r + c]! * x, 0));
  const clip = times(projection, times(view, [...point, 1]));
  return [(0.5 + 0.5 * (clip[0]! / clip[3]!)) * width, (0.5 - 0.5 * (clip[1]! / clip[3]!)) * height];
}

const near = (a: number, b: number, within: number, what: string) => assert.ok(Math.abs(a - b) <= within, `${what}: ${a} and ${b}`);

for (const up of ["y", "z"] as const) {
  for (const orthographic of [false, true]) {
    const name = `up ${up}, ${orthographic ? "orthographic" : "perspective"}`;

    test(`the document projects points to where the view shows them (${name})`, () => {
      const camera = cameraAt({ up, orthographic, azimuth: 2.1, elevation: -0.7 });
      const document = camera.document(kBox);
      for (const point of [kBox.lower, kBox.upper, centreOf(kBox)]) {
        const shown = camera.project(point);
        const [x, y] = pixelOf(document, point);
        near(x, shown.x, 1e-5, "x");
        near(y, shown.y, 1e-5, "y");
        const back = camera.pointAt(shown.x, shown.y, shown.depth);
        for (let i = 0; i < 3; ++i) near(back[i]!, point[i]!, 1e-5, "back");
      }
    });

    test(`the document's matrices have the form that the library checks (${name})`, () => {
      const { view, projection } = cameraAt({ up, orthographic, azimuth: -1, elevation: 1.2 }).document(kBox);
      const rows = [0, 1, 2].map((r) => view.slice(4 * r, 4 * r + 3) as Vec3);
      for (let i = 0; i < 3; ++i) {
        for (let j = 0; j < 3; ++j) near(dot(rows[i]!, rows[j]!), i === j ? 1 : 0, 1e-12, `rows ${i} ${j}`);
      }
      const [a, b, c] = rows as [Vec3, Vec3, Vec3];
      near(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]), 1, 1e-12, "proper");
      assert.deepEqual(view.slice(12), [0, 0, 0, 1]);
      assert.deepEqual(projection.slice(12), orthographic ? [0, 0, 0, 1] : [0, 0, -1, 0]);
      for (const place of [1, 2, 3, 4, 6, 7]) assert.equal(projection[place], 0, `no skew at ${place}`);
    });

    test(`what the box holds is between the planes and in the picture (${name})`, () => {
      const camera = cameraAt({ up, orthographic });
      const { near: first, far } = camera.planes(kBox);
      for (let corner = 0; corner < 8; ++corner) {
        const point = [0, 1, 2].map((i) => ((corner >> i) & 1 ? kBox.upper[i] : kBox.lower[i])) as Vec3;
        const { x, y, depth } = camera.project(point);
        assert.ok(depth > first && depth < far);
        assert.ok(x > 0 && x < 800 && y > 0 && y < 600, `${x} ${y}`);
      }
    });

    test(`orbit, pan and dolly leave the point under the cursor there (${name})`, () => {
      const camera = cameraAt({ up, orthographic });
      const pivot = add(centreOf(kBox), [3, 1, 2]);
      const before = camera.project(pivot);
      camera.orbit(pivot, 0.4, 0.2);
      const turned = camera.project(pivot);
      near(turned.x, before.x, 1e-5, "orbit x");
      near(turned.y, before.y, 1e-5, "orbit y");
      near(turned.depth, before.depth, 1e-5, "orbit depth");
      camera.dolly(0.5, pivot);
      near(camera.project(pivot).x, before.x, 1e-5, "dolly x");
      camera.pan(30, -20, camera.depthOf(pivot));
      near(camera.project(pivot).x, before.x + 30, 1e-5, "pan x");
      near(camera.project(pivot).y, before.y - 20, 1e-5, "pan y");
    });
  }
}

test("a ray goes through the point under its pixel", () => {
  for (const orthographic of [false, true]) {
    const camera = cameraAt({ orthographic });
    const point = camera.pointAt(123, 456, 40);
    const { origin, direction } = camera.ray(123, 456);
    const offset = add(point, origin, -1);
    const along = dot(offset, direction);
    near(Math.hypot(...add(offset, direction, -along)), 0, 1e-6, "distance from the ray");
    near(Math.hypot(...direction), 1, 1e-12, "length");
  }
});

test("the elevation ends at the poles", () => {
  const camera = cameraAt();
  camera.orbit(camera.target, 0, 10);
  assert.equal(camera.elevation, Math.PI / 2);
});

test("a suggested direction is taken over for both up axes", () => {
  for (const up of ["y", "z"] as const) {
    const from = cameraAt({ up, azimuth: 0.9, elevation: -0.4 });
    const to = cameraAt({ up });
    to.setDirection(from.viewMatrix());
    near(to.azimuth, 0.9, 1e-12, "azimuth");
    near(to.elevation, -0.4, 1e-12, "elevation");
  }
});
