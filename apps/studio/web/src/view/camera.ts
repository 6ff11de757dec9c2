// The camera of the view, without any library's state: a turntable about an up axis, perspective or orthographic.
// Everything is in world coordinates and double precision; cameraDocument() is what operations carry.
import { Matrix4, Vector3 } from "three";
import type { Box, CameraJson, Vec3 } from "../engine/protocol";

export type UpAxis = "y" | "z";
const kFov = (35 * Math.PI) / 180; // vertical
const kSteepest = Math.PI / 2;

/// Rows of the rotation world to eye: right, up, back (towards the viewer).
export type Frame = [Vec3, Vec3, Vec3];

export function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
export function add(a: Vec3, b: Vec3, s = 1): Vec3 {
  return [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
}
export function centreOf(box: Box): Vec3 {
  return [0, 1, 2].map((i) => (box.lower[i]! + box.upper[i]!) / 2) as Vec3;
}
export function radiusOf(box: Box): number {
  const half = [0, 1, 2].map((i) => (box.upper[i]! - box.lower[i]!) / 2) as Vec3;
  return Math.max(Math.hypot(...half), 1e-9);
}

export class ViewCamera {
  target: Vec3 = [0, 0, 0];
  azimuth = 0.6; // radians about the up axis; 0 looks along -z (up y) or +y (up z)
  elevation = 0.35; // radians, in [-pi/2, pi/2]
  distance = 5; // eye to target, world units
  orthographic = false;
  up: UpAxis = "y";
  width = 1; // CSS pixels
  height = 1;

  clone(): ViewCamera {
    return Object.assign(new ViewCamera(), this, { target: [...this.target] });
  }

  frame(): Frame {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const rows: Frame = [
      [ca, 0, -sa],
      [-sa * se, ce, -ca * se],
      [sa * ce, se, ca * ce],
    ];
    return this.up === "y" ? rows : (rows.map(([x, y, z]) => [x, -z, y]) as Frame);
  }

  get eye(): Vec3 {
    return add(this.target, this.frame()[2], this.distance);
  }

  /// World units of a CSS pixel at this distance along the view.
  pixelSize(depth = this.distance): number {
    const d = this.orthographic ? this.distance : depth;
    return (2 * d * Math.tan(kFov / 2)) / this.height;
  }

  /// Distance of a point from the eye along the view.
  depthOf(point: Vec3): number {
    return -dot(this.frame()[2], add(point, this.eye, -1));
  }

  /// Turns about a point, which stays where it is on the screen.
  orbit(pivot: Vec3, right: number, down: number): void {
    const before = this.frame();
    const offset = add(pivot, this.eye, -1);
    const local: Vec3 = [dot(before[0], offset), dot(before[1], offset), dot(before[2], offset)];
    this.azimuth -= right;
    this.elevation = Math.min(Math.max(this.elevation + down, -kSteepest), kSteepest);
    const after = this.frame();
    let eye = pivot;
    for (let i = 0; i < 3; ++i) eye = add(eye, after[i]!, -local[i]!);
    this.target = add(eye, after[2], -this.distance);
  }

  /// Moves by pixels, so that what is at `depth` follows the cursor.
  pan(dx: number, dy: number, depth = this.distance): void {
    const size = this.pixelSize(depth);
    const [right, up] = this.frame();
    this.target = add(add(this.target, right, -dx * size), up, dy * size);
  }

  /// Goes nearer (factor < 1) to a point, which stays where it is on the screen.
  dolly(factor: number, towards: Vec3): void {
    this.target = add(towards, add(this.target, towards, -1), factor);
    this.distance *= factor;
  }

  /// The point under a pixel, `depth` away from the eye along the view.
  pointAt(x: number, y: number, depth = this.distance): Vec3 {
    const size = this.pixelSize(depth);
    const [right, up, back] = this.frame();
    const middle = add(this.target, back, this.distance - depth);
    return add(add(middle, right, (x - this.width / 2) * size), up, (this.height / 2 - y) * size);
  }

  /// Where a point is on the screen, and its depth (negative: behind the eye).
  project(point: Vec3): { x: number; y: number; depth: number } {
    const [right, up] = this.frame();
    const offset = add(point, this.eye, -1);
    const depth = this.depthOf(point);
    const size = this.pixelSize(depth);
    return { x: this.width / 2 + dot(right, offset) / size, y: this.height / 2 - dot(up, offset) / size, depth };
  }

  /// The ray through a pixel; `direction` has unit length.
  ray(x: number, y: number): { origin: Vec3; direction: Vec3 } {
    const far = this.pointAt(x, y);
    const back = this.frame()[2];
    if (this.orthographic) return { origin: add(far, back, this.distance), direction: [-back[0], -back[1], -back[2]] };
    const eye = this.eye;
    const d = add(far, eye, -1);
    const length = Math.hypot(...d);
    return { origin: eye, direction: [d[0] / length, d[1] / length, d[2] / length] };
  }

  /// Shows a box whole, as seen from the present side, with a margin.
  fit(box: Box): void {
    this.target = centreOf(box);
    const [right, up, back] = this.frame();
    const tangent = Math.tan(kFov / 2) / 1.12;
    const wide = tangent * (this.width / this.height);
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const at = [0, 1, 2].map((i) => ((corner >> i) & 1 ? box.upper[i]! : box.lower[i]!)) as Vec3;
      const offset = add(at, this.target, -1);
      const nearer = this.orthographic ? 0 : dot(back, offset);
      distance = Math.max(distance, Math.abs(dot(right, offset)) / wide + nearer, Math.abs(dot(up, offset)) / tangent + nearer);
    }
    this.distance = Math.max(distance, 0.5 * radiusOf(box));
  }

  /// Near and far plane that hold a box, world units from the eye.
  planes(box: Box): { near: number; far: number } {
    const radius = 1.5 * radiusOf(box);
    const depth = this.depthOf(centreOf(box));
    if (this.orthographic) return { near: Math.min(depth - radius, 0), far: Math.max(depth + radius, this.distance) };
    const far = Math.max(depth + radius, this.distance * 1.5);
    return { near: Math.max(depth - radius, far * 1e-4, this.distance * 1e-3), far };
  }

  viewMatrix(): number[] {
    const eye = this.eye;
    const rows = this.frame().map((row) => [...row, -dot(row, eye)]);
    return [...rows.flat(), 0, 0, 0, 1];
  }

  /// Row by row, as OpenGL has it.
  projectionMatrix(near: number, far: number): number[] {
    const scale = 1 / Math.tan(kFov / 2);
    const aspect = this.width / this.height;
    if (this.orthographic) {
      const s = scale / this.distance;
      const depth = [0, 0, -2 / (far - near), -(far + near) / (far - near)];
      return [s / aspect, 0, 0, 0, 0, s, 0, 0, ...depth, 0, 0, 0, 1];
    }
    const depth = [0, 0, (far + near) / (near - far), (2 * far * near) / (near - far)];
    return [scale / aspect, 0, 0, 0, 0, scale, 0, 0, ...depth, 0, 0, -1, 0];
  }

  document(box: Box): CameraJson {
    const { near, far } = this.planes(box);
    return {
      view: this.viewMatrix(),
      projection: this.projectionMatrix(near, far),
      width: this.width,
      height: this.height,
    };
  }

  /// Takes over the direction of a rotation world to eye (row-major 16), such as a suggested view; roll is dropped.
  setDirection(view: number[]): void {
    const back: Vec3 = [view[8]!, view[9]!, view[10]!];
    const [x, y, z] = this.up === "y" ? back : [back[0], back[2], -back[1]];
    this.elevation = Math.asin(Math.min(Math.max(y, -1), 1));
    if (Math.hypot(x, z) > 1e-9) this.azimuth = Math.atan2(x, z);
  }

  matrices(box: Box): { view: Matrix4; projection: Matrix4; eye: Vector3 } {
    const { near, far } = this.planes(box);
    return {
      view: new Matrix4().set(...(this.viewMatrix() as Parameters<Matrix4["set"]>)),
      projection: new Matrix4().set(...(this.projectionMatrix(near, far) as Parameters<Matrix4["set"]>)),
      eye: new Vector3(...this.eye),
    };
  }
}
