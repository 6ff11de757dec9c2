// A gizmo: arrows, squares, rings and boxes around a position that move, turn and scale a pose. All in pixels and
// doubles, so that it works under any renderer and is tested without one.
import type { Pixel, Vec3 } from "../../engine/protocol";
import { type Pose, moved, turned } from "./pose";
import { add, along, anyNormalTo, axisVector, cross, dot, mul, normalise, sub, turn } from "./vec";
import { type Ray, type View, meetPlane, nearestOnAxis } from "./view";

export type Axis = 0 | 1 | 2;
export type AxisKind = "move" | "plane" | "turn" | "scale"; // plane: at right angles to the axis
export type Part =
  | { kind: AxisKind; axis: Axis; own?: boolean } // own: an axis of the pose, else of the world
  | { kind: "free" } // in the plane of the picture
  | { kind: "size" }; // all axes alike

export interface GizmoOptions {
  move: boolean;
  turn: boolean;
  scale: "none" | "uniform" | "axes";
  /// Arrows along these axes only, rings about those; absent: all.
  moveAxes?: Axis[];
  turnAxes?: Axis[];
  /// Arrows and rings turn with the pose.
  own?: boolean;
}

/// CSS pixels.
export const kArm = 84;
export const kRing = 66;
export const kSquare = 24;
export const kBoxAt = 104;
export const kGrip = 9; // how near the pointer must be
const kRingPoints = 48;

export interface Grip {
  part: Part;
  id: string; // "move-x" and so on
  points: Pixel[]; // a line to draw, or one point
  faint: boolean; // seen end on: too short to be dragged
}

const letters = ["x", "y", "z"];

export function idOf(part: Part): string {
  return "axis" in part ? `${part.kind}-${letters[part.axis]}` : part.kind;
}

/// The direction that a part follows, unit length. Scales are always along the pose's own axes.
export function axisOf(part: Part, pose: Pose): Vec3 {
  return "axis" in part ? frameAxis(part, pose, part.axis) : [0, 0, 1];
}

function frameAxis(part: Part, pose: Pose, axis: number): Vec3 {
  const own = part.kind === "scale" || ("own" in part && part.own);
  return own ? turn(pose.rotation, axisVector(axis)) : axisVector(axis);
}

function linePixels(view: View, points: Vec3[]): Pixel[] {
  return points.flatMap((p) => {
    const pixel = view.project(p);
    return pixel ? [[pixel.x, pixel.y] as Pixel] : [];
  });
}

function ringPoints(pose: Pose, axis: Vec3, radius: number): Vec3[] {
  const u = anyNormalTo(axis);
  const v = cross(axis, u);
  return Array.from({ length: kRingPoints + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / kRingPoints;
    return add(pose.position, add(mul(u, radius * Math.cos(angle)), mul(v, radius * Math.sin(angle))));
  });
}

function partsOf(options: GizmoOptions): Part[] {
  const own = options.own ?? false;
  const each = (kind: AxisKind, axes: Axis[] = [0, 1, 2]): Part[] => axes.map((axis) => ({ kind, axis, own }));
  const free = options.move && !options.moveAxes;
  return [
    ...(free ? [{ kind: "free" } as Part] : []),
    ...(options.scale === "axes" ? each("scale") : []),
    ...(options.scale !== "none" ? [{ kind: "size" } as Part] : []),
    ...(options.move ? each("move", options.moveAxes) : []),
    ...(free ? each("plane") : []),
    ...(options.turn ? each("turn", options.turnAxes) : []),
  ];
}

/// The parts that can be gripped, the first in front. Empty behind the eye.
export function gripsOf(view: View, pose: Pose, options: GizmoOptions): Grip[] {
  const centre = view.project(pose.position);
  if (!centre) return [];
  const unit = view.pixelSize(pose.position);
  return partsOf(options).map((part) => {
    const axis = axisOf(part, pose);
    const points = linePixels(view, placesOf(part, pose, axis, unit, view));
    const [a, b] = [points[0], points[points.length - 1]];
    const short = !a || !b || (part.kind === "move" && Math.hypot(a[0] - b[0], a[1] - b[1]) < 14);
    return { part, id: idOf(part), points, faint: short };
  });
}

function placesOf(part: Part, pose: Pose, axis: Vec3, unit: number, view: View): Vec3[] {
  const p = pose.position;
  switch (part.kind) {
    case "free":
      return [p];
    case "move":
      return [along(p, axis, 18 * unit), along(p, axis, kArm * unit)];
    case "scale":
      return [along(p, axis, kBoxAt * unit)];
    case "size":
      return [along(along(p, view.right, kBoxAt * 0.78 * unit), view.up, kBoxAt * 0.78 * unit)];
    case "plane": {
      const [u, v] = [frameAxis(part, pose, (part.axis + 1) % 3), frameAxis(part, pose, (part.axis + 2) % 3)];
      const near = kSquare * 1.1 * unit;
      const far = kSquare * 1.9 * unit;
      const at = (a: number, b: number) => along(along(p, u, a), v, b);
      return [at(near, near), at(far, near), at(far, far), at(near, far), at(near, near)];
    }
    case "turn":
      return ringPoints(pose, axis, kRing * unit);
  }
}

function distanceToLine(points: Pixel[], [x, y]: Pixel): number {
  if (points.length === 1) return Math.hypot(points[0]![0] - x, points[0]![1] - y);
  let best = Infinity;
  for (let i = 0; i + 1 < points.length; ++i) {
    const [ax, ay] = points[i]!;
    const [bx, by] = points[i + 1]!;
    const square = (bx - ax) ** 2 + (by - ay) ** 2;
    const t = square > 0 ? Math.max(0, Math.min(1, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / square)) : 0;
    best = Math.min(best, Math.hypot(ax + t * (bx - ax) - x, ay + t * (by - ay) - y));
  }
  return best;
}

/// The part under the pointer, or null. `within`: pixels; a finger needs more than a mouse.
export function gripAt(grips: Grip[], pixel: Pixel, within = kGrip): Grip | null {
  let found: Grip | null = null;
  let least = within;
  for (const grip of grips) {
    if (grip.faint) continue;
    const inSquare = grip.part.kind === "plane" ? 0.5 : 1; // squares give way to arrows beside them
    const d = distanceToLine(grip.points, pixel) / (grip.part.kind === "free" ? 1.2 : inSquare);
    if (d < least) [least, found] = [d, grip];
  }
  return found;
}

/// A drag of one part from `from` on. Every place of the pointer gives the pose anew from that at the beginning, so
/// that rounding does not add up.
export class GizmoDrag {
  private angle = 0;
  private lastPixel: Pixel;

  constructor(
    readonly part: Part,
    private readonly start: Pose,
    private readonly view: View,
    private readonly from: Pixel,
  ) {
    this.lastPixel = from;
  }

  /// @param steps  true: whole steps, 15 degrees or a tenth
  to(pixel: Pixel, steps = false): Pose {
    switch (this.part.kind) {
      case "free":
        return this.freely(pixel);
      case "move":
        return this.alongAxis(pixel);
      case "plane":
        return this.inPlane(pixel);
      case "turn":
        return this.turning(pixel, steps);
      case "scale":
      case "size":
        return this.scaling(pixel, steps);
    }
  }

  private ray(pixel: Pixel): Ray {
    return this.view.ray(pixel[0], pixel[1]);
  }

  private freely(pixel: Pixel): Pose {
    const at = this.start.position;
    return { ...this.start, position: this.view.dragged(at, pixel[0] - this.from[0], pixel[1] - this.from[1]) };
  }

  private alongAxis(pixel: Pixel): Pose {
    const axis = axisOf(this.part, this.start);
    const before = nearestOnAxis(this.start.position, axis, this.ray(this.from));
    const now = nearestOnAxis(this.start.position, axis, this.ray(pixel));
    return before === null || now === null ? this.start : moved(this.start, mul(axis, now - before));
  }

  private inPlane(pixel: Pixel): Pose {
    const axis = axisOf(this.part, this.start);
    const before = meetPlane(this.start.position, axis, this.ray(this.from));
    const now = meetPlane(this.start.position, axis, this.ray(pixel));
    return before && now ? moved(this.start, sub(now, before)) : this.start;
  }

  private turning(pixel: Pixel, steps: boolean): Pose {
    const axis = axisOf(this.part, this.start);
    this.angle += this.angleBetween(axis, this.lastPixel, pixel);
    this.lastPixel = pixel;
    const step = Math.PI / 12;
    return turned(this.start, axis, steps ? Math.round(this.angle / step) * step : this.angle);
  }

  /// Radians about the axis from one pixel to the next: in the ring's plane, or, where that is seen from its edge,
  /// along the ring as the picture shows it.
  private angleBetween(axis: Vec3, a: Pixel, b: Pixel): number {
    const centre = this.start.position;
    const facing = Math.abs(dot(axis, this.view.towards(centre)));
    const from = meetPlane(centre, axis, this.ray(a));
    const to = meetPlane(centre, axis, this.ray(b));
    if (facing > 0.25 && from && to) {
      const [u, v] = [sub(from, centre), sub(to, centre)];
      return Math.atan2(dot(cross(u, v), axis), dot(u, v));
    }
    const tangent = normalise(cross(axis, this.view.back));
    const way: Vec3 = add(mul(this.view.right, b[0] - a[0]), mul(this.view.up, a[1] - b[1]));
    return dot(way, tangent) / kRing;
  }

  private scaling(pixel: Pixel, steps: boolean): Pose {
    const centre = this.view.project(this.start.position);
    if (!centre) return this.start;
    const reach = (p: Pixel) => Math.max(4, Math.hypot(p[0] - centre.x, p[1] - centre.y));
    const exact = reach(pixel) / reach(this.from);
    const factor = steps ? Math.max(0.1, Math.round(exact * 10) / 10) : exact;
    const axis = this.part.kind === "scale" ? this.part.axis : null;
    const scale = this.start.scale.map((s, a) => (axis === null || axis === a ? s * factor : s)) as Vec3;
    return { ...this.start, scale };
  }
}

/// What a key does to a pose: arrows move in the plane of the picture, Page keys to and from the eye, with Ctrl arrows
/// turn, + and - scale. Shift: ten times as far. Null: the key is none of the gizmo's.
export function poseByKey(e: KeyboardEvent, pose: Pose, view: View, options: GizmoOptions): Pose | null {
  const far = e.shiftKey ? 10 : 1;
  const side = { ArrowLeft: -1, ArrowRight: 1 }[e.key] ?? 0;
  const rise = { ArrowDown: -1, ArrowUp: 1 }[e.key] ?? 0;
  if (e.ctrlKey && options.turn && (side !== 0 || rise !== 0)) {
    const angle = (far * Math.PI) / 180;
    return side !== 0 ? turned(pose, view.up, side * angle) : turned(pose, view.right, -rise * angle);
  }
  const step = far * view.pixelSize(pose.position);
  if (options.move && (side !== 0 || rise !== 0)) {
    return moved(pose, add(mul(view.right, side * step), mul(view.up, rise * step)));
  }
  const depth = { PageUp: -1, PageDown: 1 }[e.key] ?? 0;
  if (options.move && depth !== 0) return moved(pose, mul(view.back, depth * step));
  const grow = { "+": 1, "=": 1, "-": -1 }[e.key] ?? 0;
  if (options.scale === "none" || grow === 0) return null;
  return { ...pose, scale: mul(pose.scale, 1.01 ** (grow * far)) };
}
