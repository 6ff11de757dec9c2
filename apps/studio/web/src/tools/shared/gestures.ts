// What a hand draws, as little machines from pointer events to a shape of the picture. They know no page.
import type { Area, Pixel } from "../../engine/protocol";
import { kSmallestArea, signedArea, simplify, tidyLoop } from "./shapes";

export type Shape =
  | { kind: "stroke"; points: Pixel[] }
  | { kind: "rectangle"; corners: [number, number, number, number] }
  | { kind: "area"; loops: Area };

/// Pixels within which a click is on a corner.
export const kNear = 8;
/// Pixels that the hand must move before the next point of a line counts.
const kStep = 1;

export function isNear(a: Pixel, b: Pixel, within = kNear): boolean {
  return Math.hypot(a[0] - b[0], a[1] - b[1]) <= within;
}

export interface Gesture {
  readonly drawing: boolean; // a button is down, or corners are being set
  down(p: Pixel, add: boolean): void; // add: to the loops that are there
  move(p: Pixel): void; // also without a button
  up(p: Pixel): void;
  key?(key: string): boolean; // true: taken
  /// What is complete; null while there is nothing.
  shape(): Shape | null;
  /// What is being drawn, for the overlay.
  open(): Pixel[];
  /// Loops that are complete while another is drawn.
  closed?(): Area;
  /// Corners of the one being drawn.
  corners?(): Pixel[];
  /// Puts an edited shape in the place of what was drawn.
  replace(shape: Shape): void;
  clear(): void;
}

export class StrokeGesture implements Gesture {
  drawing = false;
  private points: Pixel[] = [];
  private done: Pixel[] | null = null;

  down(p: Pixel): void {
    this.clear();
    this.drawing = true;
    this.points = [p];
  }
  move(p: Pixel): void {
    if (this.drawing && !isNear(p, this.points[this.points.length - 1]!, kStep)) this.points.push(p);
  }
  up(p: Pixel): void {
    if (!this.drawing) return;
    this.move(p);
    this.drawing = false;
    this.done = simplify(this.points);
  }
  shape(): Shape | null {
    return this.done && { kind: "stroke", points: this.done };
  }
  open(): Pixel[] {
    return this.drawing ? this.points : [];
  }
  replace(shape: Shape): void {
    if (shape.kind === "stroke") this.done = shape.points;
  }
  clear(): void {
    this.drawing = false;
    this.points = [];
    this.done = null;
  }
}

export class RectangleGesture implements Gesture {
  drawing = false;
  private from: Pixel = [0, 0];
  private to: Pixel = [0, 0];
  private done = false;

  down(p: Pixel): void {
    this.clear();
    this.drawing = true;
    this.from = this.to = p;
  }
  move(p: Pixel): void {
    if (this.drawing) this.to = p;
  }
  up(p: Pixel): void {
    if (!this.drawing) return;
    this.to = p;
    this.drawing = false;
    this.done = Math.abs(signedArea(this.loop())) >= kSmallestArea;
  }
  private loop(): Pixel[] {
    const [x0, y0, x1, y1] = this.bounds();
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  }
  private bounds(): [number, number, number, number] {
    const [ax, ay] = this.from;
    const [bx, by] = this.to;
    return [Math.min(ax, bx), Math.min(ay, by), Math.max(ax, bx), Math.max(ay, by)];
  }
  shape(): Shape | null {
    return this.done ? { kind: "rectangle", corners: this.bounds() } : null;
  }
  open(): Pixel[] {
    return this.drawing ? [...this.loop(), this.loop()[0]!] : [];
  }
  replace(shape: Shape): void {
    if (shape.kind !== "rectangle") return;
    const [x0, y0, x1, y1] = shape.corners;
    [this.from, this.to] = [[x0, y0], [x1, y1]];
    this.done = true;
  }
  clear(): void {
    this.drawing = this.done = false;
  }
}

/// Loops one after another; `add` keeps those before, so that one inside another is a hole.
export class LassoGesture implements Gesture {
  drawing = false;
  private points: Pixel[] = [];
  private loops: Area = [];

  down(p: Pixel, add: boolean): void {
    if (!add) this.loops = [];
    this.drawing = true;
    this.points = [p];
  }
  move(p: Pixel): void {
    if (this.drawing && !isNear(p, this.points[this.points.length - 1]!, kStep)) this.points.push(p);
  }
  up(p: Pixel): void {
    if (!this.drawing) return;
    this.move(p);
    this.drawing = false;
    const loop = tidyLoop(this.points);
    if (loop) this.loops = [...this.loops, loop];
    this.points = [];
  }
  shape(): Shape | null {
    return this.loops.length > 0 && !this.drawing ? { kind: "area", loops: this.loops } : null;
  }
  open(): Pixel[] {
    return this.points;
  }
  closed(): Area {
    return this.loops;
  }
  replace(shape: Shape): void {
    if (shape.kind === "area") this.loops = shape.loops;
  }
  clear(): void {
    this.drawing = false;
    this.points = [];
    this.loops = [];
  }
}

/// Corners by clicks. Backspace takes the last back, Enter or a click on the first closes.
export class PolygonGesture implements Gesture {
  private points: Pixel[] = [];
  private hover: Pixel | null = null;
  private loops: Area = [];

  get drawing(): boolean {
    return this.points.length > 0;
  }
  down(p: Pixel, add: boolean): void {
    if (this.points.length >= 3 && isNear(p, this.points[0]!)) return this.close();
    if (this.points.length === 0 && !add) this.loops = [];
    const last = this.points[this.points.length - 1];
    if (!last || !isNear(p, last, 2)) this.points = [...this.points, p];
    this.hover = p;
  }
  move(p: Pixel): void {
    this.hover = p;
  }
  up(): void {}
  key(key: string): boolean {
    if (!this.drawing) return false;
    if (key === "Backspace") this.points = this.points.slice(0, -1);
    else if (key === "Enter") this.close();
    else return false;
    return true;
  }
  private close(): void {
    const loop = tidyLoop(this.points);
    if (!loop) return;
    this.loops = [...this.loops, loop];
    this.points = [];
  }
  shape(): Shape | null {
    return this.loops.length > 0 && !this.drawing ? { kind: "area", loops: this.loops } : null;
  }
  open(): Pixel[] {
    return this.drawing && this.hover ? [...this.points, this.hover] : this.points;
  }
  corners(): Pixel[] {
    return this.points;
  }
  closed(): Area {
    return this.loops;
  }
  replace(shape: Shape): void {
    if (shape.kind === "area") this.loops = shape.loops;
  }
  clear(): void {
    this.points = [];
    this.loops = [];
    this.hover = null;
  }
}

// ---- handles: corners of a complete shape that can be dragged ----

/// A shape with more corners than this is drawn again rather than mended by its corners.
const kMostHandles = 40;

export function handlesOf(shape: Shape): Pixel[] {
  if (shape.kind === "rectangle") {
    const [x0, y0, x1, y1] = shape.corners;
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  }
  const points = shape.kind === "stroke" ? shape.points : shape.loops.flat();
  return points.length <= kMostHandles ? points : [];
}

/// The shape with handle `i` at `p`.
export function withHandle(shape: Shape, i: number, p: Pixel): Shape {
  if (shape.kind === "rectangle") {
    const corners: [number, number, number, number] = [...shape.corners];
    corners[i === 0 || i === 3 ? 0 : 2] = p[0];
    corners[i < 2 ? 1 : 3] = p[1];
    return { kind: "rectangle", corners };
  }
  const put = (points: Pixel[], from: number) => points.map((q, k) => (from + k === i ? p : q));
  if (shape.kind === "stroke") return { kind: "stroke", points: put(shape.points, 0) };
  let from = 0;
  const loops = shape.loops.map((loop) => {
    const moved = put(loop, from);
    from += loop.length;
    return moved;
  });
  return { kind: "area", loops };
}
