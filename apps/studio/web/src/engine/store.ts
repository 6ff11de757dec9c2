// What the page knows: the scene as the engine tells it, and the page's own settings. Panels render from it.
import type { ReactiveController, ReactiveControllerHost } from "lit";
import type { ConnectionState } from "./connection";
import type {
  Comparison,
  Estimate,
  FrameEvent,
  GhostsEvent,
  Hello,
  Histogram,
  MeshEvent,
  Options,
  ProblemRegion,
  ProgressEvent,
  SceneState,
  StepRecord,
} from "./protocol";

export type ColourMode = "plain" | "colour" | "density" | "confidence" | "weakness" | "distance";
export type PointColour = "plain" | "colour" | "normal" | "added";
export type ShowMode = "points" | "mesh" | "both";
export type Level = "info" | "warning" | "error";
export type PanelId = "reconstruct" | "points" | "surface" | "problems" | "history";

/// Whether the page is shown less than there is: a surface with too many triangles to draw, at a lower depth.
export function isCoarser(mesh: MeshEvent): boolean {
  return !mesh.preview && mesh.triangles < mesh.full_triangles;
}

export interface Notice {
  id: number;
  level: Level;
  text: string;
}

/// What the last operation did, for the chip.
export interface Chip {
  id: number;
  step: number; // of the history, from 1
  record: StepRecord;
}

export interface ViewSettings {
  show: ShowMode;
  hidden: boolean; // points and surface both, to see what a tool draws
  colour: ColourMode;
  pointColour: PointColour;
  pointSize: number; // CSS pixels at the centre's distance
  wireframe: boolean;
  grid: boolean;
  section: boolean;
}

export interface SequenceState {
  kind: "files" | "fluid";
  name: string;
  frames: number; // 0: it goes on
  index: number;
  playing: boolean;
  loop: boolean;
  cached: Set<number>;
  frame: FrameEvent | null;
}

export class Store extends EventTarget {
  connection: ConnectionState = "connecting";
  hello: Hello | null = null;
  scene: SceneState | null = null;
  mesh: MeshEvent | null = null; // on the screen
  ghosts: GhostsEvent | null = null;
  progress: ProgressEvent | null = null;
  notices: Notice[] = [];
  chip: Chip | null = null;
  pendingOptions: Options | null = null; // dragged, not applied yet
  estimate: Estimate | null = null;
  histogram: Histogram | null = null;
  problems: ProblemRegion[] | null = null;
  problem = -1; // chosen one
  comparison: Comparison | null = null;
  sequence: SequenceState | null = null;
  selection: Record<string, unknown> = {}; // of the tools, by their ids
  tool = "navigate";
  panel: PanelId = "reconstruct";
  pointsShown = 0;
  meshAttributes: string[] = []; // names of values on the present mesh, and "colour"
  legend: { title: string; low: number; high: number } | null = null;
  view: ViewSettings = {
    show: "mesh", // points until there is one
    hidden: false,
    colour: "plain",
    pointColour: "plain",
    pointSize: 2,
    wireframe: false,
    grid: true,
    section: false,
  };
  private scheduled = false;
  private nextNotice = 1;

  /// Tells the page that something changed; many calls in a task make one "change".
  update(patch: Partial<Omit<Store, keyof EventTarget>> = {}): void {
    Object.assign(this, patch);
    if (this.scheduled) return;
    this.scheduled = true;
    queueMicrotask(() => {
      this.scheduled = false;
      this.dispatchEvent(new Event("change"));
    });
  }

  setView(patch: Partial<ViewSettings>): void {
    this.update({ view: { ...this.view, ...patch } });
  }

  /// The options in force: those applied, with those being dragged on top.
  get options(): Options {
    return { ...this.scene?.options, ...this.pendingOptions };
  }

  get canUndo(): boolean {
    return (this.scene?.done ?? 0) > 0;
  }

  get canRedo(): boolean {
    return !!this.scene && this.scene.done < this.scene.history.length;
  }

  /// Same text twice is said once.
  addNotice(level: Level, text: string): number {
    const same = this.notices.find((notice) => notice.text === text);
    if (same) return same.id;
    const id = this.nextNotice++;
    this.update({ notices: [...this.notices.slice(-3), { id, level, text }] });
    return id;
  }

  dropNotice(id: number): void {
    this.update({ notices: this.notices.filter((notice) => notice.id !== id) });
  }
}

/// Renders its host again whenever the store changes.
export class StoreController implements ReactiveController {
  private readonly changed = () => this.host.requestUpdate();
  constructor(
    private readonly host: ReactiveControllerHost,
    private readonly store: () => Store | undefined,
  ) {
    host.addController(this);
  }
  hostConnected(): void {
    this.store()?.addEventListener("change", this.changed);
  }
  hostDisconnected(): void {
    this.store()?.removeEventListener("change", this.changed);
  }
}
