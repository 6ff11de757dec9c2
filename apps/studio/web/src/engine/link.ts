// Events of the engine become what is on the screen and in the store. The old mesh stays until the new one is decoded,
// and versions that a newer one overtook are acknowledged without being drawn.
import type { Blobs } from "./blobs";
import type { Decoded } from "./blob";
import type { Connection, EngineError } from "./connection";
import type { FrameEvent, GhostsEvent, Hello, MeshEvent, PointsEvent, ProgressEvent, SceneState, StageTimes } from "./protocol";
import type { ColourMode, Store } from "./store";
import type { Viewport } from "../view/viewport";

/// Changes whenever the committed surface does.
export function surfaceKey({ journal, done, history, points, triangles }: SceneState): string {
  return [journal, done, history.length, points, triangles].join(" ");
}

export class Link {
  private meshShown = 0;
  private pointsGeneration = 0;
  private pointsQueue: Promise<void> = Promise.resolve();
  private ghostsWanted = 0;
  private chips = 1;
  private sceneFramed: string | null = null; // by its events: they may come before the state that tells of it

  constructor(
    private readonly connection: Connection,
    private readonly store: Store,
    private readonly viewport: Viewport,
    private readonly blobs: Blobs,
  ) {
    connection.on("hello", (hello) => this.hello(hello));
    connection.on("connection", (state) => store.update({ connection: state }));
    connection.on("state", ({ scene }) => this.setScene(scene));
    connection.on("progress", (event) => this.progress(event));
    connection.on("mesh", (event) => void this.mesh(event));
    connection.on("points", (event) => this.points(event));
    connection.on("ghosts", (event) => void this.ghosts(event));
    connection.on("frame", (event) => void this.frame(event));
    connection.on("notice", ({ level, text }) => store.addNotice(level, text));
    connection.on("closing", () => store.addNotice("info", "The program has ended"));
  }

  /// Makes the wireframe's lines where they are wanted and not there.
  async lines(): Promise<void> {
    const { surface } = this.viewport;
    const decoded = surface.decoded;
    if (!surface.needsLines || !decoded?.index) return;
    surface.setLines(await this.blobs.lines(decoded.index), decoded);
    this.viewport.requestRender();
  }

  private hello(hello: Hello): void {
    this.meshShown = 0;
    this.store.update({ hello, progress: null });
    this.setScene(hello.scene);
  }

  private setScene(scene: SceneState | null): void {
    const before = this.store.scene;
    const label = (state: SceneState | null) => state && [...state.clouds.map((cloud) => cloud.file + cloud.shape), state.journal].join("\n");
    if (label(before) !== label(scene)) {
      this.store.update({ histogram: null, problems: null, problem: -1, estimate: null, comparison: null, chip: null });
    } else if (before && scene) {
      this.chip(before.done, scene);
      if (surfaceKey(before) !== surfaceKey(scene)) this.store.update({ problems: null, problem: -1 });
    }
    if (!scene || scene.clouds.length === 0) this.clear();
    this.store.update({ scene });
  }

  /// What the newest step did; the topology is measured a little later, and then told by another state.
  private chip(before: number, scene: SceneState): void {
    const record = scene.history[scene.done - 1]?.record;
    const { chip } = this.store;
    if (scene.done > before && record) this.store.chip = { id: this.chips++, step: scene.done, record };
    else if (chip && chip.step === scene.done && record) this.store.chip = { ...chip, record };
    else this.store.chip = null;
  }

  private clear(): void {
    this.viewport.setMesh(null);
    this.viewport.setPoints(null);
    this.viewport.setGhosts(null);
    this.store.update({ mesh: null, pointsShown: 0, ghosts: null });
  }

  private progress(event: ProgressEvent): void {
    this.store.update({ progress: event.finished ? null : event });
  }

  private async load(blob: number): Promise<Decoded | null> {
    try {
      return await this.blobs.load(blob);
    } catch (error) {
      // A blob that is gone was overtaken by a newer one; anything else is worth saying.
      if (!String(error).includes("404")) this.store.addNotice("error", `Data did not arrive: ${(error as Error).message}`);
      return null;
    }
  }

  private ack(version: number): void {
    void this.connection.request("ack", { version }).catch(() => undefined);
  }

  private async mesh(event: MeshEvent): Promise<void> {
    const ghosts = this.ghostsWanted; // those asked for from now on belong to the new mesh
    const detail = { version: event.version };
    performance.mark("psk:mesh-announced", { detail });
    const decoded = await this.load(event.blob);
    performance.mark("psk:mesh-decoded", { detail });
    if (decoded) await this.viewport.stageMesh(decoded);
    performance.mark("psk:mesh-staged", { detail });
    if (!decoded || event.version < this.meshShown) return this.ack(event.version);
    this.meshShown = event.version;
    const begun = performance.now();
    this.viewport.setMesh(decoded);
    this.frameOnce(event.scene);
    if (!event.preview && ghosts === this.ghostsWanted) this.endGhosts();
    this.viewport.afterNextFrame(() => this.meshDrawn(event, decoded, performance.now() - begun));
    void this.lines();
  }

  private meshDrawn(event: MeshEvent, decoded: Decoded, draw: number): void {
    this.ack(event.version);
    performance.mark(event.preview ? "psk:preview-drawn" : "psk:mesh-drawn", { detail: { version: event.version } });
    const known = event.values?.length ? this.store.mesh?.ms : undefined; // the same surface again, with values
    const ms: StageTimes = { ...known, ...event.ms, transfer: decoded.transferMs, decode: decoded.decodeMs, draw };
    const meshAttributes = [...Object.keys(decoded.values), ...(decoded.colors ? ["colour"] : [])];
    this.store.update({ mesh: { ...event, ms }, meshAttributes });
    this.legend();
    if (!event.preview) void this.renewColours(decoded);
  }

  /// Colours the surface; the engine works values out when they are asked for, and sends the mesh again with them.
  async colour(colour: ColourMode): Promise<void> {
    const shown = this.viewport.surface.decoded;
    this.store.setView({ colour });
    const measured = colour !== "plain" && colour !== "colour";
    try {
      if (measured && !shown?.values[colour]) await this.connection.request("values", { name: colour });
      else if (!measured && shown && Object.keys(shown.values).length > 0) await this.connection.request("values_end");
    } catch (error) {
      if (!(error as EngineError).quiet) this.store.addNotice("warning", (error as Error).message);
      if (this.store.view.colour === colour) this.store.setView({ colour: "plain" });
    }
  }

  /// A new surface has no values yet; those of a comparison are of the surface before.
  private async renewColours(decoded: Decoded): Promise<void> {
    const { view, comparison } = this.store;
    if (view.colour === "plain" || view.colour === "colour" || decoded.values[view.colour]) return;
    if (view.colour === "distance" && comparison) this.store.update({ comparison: null, view: { ...view, colour: "plain" } });
    else await this.colour(view.colour);
  }

  /// Numbers of the colours on the screen.
  legend(): void {
    const { colour, show } = this.store.view;
    const range = show === "points" ? undefined : this.viewport.surface.decoded?.ranges[colour];
    const of = this.store.comparison ? "the reference" : "the points";
    const next = range ? { title: colour === "distance" ? `distance to ${of}` : colour, low: range[0], high: range[1] } : null;
    if (JSON.stringify(next) !== JSON.stringify(this.store.legend)) this.store.update({ legend: next });
  }

  private points(event: PointsEvent): void {
    if (event.from === 0) this.pointsGeneration++;
    const generation = this.pointsGeneration;
    const loading = this.load(event.blob);
    this.pointsQueue = this.pointsQueue.then(async () => {
      const decoded = await loading;
      if (!decoded || generation !== this.pointsGeneration) return;
      if (this.sceneFramed !== null && this.sceneFramed !== event.scene) this.clear(); // the surface of another one
      this.viewport.setPoints(decoded, event.from);
      this.frameOnce(event.scene);
      this.store.update({ pointsShown: this.viewport.points.shown });
      this.viewport.afterNextFrame(() => performance.mark("psk:points-drawn"));
    });
  }

  private async ghosts(event: GhostsEvent): Promise<void> {
    const wanted = ++this.ghostsWanted;
    const added = event.blob !== null ? await this.load(event.blob) : null;
    const removed = event.removed_blob != null ? await this.load(event.removed_blob) : null;
    if (wanted !== this.ghostsWanted) return;
    this.viewport.setGhosts(added, removed);
    this.store.update({ ghosts: added || removed ? event : null });
    this.viewport.afterNextFrame(() => performance.mark("psk:preview-drawn"));
  }

  /// What was previewed has happened, or is not to happen: points on their way come too late.
  private endGhosts(): void {
    this.ghostsWanted++;
    this.viewport.setGhosts(null);
    this.store.update({ ghosts: null });
  }

  private async frame(event: FrameEvent): Promise<void> {
    const decoded = event.blob === null ? null : await this.load(event.blob);
    const { sequence } = this.store;
    if (decoded) this.viewport.setMesh(decoded);
    this.frameOnce(event.scene);
    this.viewport.afterNextFrame(() => this.ack(event.version));
    if (!sequence) return;
    const files = sequence.kind === "files";
    const cached = files ? new Set([...sequence.cached, event.index]) : sequence.cached;
    const index = files && !sequence.playing ? sequence.index : event.index; // the hand is ahead of what it asked for
    this.store.update({ sequence: { ...sequence, index, frame: event, cached } });
  }

  /// Shows the first that comes of a scene whole; then the view is in the hands of who looks.
  private frameOnce(scene: string): void {
    const { surface, points } = this.viewport;
    if (this.sceneFramed === scene || (!surface.decoded?.triangles && points.shown === 0)) return;
    this.sceneFramed = scene;
    this.viewport.view.fit(this.viewport.box);
    this.viewport.requestRender();
  }
}
