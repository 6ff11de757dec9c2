// Cameras for tests.
import type { CameraJson, Vec3 } from "../../src/engine/protocol";
import { cross, dot, normalise, sub } from "../../src/tools/shared/vec";

/// 900 x 600 pixels, z upwards.
export function lookAt(eye: Vec3, target: Vec3, perspective = true): CameraJson {
  const back = normalise(sub(eye, target));
  const right = normalise(cross([0, 0, 1], back));
  const up = cross(back, right);
  const view = [right, up, back].flatMap((row) => [...row, -dot(row, eye)]).concat([0, 0, 0, 1]);
  const f = perspective ? 1.9 : 0.25;
  const [a, b] = perspective ? [-1.01, -0.1] : [-0.1, -1];
  const last = perspective ? [0, 0, -1, 0] : [0, 0, 0, 1];
  return { view, projection: [f / 1.5, 0, 0, 0, 0, f, 0, 0, 0, 0, a!, b!, ...last], width: 900, height: 600 };
}
