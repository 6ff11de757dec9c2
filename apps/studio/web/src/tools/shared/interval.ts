// The distance between guide points: in world units for the engine, in cells for people.
import type { Box, SceneState, Vec3 } from "../../engine/protocol";

/// A key press makes the interval so much wider; four presses double it.
const kStep = 2 ** 0.25;
/// In cells: finer adds points that the grid cannot tell apart, wider leaves gaps.
export const kFinestCells = 0.25;
export const kWidestCells = 16;

export function unionOf(boxes: Box[]): Box | null {
  if (boxes.length === 0) return null;
  const lower = [0, 1, 2].map((a) => Math.min(...boxes.map((box) => box.lower[a]!))) as Vec3;
  const upper = [0, 1, 2].map((a) => Math.max(...boxes.map((box) => box.upper[a]!))) as Vec3;
  return { lower, upper };
}

export function sceneBox(scene: SceneState | null): Box | null {
  return unionOf((scene?.clouds ?? []).map((cloud) => cloud.box));
}

export function diagonalOf(box: Box): number {
  return Math.hypot(...box.upper.map((u, a) => u - box.lower[a]!));
}

export function centreOf(box: Box): Vec3 {
  return box.lower.map((l, a) => (l + box.upper[a]!) / 2) as Vec3;
}

/// Width of the finest cells: the working cube is `scale` times the longest side of the points' box, cut in halves
/// `depth` times. Null without a scene.
export function cellWidth(scene: SceneState | null): number | null {
  const box = sceneBox(scene);
  if (!scene || !box) return null;
  const longest = Math.max(...box.upper.map((u, a) => u - box.lower[a]!));
  const scale = typeof scene.options["scale"] === "number" ? scene.options["scale"] : 1.1;
  return (scale * longest) / 2 ** (scene.options.depth ?? 8);
}

/// The interval a step wider or finer. 0 stands for one cell, and goes back to 0 where it comes by it.
export function stepInterval(interval: number, cell: number, steps: number): number {
  const cells = (interval > 0 ? interval / cell : 1) * kStep ** steps;
  const limited = Math.min(kWidestCells, Math.max(kFinestCells, cells));
  return Math.abs(limited - 1) < 1e-6 ? 0 : limited * cell;
}

/// Three figures that matter.
export function figures(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return value.toExponential(2);
  return String(Number(value.toPrecision(3)));
}

export function describeInterval(interval: number, cell: number | null): string {
  const world = interval > 0 ? interval : cell;
  if (world === null) return "one cell";
  const cells = cell ? ` = ${figures(world / cell)} ${world === cell ? "cell" : "cells"}` : "";
  return `${figures(world)}${cells}`;
}
