// Messages between the page and the engine. Requests have an id and get one reply; events come by themselves.
// All coordinates are world coordinates, all matrices are row-major, all times are milliseconds.

export type Vec3 = [number, number, number];
export type Pixel = [number, number];
export interface Box {
  lower: Vec3;
  upper: Vec3;
}

/// As docs/edit.schema.json has a camera in matrices; pixels are CSS pixels of the canvas.
export interface CameraJson {
  view: number[]; // world to eye, 16 numbers
  projection: number[]; // eye to clip, 16 numbers
  width: number;
  height: number;
}

/// A region of the picture: closed polygons in pixels, even-odd.
export type Area = Pixel[][];
export type Layers = "through" | "front";

export interface Similarity {
  scale?: number;
  rotation?: number[] | { axis: Vec3; degrees: number }; // nine numbers row by row
  translation?: Vec3;
}

// ---- operations: the same JSON in scripts, history, session files and on the wire ----

export interface GuideOperation {
  op: "guide";
  camera: CameraJson;
  stroke?: Pixel[];
  area?: Area;
  rectangle?: [number, number, number, number];
  interval?: number; // world units; 0: width of the finest cells
  normals?: "cloud" | "stroke";
  inside_only?: boolean;
}
export interface RemoveOperation {
  op: "remove";
  camera: CameraJson;
  area?: Area;
  rectangle?: [number, number, number, number];
  originals?: boolean;
  layers?: Layers;
}
export interface FlipOperation {
  op: "flip";
  camera: CameraJson;
  area?: Area;
  rectangle?: [number, number, number, number];
  layers?: Layers;
}
export interface InsertOperation extends Similarity {
  op: "insert";
  file?: string;
  upload?: number; // of a file that the page has sent; the history has its path
  shape?: string;
  box?: Partial<Box>;
  snap?: boolean;
  camera?: CameraJson;
  area?: Area;
}
export interface HandleJson {
  region: Record<string, unknown>;
  rigid?: { axis?: Vec3; point?: Vec3; degrees?: number; translation?: Vec3 };
  affine?: { matrix: number[][]; pivot?: Vec3 };
}
export interface LatticeJson {
  box?: Box;
  origin?: Vec3;
  axes?: Vec3[];
  spans: Vec3;
  control?: Vec3[];
  moves?: { at: Vec3; by: Vec3 }[];
  outside?: "extend" | "stay";
}
export interface DeformOperation {
  op: "deform";
  handles?: HandleJson[];
  lattices?: LatticeJson[];
}
export interface BooleanOperation extends Similarity {
  op: "boolean";
  operation: "union" | "intersection" | "difference" | "symmetric";
  with: { file: string } | { upload: number } | { shape: string; points?: number };
  creases?: "sampled" | "none";
  coincidence?: number;
}
export interface OrientOperation {
  op: "orient";
  method: "estimate" | "repair" | "turn";
  sensors?: Vec3[];
  [option: string]: unknown;
}
export interface OptionsOperation extends Options {
  op: "options";
}
export type Operation =
  | GuideOperation
  | RemoveOperation
  | FlipOperation
  | InsertOperation
  | DeformOperation
  | BooleanOperation
  | OrientOperation
  | OptionsOperation;

/// Keys as `options` of docs/edit.schema.json; those the page sets have their types here.
export interface Options {
  depth?: number;
  field?: "poisson" | "distance";
  screening?: number;
  iterations?: number;
  samples_per_node?: number;
  fixed_screening?: boolean;
  boundary?: "free" | "dirichlet";
  trim?: number;
  [option: string]: unknown;
}

// ---- state ----

export interface Topology {
  components: number;
  genus: number;
  euler: number;
}
export interface StepRecord {
  operation: string;
  added: number;
  removed: number;
  points: number;
  triangles: number;
  before: Topology | null; // null until it is measured, which another state event tells
  after: Topology | null;
  flipped?: number;
  snapped?: boolean;
  warm?: boolean;
  edit_ms: number;
  reconstruct_ms: number;
  total_ms: number;
  notes?: string[];
}
export interface CloudInfo {
  name: string;
  file: string;
  shape: string;
  box: Box;
}
/// What is measured of the whole surface while nothing else is to do.
export interface SurfaceMeasures {
  vertices: number;
  triangles: number;
  boundary_edges: number;
  closed: boolean;
  manifold: boolean;
  watertight: boolean;
  volume: number;
  area: number;
}
export interface HistoryStep {
  operation: Operation; // without cameras, strokes and areas
  record: StepRecord | null;
}
export interface SceneState {
  clouds: CloudInfo[];
  options: Options;
  history: HistoryStep[];
  done: number;
  points: number;
  normals: boolean;
  box: Box;
  shift: Vec3;
  dropped: number;
  triangles: number;
  topology: Topology | null;
  surface: SurfaceMeasures | null;
  journal: string;
  base_label: string;
}
export interface FormatInfo {
  name: string;
  extensions: string[];
  cloud: boolean;
  mesh: boolean;
  reads: boolean;
}
export interface Hello {
  scene: SceneState | null;
  program: string;
  version: string;
  device: string;
  loopback: boolean;
  root: string; // the first of roots
  roots: string[];
  shapes: string[];
  formats: FormatInfo[];
  max_upload: number;
}

// ---- replies ----

export type FileKind = "folder" | "cloud" | "mesh" | "session" | "sequence";
export interface FileEntry {
  name: string;
  kind: FileKind;
  bytes: number;
}
export interface ProblemView {
  azimuth: number;
  elevation: number;
  target: Vec3;
  zoom: number;
  visible: number;
  matrix: number[];
}
export interface ProblemRegion {
  score: number;
  peak: number;
  area: number;
  triangles: number;
  centroid: Vec3;
  lower: Vec3;
  upper: Vec3;
  mean_normal: Vec3;
  views: ProblemView[];
}
export interface Distances {
  mean: number;
  rms: number;
  p95: number;
  max: number;
  mean_percent: number;
  rms_percent: number;
  p95_percent: number;
  max_percent: number;
}
export interface Comparison {
  reference: string;
  tau: number;
  to_reference: Distances;
  from_reference: Distances;
  two_sided: Distances;
  normal_consistency: number | null;
  precision: number;
  recall: number;
  f_score: number;
  [key: string]: unknown;
}
export interface Estimate {
  depths: { depth: number; bytes: number | null; ms: number | null }[]; // those around the present depth
}
/// Densities of the surface: shares of its area between edges that are even in their logarithm.
export interface Histogram {
  densities: { edges: number[]; counts: number[]; log: boolean };
  quantiles: [number, number][]; // quantile of a trim and the density below which it cuts, rising
}
export interface FilePlace {
  path?: string;
  upload?: number;
  shape?: string;
  points?: number;
}
export type SaveWhat = "mesh" | "cloud" | "session" | "script" | "picture";

/// What `request` gives for each `do`.
export interface Replies {
  hello: Hello;
  open: { scene: SceneState };
  resume: { scene: SceneState };
  apply: { record: StepRecord };
  undo: Record<string, never>;
  redo: Record<string, never>;
  go: Record<string, never>;
  options: { record?: StepRecord };
  preview: Record<string, unknown>;
  preview_end: Record<string, never>;
  cancel: Record<string, never>;
  ack: Record<string, never>;
  files: { folder: string; entries: FileEntry[] };
  save: { path?: string; download?: number; bytes: number };
  problems: { regions: ProblemRegion[] };
  compare: Comparison;
  values: Record<string, never>;
  values_end: Record<string, never>;
  operation: { operation: Operation };
  reference_end: Record<string, never>;
  estimate: Estimate;
  histogram: Histogram;
  pick: { point: Vec3; normal: Vec3; distance: number } | { point: null };
  fluid: Record<string, unknown>;
  sequence: { frames: number; name: string };
  frame: { index: number; kept: boolean; shown: boolean };
  digest: { sha256: string };
}
export type Verb = keyof Replies;
export type Reply<V extends Verb> = Replies[V] & { id: number; ok: true };

// ---- events ----

export interface StageTimes {
  simulate?: number;
  surface?: number;
  octree?: number;
  splat?: number;
  solve?: number;
  extract?: number;
  encode?: number;
  total?: number;
  // measured by the page
  transfer?: number;
  decode?: number;
  draw?: number;
}
export interface MeshEvent {
  scene: string; // which scene it belongs to; shown whole when the first of it comes
  version: number;
  blob: number;
  bytes: number;
  preview: boolean;
  depth: number;
  triangles: number;
  vertices: number;
  full_triangles: number;
  ms: StageTimes;
  values?: string[];
}
export interface PointsEvent {
  scene: string;
  blob: number;
  from: number;
  count: number;
  total: number;
  final: boolean;
}
export interface ClassCounts {
  kept: number;
  flipped: number;
  dropped: number;
}
export interface GhostsEvent {
  blob: number | null;
  added: number;
  removed: number;
  removed_blob?: number | null;
  tinted?: boolean; // the points have classes: of a set operation, whose counts follow
  a?: ClassCounts;
  b?: ClassCounts;
}
export interface FrameEvent {
  scene: string;
  version: number;
  index: number;
  blob: number | null;
  triangles: number;
  particles?: number; // of a simulation
  seconds?: number;
  kept?: boolean;
  ms: StageTimes;
}
export interface ProgressEvent {
  job: string;
  phase?: string;
  fraction?: number;
  eta_ms?: number | null;
  finished?: boolean;
}
export interface NoticeEvent {
  level: "info" | "warning" | "error";
  text: string;
}
export interface Events {
  state: { scene: SceneState | null };
  progress: ProgressEvent;
  mesh: MeshEvent;
  points: PointsEvent;
  ghosts: GhostsEvent;
  frame: FrameEvent;
  notice: NoticeEvent;
  closing: Record<string, never>;
}
export type EventName = keyof Events;
