// The control points of a lattice: where they are, which of them a pointer is on, and their edges.
import type { Box, Pixel, Vec3 } from "../../engine/protocol";
import type { LatticeState } from "./documents";
import { add, axisVector, mul, sub, zero } from "./vec";
import { type View, nearestOnAxis } from "./view";

export interface ControlPoint {
  key: string; // "i,j,k"
  at: Vec3; // world, as moved
}

export function restPoint({ box, spans }: LatticeState, [i, j, k]: Vec3): Vec3 {
  const place = (a: number, index: number) => box.lower[a]! + ((box.upper[a]! - box.lower[a]!) * index) / spans[a]!;
  return [place(0, i), place(1, j), place(2, k)];
}

export function controlPoint(lattice: LatticeState, index: Vec3): ControlPoint {
  const key = index.join(",");
  return { key, at: add(restPoint(lattice, index), lattice.moves.get(key) ?? zero) };
}

function indices(spans: Vec3): Vec3[] {
  const list: Vec3[] = [];
  for (let i = 0; i <= spans[0]; ++i) {
    for (let j = 0; j <= spans[1]; ++j) for (let k = 0; k <= spans[2]; ++k) list.push([i, j, k]);
  }
  return list;
}

export function controlPoints(lattice: LatticeState): ControlPoint[] {
  return indices(lattice.spans).map((index) => controlPoint(lattice, index));
}

/// From each control point to the next along each axis.
export function edges(lattice: LatticeState): [Vec3, Vec3][] {
  return indices(lattice.spans).flatMap((index) =>
    [0, 1, 2].flatMap((axis): [Vec3, Vec3][] => {
      if (index[axis]! >= lattice.spans[axis]!) return [];
      const next = add(index, axisVector(axis));
      return [[controlPoint(lattice, index).at, controlPoint(lattice, next).at]];
    }),
  );
}

/// The control point under a pixel, the nearest to the eye of those within `within` pixels.
export function pointAt(points: ControlPoint[], view: View, pixel: Pixel, within: number): ControlPoint | null {
  let found: ControlPoint | null = null;
  let depth = Infinity;
  for (const point of points) {
    const p = view.project(point.at);
    if (!p || p.depth >= depth || Math.hypot(p.x - pixel[0], p.y - pixel[1]) > within) continue;
    [found, depth] = [point, p.depth];
  }
  return found;
}

/// All control points that are seen in a rectangle.
export function pointsIn(points: ControlPoint[], view: View, [x0, y0, x1, y1]: [number, number, number, number]): string[] {
  const inside = ({ at }: ControlPoint) => {
    const p = view.project(at);
    return p !== null && p.x >= x0 && p.x <= x1 && p.y >= y0 && p.y <= y1;
  };
  return points.filter(inside).map((point) => point.key);
}

export type Constraint = "view" | "x" | "y" | "z";

/// How far a point at `from` is dragged by the pointer from one pixel to another, world units.
export function dragBy(view: View, from: Vec3, before: Pixel, now: Pixel, along: Constraint): Vec3 {
  if (along === "view") return sub(view.dragged(from, now[0] - before[0], now[1] - before[1]), from);
  const axis = axisVector("xyz".indexOf(along));
  const start = nearestOnAxis(from, axis, view.ray(before[0], before[1]));
  const end = nearestOnAxis(from, axis, view.ray(now[0], now[1]));
  return start === null || end === null ? zero : mul(axis, end - start);
}

/// A box a little larger all around, so that the surface is well inside.
export function grown(box: Box, share: number): Box {
  const by = box.upper.map((u, a) => (u - box.lower[a]!) * share);
  const longest = Math.max(...by);
  return {
    lower: box.lower.map((l, a) => l - Math.max(by[a]!, longest / 10)) as Vec3,
    upper: box.upper.map((u, a) => u + Math.max(by[a]!, longest / 10)) as Vec3,
  };
}
