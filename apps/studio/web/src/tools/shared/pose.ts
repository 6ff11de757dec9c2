// Where something is put: position, turn and stretch about a pivot of its own, and what operations say of it.
import type { HandleJson, Similarity, Vec3 } from "../../engine/protocol";
import { type Quat, add, axisAngleOf, matrixOf, mul, noTurn, sub, transform, turnAbout, turnAfter } from "./vec";

export interface Pose {
  position: Vec3; // where the pivot is, world
  rotation: Quat;
  scale: Vec3; // along the own axes, before the turn; each > 0
  /// Set while all turning was about one axis: angles above half a turn, which a quaternion forgets. Radians.
  spin?: { axis: Vec3; angle: number };
}

export function poseAt(position: Vec3): Pose {
  return { position, rotation: noTurn, scale: [1, 1, 1], spin: { axis: [0, 0, 1], angle: 0 } };
}

export function isAtRest(pose: Pose, pivot: Vec3): boolean {
  return (
    pose.position.every((v, i) => v === pivot[i]) &&
    pose.scale.every((s) => s === 1) &&
    (pose.spin ? pose.spin.angle === 0 : axisAngleOf(pose.rotation).angle === 0)
  );
}

/// Turned further about an axis through its position.
export function turned(pose: Pose, axis: Vec3, angle: number): Pose {
  const rotation = turnAfter(turnAbout(axis, angle), pose.rotation);
  const before = pose.spin;
  if (!before) return { ...pose, rotation };
  const facing = before.axis[0] * axis[0] + before.axis[1] * axis[1] + before.axis[2] * axis[2];
  if (before.angle === 0) return { ...pose, rotation, spin: { axis, angle } };
  if (Math.abs(facing) < 1 - 1e-9) return { position: pose.position, rotation, scale: pose.scale };
  return { ...pose, rotation, spin: { axis: before.axis, angle: before.angle + Math.sign(facing) * angle } };
}

export function moved(pose: Pose, by: Vec3): Pose {
  return { ...pose, position: add(pose.position, by) };
}

/// x -> scale R x + translation with the pivot at the pose's position. Uses the scale along x.
export function similarityOf(pose: Pose, pivot: Vec3): Required<Similarity> & { rotation: number[] } {
  const scale = pose.scale[0];
  const rotation = matrixOf(pose.rotation);
  return { scale, rotation, translation: sub(pose.position, mul(transform(rotation, pivot), scale)) };
}

/// The rigid motion of a handle about its centre.
export function rigidOf(pose: Pose, centre: Vec3): NonNullable<HandleJson["rigid"]> {
  const { axis, angle } = pose.spin ?? axisAngleOf(pose.rotation);
  return { axis, point: centre, degrees: (angle * 180) / Math.PI, translation: sub(pose.position, centre) };
}

/// x -> R S (x - centre) + position, as three rows of four.
export function affineOf(pose: Pose, centre: Vec3): NonNullable<HandleJson["affine"]> {
  const rotation = matrixOf(pose.rotation);
  const stretched = rotation.map((value, i) => value * pose.scale[i % 3]!);
  const shift = sub(pose.position, transform(stretched, centre));
  const matrix = [0, 1, 2].map((row) => [...stretched.slice(3 * row, 3 * row + 3), shift[row]!]);
  return { matrix, pivot: centre };
}
