// What a hand does to water: where it is in the tank, how fast it moves, and the forces that follow.
import type { Pixel, Vec3 } from "../../engine/protocol";
import { length, mul, normalise, sub } from "./vec";
import { type View, meetPlane } from "./view";

export interface Force {
  kind: "push" | "swirl";
  centre: Vec3; // metres
  direction: Vec3;
  radius: number;
  strength: number; // metres / second^2
}

/// What the frames of a simulation say beside their surface.
export interface WaterFacts {
  tank: Vec3; // upper corner, metres; the lower one is the origin
  obstacle: { centre: Vec3; radius: number } | null;
}

export function readFacts(event: object): WaterFacts | null {
  const { tank, obstacle } = event as Partial<WaterFacts>;
  return Array.isArray(tank) ? { tank, obstacle: obstacle ?? null } : null;
}

/// Where the pointer is in the water: on what is under it, else in the plane through `depth` that faces the view; kept
/// inside of the tank.
export function placeInWater(view: View, pixel: Pixel, depth: Vec3, tank: Vec3): Vec3 | null {
  const p = meetPlane(depth, view.back, view.ray(pixel[0], pixel[1]));
  return p && insideTank(p, tank, 0);
}

export function insideTank(p: Vec3, tank: Vec3, margin: number): Vec3 {
  return p.map((v, a) => Math.min(Math.max(v, margin), Math.max(tank[a]! - margin, margin))) as Vec3;
}

/// Speed at which a push has its full strength, metres / second.
const kFullSpeed = 1.5;

export interface Hand {
  radius: number; // metres
  strength: number; // metres / second^2
  back: Vec3; // towards the eye: swirls turn about it
}

/// The force of a hand that went from one place to another in so many seconds; null while it rests.
export function forceOf(kind: Force["kind"], from: Vec3, to: Vec3, seconds: number, { radius, strength, back }: Hand): Force | null {
  const way = sub(to, from);
  const speed = length(way) / Math.max(seconds, 1e-3);
  if (kind === "swirl") return { kind, centre: to, direction: back, radius, strength };
  if (speed < 1e-3) return null;
  return { kind, centre: to, direction: normalise(way), radius, strength: strength * Math.min(speed / kFullSpeed, 1) };
}

/// Half of the smallest side: as large as a push is useful.
export function widestRadius(tank: Vec3): number {
  return Math.min(...tank) / 2;
}

export function middleOf(tank: Vec3): Vec3 {
  return mul(tank, 0.5);
}
