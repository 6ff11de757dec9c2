// A box with a handle on each face, to be dragged along its axis; in the coordinates of a part that lies placed.
import { type SVGTemplateResult, svg } from "lit";
import type { Box, Pixel, Vec3 } from "../../engine/protocol";
import { drawHandle, drawPath, kBlue } from "./draw";
import { isNear } from "./gestures";
import { centreOf } from "./interval";
import type { Pose } from "./pose";
import { linePath } from "./shapes";
import { add, axisVector, mul, sub, turn } from "./vec";
import { View, nearestOnAxis } from "./view";

export interface Face {
  axis: number;
  side: "lower" | "upper";
}

/// From the part's own coordinates to the world's.
export function placed(p: Vec3, pose: Pose, pivot: Vec3): Vec3 {
  return add(pose.position, turn(pose.rotation, mul(sub(p, pivot), pose.scale[0])));
}

const kFaces: Face[] = [0, 1, 2].flatMap((axis): Face[] => [{ axis, side: "lower" }, { axis, side: "upper" }]);

function faceCentre(box: Box, { axis, side }: Face): Vec3 {
  return centreOf(box).map((c, a) => (a === axis ? box[side][a]! : c)) as Vec3;
}

function facePixel(view: View, box: Box, face: Face, pose: Pose, pivot: Vec3): Pixel | null {
  const p = view.project(placed(faceCentre(box, face), pose, pivot));
  return p && [p.x, p.y];
}

/// The face whose handle is under a pixel.
export function faceAt(view: View, box: Box, pose: Pose, pivot: Vec3, pixel: Pixel): Face | null {
  const under = (face: Face) => {
    const at = facePixel(view, box, face, pose, pivot);
    return at !== null && isNear(at, pixel, 10);
  };
  return kFaces.find(under) ?? null;
}

export interface FaceDrag {
  face: Face;
  box: Box; // as it began
  from: Pixel;
  view: View;
}

/// The box with a face dragged along its axis; it never turns inside out.
export function dragFace({ face, box, from, view }: FaceDrag, pose: Pose, pivot: Vec3, to: Pixel): Box {
  const origin = placed(faceCentre(box, face), pose, pivot);
  const axis = turn(pose.rotation, axisVector(face.axis));
  const before = nearestOnAxis(origin, axis, view.ray(from[0], from[1]));
  const now = nearestOnAxis(origin, axis, view.ray(to[0], to[1]));
  if (before === null || now === null) return box;
  const wanted = box[face.side][face.axis]! + (now - before) / pose.scale[0];
  const opposite = box[face.side === "lower" ? "upper" : "lower"][face.axis]!;
  const limited = face.side === "lower" ? Math.min(wanted, opposite) : Math.max(wanted, opposite);
  const corner = box[face.side].map((v, a) => (a === face.axis ? limited : v)) as Vec3;
  return { ...box, [face.side]: corner };
}

const kCorners = [0, 1, 2, 3, 4, 5, 6, 7];

export function drawBox(view: View, box: Box, pose: Pose, pivot: Vec3, handles: boolean): SVGTemplateResult {
  const corner = (bits: number) =>
    placed([0, 1, 2].map((a) => (bits & (1 << a) ? box.upper[a]! : box.lower[a]!)) as Vec3, pose, pivot);
  const pixel = (p: Vec3): Pixel[] => {
    const at = view.project(p);
    return at ? [[at.x, at.y]] : [];
  };
  const lines = kCorners.flatMap((from) =>
    [1, 2, 4].filter((bit) => !(from & bit)).map((bit) => [...pixel(corner(from)), ...pixel(corner(from | bit))]),
  );
  return svg`${drawPath(lines.filter((line) => line.length === 2).map(linePath).join(""), { colour: kBlue, width: 1, faint: !handles })}
    ${handles ? kFaces.map((face) => {
      const at = facePixel(view, box, face, pose, pivot);
      return at ? drawHandle(at, false, `part-face-${"xyz"[face.axis]}-${face.side}`, kBlue) : svg``;
    }) : svg``}`;
}
