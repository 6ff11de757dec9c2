// Strokes and areas of the picture: fewer points with the same course, closed loops, what is inside.
// Source of the simplification: Douglas & Peucker 1973.
import type { Area, Pixel } from "../../engine/protocol";

/// Points of a stroke or a loop at most, so that operations stay small.
export const kMostPoints = 500;
/// Pixels that a simplified line may run beside the drawn one.
export const kTolerance = 0.5;
/// A loop that encloses less is a slip of the hand; pixels^2.
export const kSmallestArea = 9;

function distanceToSegment(p: Pixel, a: Pixel, b: Pixel): number {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  const square = dx * dx + dy * dy;
  const t = square > 0 ? Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square)) : 0;
  return Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

/// The indices kept, rising, with the first and the last.
function keep(points: Pixel[], tolerance: number): number[] {
  const kept = new Set([0, points.length - 1]);
  const spans: [number, number][] = [[0, points.length - 1]];
  for (let span = spans.pop(); span; span = spans.pop()) {
    const [from, to] = span;
    let farthest = -1;
    let most = tolerance;
    for (let i = from + 1; i < to; ++i) {
      const d = distanceToSegment(points[i]!, points[from]!, points[to]!);
      if (d > most) [most, farthest] = [d, i];
    }
    if (farthest < 0) continue;
    kept.add(farthest);
    spans.push([from, farthest], [farthest, to]);
  }
  return [...kept].sort((a, b) => a - b);
}

/// The same course to within `tolerance` pixels with at most `most` points; the tolerance grows where it must.
export function simplify(points: Pixel[], tolerance = kTolerance, most = kMostPoints): Pixel[] {
  if (points.length < 3) return points;
  let kept = keep(points, tolerance);
  for (let wider = tolerance * 1.5; kept.length > most; wider *= 1.5) kept = keep(points, wider);
  return kept.map((i) => points[i]!);
}

/// The same for a closed loop, whose last point is not its first again.
export function simplifyLoop(loop: Pixel[], tolerance = kTolerance, most = kMostPoints): Pixel[] {
  const closed = closeLoop(loop);
  if (closed.length < 4) return closed;
  // Cut where the loop is farthest from its beginning: a line from a point to itself keeps nothing between.
  const [x, y] = closed[0]!;
  const farthest = closed.reduce((best, p, i) => {
    const [bx, by] = closed[best]!;
    return Math.hypot(p[0] - x, p[1] - y) > Math.hypot(bx - x, by - y) ? i : best;
  }, 0);
  const half = Math.floor(most / 2);
  const there = simplify(closed.slice(0, farthest + 1), tolerance, half);
  const back = simplify([...closed.slice(farthest), closed[0]!], tolerance, half);
  return [...there.slice(0, -1), ...back.slice(0, -1)];
}

/// Without points that repeat the one before, the last before the first included.
export function closeLoop(loop: Pixel[]): Pixel[] {
  const differs = (a: Pixel, b: Pixel) => a[0] !== b[0] || a[1] !== b[1];
  const kept = loop.filter((p, i) => i === 0 || differs(p, loop[i - 1]!));
  while (kept.length > 1 && !differs(kept[0]!, kept[kept.length - 1]!)) kept.pop();
  return kept;
}

/// Positive where the loop runs clockwise on the screen, whose y points down.
export function signedArea(loop: Pixel[]): number {
  let twice = 0;
  loop.forEach(([x, y], i) => {
    const [nx, ny] = loop[(i + 1) % loop.length]!;
    twice += x * ny - nx * y;
  });
  return twice / 2;
}

/// Clockwise on the screen. Even-odd does not depend on it; scripts compare more easily.
export function oriented(loop: Pixel[]): Pixel[] {
  return signedArea(loop) < 0 ? [...loop].reverse() : loop;
}

/// A drawn loop made fit for an operation; null where it encloses nothing worth it.
export function tidyLoop(points: Pixel[]): Pixel[] | null {
  const loop = simplifyLoop(points);
  return loop.length >= 3 && Math.abs(signedArea(loop)) >= kSmallestArea ? oriented(loop) : null;
}

/// Inside of an odd number of loops.
export function isInside(area: Area, [x, y]: Pixel): boolean {
  let inside = false;
  for (const loop of area) {
    loop.forEach(([ax, ay], i) => {
      const [bx, by] = loop[(i + 1) % loop.length]!;
      if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
    });
  }
  return inside;
}

const text = ([x, y]: Pixel) => `${x.toFixed(1)} ${y.toFixed(1)}`;

/// Path data of a line.
export function linePath(points: Pixel[]): string {
  return points.length > 0 ? `M${points.map(text).join("L")}` : "";
}

/// Path data of closed loops.
export function areaPath(area: Area): string {
  return area.map((loop) => `${linePath(loop)}Z`).join("");
}
