// A view of the world as operations have it, to and from pixels, in double precision and without the picture.
import type { CameraJson, Pixel, Vec3 } from "../../engine/protocol";
import { add, along, cross, dot, mul, normalise, sub } from "./vec";

export interface Projected {
  x: number; // CSS pixels
  y: number;
  depth: number; // world units in front of the eye
}
export interface Ray {
  origin: Vec3;
  direction: Vec3; // unit length
}

export class View {
  readonly right: Vec3;
  readonly up: Vec3;
  readonly back: Vec3; // towards the eye
  readonly eye: Vec3;
  readonly perspective: boolean;

  constructor(readonly camera: CameraJson) {
    const v = camera.view;
    const row = (i: number): Vec3 => [v[4 * i]!, v[4 * i + 1]!, v[4 * i + 2]!];
    [this.right, this.up, this.back] = [row(0), row(1), row(2)];
    const t: Vec3 = [v[3]!, v[7]!, v[11]!];
    this.eye = mul(add(add(mul(this.right, t[0]), mul(this.up, t[1])), mul(this.back, t[2])), -1);
    this.perspective = camera.projection[14] !== 0;
  }

  private toEye(p: Vec3): Vec3 {
    const from = sub(p, this.eye);
    return [dot(this.right, from), dot(this.up, from), dot(this.back, from)];
  }

  /// Null for a point that is not in front of the eye.
  project(p: Vec3): Projected | null {
    const [ex, ey, ez] = this.toEye(p);
    const P = this.camera.projection;
    const w = this.perspective ? -ez : 1;
    if (this.perspective && w <= 0) return null;
    const nx = (P[0]! * ex + P[2]! * ez + P[3]!) / w;
    const ny = (P[5]! * ey + P[6]! * ez + P[7]!) / w;
    return { x: (nx / 2 + 0.5) * this.camera.width, y: (0.5 - ny / 2) * this.camera.height, depth: -ez };
  }

  /// The line of sight through a pixel.
  ray(x: number, y: number): Ray {
    const P = this.camera.projection;
    const nx = (x / this.camera.width - 0.5) * 2;
    const ny = (0.5 - y / this.camera.height) * 2;
    if (this.perspective) {
      const direction = this.fromEye((nx + P[2]!) / P[0]!, (ny + P[6]!) / P[5]!, -1);
      return { origin: this.eye, direction: normalise(direction) };
    }
    const side = this.fromEye((nx - P[3]!) / P[0]!, (ny - P[7]!) / P[5]!, 0);
    return { origin: add(this.eye, side), direction: mul(this.back, -1) };
  }

  private fromEye(x: number, y: number, z: number): Vec3 {
    return add(add(mul(this.right, x), mul(this.up, y)), mul(this.back, z));
  }

  /// World units that a CSS pixel is wide at the depth of `p`.
  pixelSize(p: Vec3): number {
    const depth = this.perspective ? Math.max(-this.toEye(p)[2], 1e-30) : 1;
    return (2 * depth) / (this.camera.projection[5]! * this.camera.height);
  }

  /// Where `p` comes to when it is dragged by pixels in the plane of the picture.
  dragged(p: Vec3, dx: number, dy: number): Vec3 {
    const size = this.pixelSize(p);
    return add(add(p, mul(this.right, dx * size)), mul(this.up, -dy * size));
  }

  /// Unit vector from the eye to `p`, or where the view looks.
  towards(p: Vec3): Vec3 {
    return this.perspective ? normalise(sub(p, this.eye)) : mul(this.back, -1);
  }
}

/// Distance along the axis `direction` (unit) through `origin` of the place nearest to the ray; null where both are
/// almost parallel.
export function nearestOnAxis(origin: Vec3, direction: Vec3, ray: Ray): number | null {
  const normal = cross(direction, ray.direction);
  const square = dot(normal, normal);
  if (square < 1e-4) return null;
  return dot(cross(sub(ray.origin, origin), ray.direction), normal) / square;
}

/// Where the ray meets the plane; null where it runs along it or the plane is behind the eye.
export function meetPlane(point: Vec3, normal: Vec3, ray: Ray): Vec3 | null {
  const slope = dot(ray.direction, normal);
  if (Math.abs(slope) < 1e-3) return null;
  const t = dot(sub(point, ray.origin), normal) / slope;
  return t >= 0 ? along(ray.origin, ray.direction, t) : null;
}

export function sameCamera(a: CameraJson, b: CameraJson): boolean {
  const same = (p: number[], q: number[]) => p.every((value, i) => value === q[i]);
  return a.width === b.width && a.height === b.height && same(a.view, b.view) && same(a.projection, b.projection);
}

/// The camera that sees a part where it lies by itself as `camera` sees it placed by x -> s R x + t. Turns and shifts go
/// into the view; a view has no scale, so that of an orthographic camera goes into the projection, and a perspective
/// picture does not depend on it.
export function cameraOfPart(camera: CameraJson, s: number, rotation: number[], translation: Vec3): CameraJson {
  const v = camera.view;
  const view: number[] = [];
  for (let i = 0; i < 3; ++i) {
    const row: Vec3 = [v[4 * i]!, v[4 * i + 1]!, v[4 * i + 2]!];
    for (let j = 0; j < 3; ++j) view.push(dot(row, [rotation[j]!, rotation[3 + j]!, rotation[6 + j]!]));
    view.push((dot(row, translation) + v[4 * i + 3]!) / s);
  }
  view.push(0, 0, 0, 1);
  const projection = [...camera.projection];
  if (projection[14] === 0) for (const i of [0, 5]) projection[i] = projection[i]! * s;
  return { view, projection, width: camera.width, height: camera.height };
}

export function pixelOf(e: { x: number; y: number }): Pixel {
  return [e.x, e.y];
}
