// Vectors and turns in double precision: what goes into operations is never rounded to the picture's floats.
import type { Vec3 } from "../../engine/protocol";

/// A unit quaternion x, y, z, w.
export type Quat = [number, number, number, number];
/// Three by three, row by row.
export type Mat3 = number[];

export const zero: Vec3 = [0, 0, 0];
export const noTurn: Quat = [0, 0, 0, 1];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const mul = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const along = (a: Vec3, d: Vec3, t: number): Vec3 => add(a, mul(d, t));
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Vec3, b: Vec3): number => length(sub(a, b));

/// Unit length; a zero vector stays as it is.
export function normalise(a: Vec3): Vec3 {
  const l = length(a);
  return l > 0 ? mul(a, 1 / l) : a;
}

/// The unit vector of axis 0, 1 or 2.
export function axisVector(axis: number): Vec3 {
  return [axis === 0 ? 1 : 0, axis === 1 ? 1 : 0, axis === 2 ? 1 : 0];
}

/// Some unit vector at right angles to `a`.
export function anyNormalTo(a: Vec3): Vec3 {
  const smallest = [0, 1, 2].reduce((best, i) => (Math.abs(a[i]!) < Math.abs(a[best]!) ? i : best), 0);
  return normalise(cross(a, axisVector(smallest)));
}

/// @param angle radians, counter-clockwise seen against the axis
export function turnAbout(axis: Vec3, angle: number): Quat {
  const [x, y, z] = mul(normalise(axis), Math.sin(angle / 2));
  return [x, y, z, Math.cos(angle / 2)];
}

/// First b, then a.
export function turnAfter(a: Quat, b: Quat): Quat {
  const [ax, ay, az, aw] = a;
  const [bx, by, bz, bw] = b;
  const q: Quat = [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
  const l = Math.hypot(...q);
  return [q[0] / l, q[1] / l, q[2] / l, q[3] / l];
}

export function matrixOf([x, y, z, w]: Quat): Mat3 {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
  ];
}

export function transform(m: Mat3, v: Vec3): Vec3 {
  return [
    m[0]! * v[0] + m[1]! * v[1] + m[2]! * v[2],
    m[3]! * v[0] + m[4]! * v[1] + m[5]! * v[2],
    m[6]! * v[0] + m[7]! * v[1] + m[8]! * v[2],
  ];
}

export const turn = (q: Quat, v: Vec3): Vec3 => transform(matrixOf(q), v);

/// Axis and angle in [0, pi]; the z axis where nothing turns.
export function axisAngleOf([x, y, z, w]: Quat): { axis: Vec3; angle: number } {
  const s = Math.hypot(x, y, z);
  if (s < 1e-12) return { axis: [0, 0, 1], angle: 0 };
  const sign = w < 0 ? -1 : 1;
  return { axis: [(sign * x) / s, (sign * y) / s, (sign * z) / s], angle: 2 * Math.atan2(s, Math.abs(w)) };
}

/// Degrees about x, then y, then z, as the fields of a panel show a turn.
export function degreesOf(q: Quat): Vec3 {
  const m = matrixOf(q);
  const toDegrees = 180 / Math.PI;
  const y = Math.asin(Math.max(-1, Math.min(1, -m[6]!)));
  if (Math.abs(m[6]!) > 1 - 1e-12) return [Math.atan2(-m[5]!, m[4]!) * toDegrees, y * toDegrees, 0];
  return [Math.atan2(m[7]!, m[8]!) * toDegrees, y * toDegrees, Math.atan2(m[3]!, m[0]!) * toDegrees];
}

export function turnOfDegrees([x, y, z]: Vec3): Quat {
  const radians = Math.PI / 180;
  const about = (axis: number, degrees: number) => turnAbout(axisVector(axis), degrees * radians);
  return turnAfter(about(2, z), turnAfter(about(1, y), about(0, x)));
}
