// The JSON of operations from what tools hold. The same documents go to the engine, the history and scripts.
import type {
  Area, BooleanOperation, CameraJson, DeformOperation, FlipOperation, GuideOperation, HandleJson, InsertOperation,
  LatticeJson, Layers, OrientOperation, RemoveOperation, Vec3,
} from "../../engine/protocol";
import type { Box } from "../../engine/protocol";
import type { Shape } from "./gestures";
import { type Pose, affineOf, isAtRest, rigidOf, similarityOf } from "./pose";
import { cameraOfPart } from "./view";

type Region = { area: Area } | { rectangle: [number, number, number, number] };

/// @throws TypeError for a stroke, which encloses nothing
export function regionOf(shape: Shape): Region {
  if (shape.kind === "rectangle") return { rectangle: shape.corners };
  if (shape.kind === "area") return { area: shape.loops };
  throw new TypeError("a stroke encloses nothing");
}

export function areaOf(shape: Shape): Area {
  const region = regionOf(shape);
  if ("area" in region) return region.area;
  const [x0, y0, x1, y1] = region.rectangle;
  return [[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]];
}

export interface GuideSettings {
  interval: number; // world units; 0: the width of the finest cells
  normals: "cloud" | "stroke";
  insideOnly: boolean;
}

/// Normals of the stroke need a stroke with a length, so that a click takes those of the cloud.
export function guideOf(camera: CameraJson, shape: Shape, settings: GuideSettings): GuideOperation {
  const region = shape.kind === "stroke" ? { stroke: shape.points } : regionOf(shape);
  const line = shape.kind === "stroke" && shape.points.length > 1;
  return {
    op: "guide",
    camera,
    ...region,
    interval: settings.interval,
    normals: line ? settings.normals : "cloud",
    inside_only: settings.insideOnly,
  };
}

export function removeOf(camera: CameraJson, shape: Shape, originals: boolean, layers: Layers): RemoveOperation {
  return { op: "remove", camera, ...regionOf(shape), originals, layers };
}

export function flipOf(camera: CameraJson, shape: Shape, layers: Layers): FlipOperation {
  return { op: "flip", camera, ...regionOf(shape), layers };
}

/// A file below the root, one that the page has sent, or a generated shape.
export type Source = { file: string } | { upload: number } | { shape: string; points?: number };

export interface Part {
  source: Source;
  pose: Pose;
  pivot: Vec3; // in the part's own world coordinates
  box: Box | null; // null: all of it
  snap: boolean;
  /// A lasso on the part as it lies placed, and the camera it was drawn with.
  lasso: { camera: CameraJson; area: Area; pose: Pose } | null;
}

export function insertOf(part: Part): InsertOperation {
  const operation: InsertOperation = { op: "insert", ...part.source, ...similarityOf(part.pose, part.pivot) };
  if (part.box) operation.box = part.box;
  operation.snap = part.snap;
  if (part.lasso) {
    const { scale, rotation, translation } = similarityOf(part.lasso.pose, part.pivot);
    operation.camera = cameraOfPart(part.lasso.camera, scale, rotation, translation);
    operation.area = part.lasso.area;
  }
  return operation;
}

export interface Ball {
  centre: Vec3;
  radius: number;
  pose: Pose; // of the centre
}

/// @param affine  false: rigid, scales do not count
export function bendOf(balls: Ball[], affine: boolean): DeformOperation {
  return {
    op: "deform",
    handles: balls.map(({ centre, radius, pose }) => {
      const handle: HandleJson = { region: { ball: { centre, radius } } };
      if (isAtRest(pose, centre)) return handle;
      return affine ? { ...handle, affine: affineOf(pose, centre) } : { ...handle, rigid: rigidOf(pose, centre) };
    }),
  };
}

export interface LatticeState {
  box: Box;
  spans: Vec3; // one less than the control points along each axis
  moves: Map<string, Vec3>; // by "i,j,k"
  outside: "extend" | "stay";
}

export function latticeOf(lattice: LatticeState): DeformOperation {
  const moves = [...lattice.moves]
    .filter(([, by]) => by.some((v) => v !== 0))
    .map(([at, by]) => ({ at: at.split(",").map(Number) as Vec3, by }));
  const json: LatticeJson = { box: lattice.box, spans: lattice.spans, moves, outside: lattice.outside };
  return { op: "deform", lattices: [json] };
}

export interface Combination {
  operation: BooleanOperation["operation"];
  source: Source;
  pose: Pose;
  pivot: Vec3;
  creases: "sampled" | "none";
}

export function booleanOf(c: Combination): BooleanOperation {
  return {
    op: "boolean",
    operation: c.operation,
    with: c.source,
    ...similarityOf(c.pose, c.pivot),
    creases: c.creases,
  };
}

export function orientOf(method: OrientOperation["method"], sensors: Vec3[]): OrientOperation {
  return sensors.length > 0 && method !== "turn" ? { op: "orient", method, sensors } : { op: "orient", method };
}
