// Water that is simulated live: a scene runs, the mouse pushes or stirs it, an obstacle is dragged through it. Recorded
// frames are played by the timeline.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { Vec3 } from "../engine/protocol";
import { button, numberRow, segmentsRow, selectRow, sliderRow } from "../ui/controls";
import type { ShowMode } from "../engine/store";
import type { ViewCamera } from "../view/camera";
import { drawRing, kOrange } from "./shared/draw";
import { actions, note } from "./shared/fields";
import { View, pixelOf } from "./shared/view";
import { type Force, type WaterFacts, forceOf, insideTank, middleOf, placeInWater, readFacts, widestRadius } from "./shared/water";
import { register } from "./registry";
import type { Tool, ToolContext, ToolPointer } from "./tool";

type Hand = "push" | "swirl" | "obstacle";
const kScenes = [
  { value: "dam-break", label: "Dam break" },
  { value: "double-dam-break", label: "Double dam break" },
  { value: "drop", label: "Drop" },
  { value: "obstacle", label: "Obstacle" },
  { value: "stir", label: "Stir" },
];
const kFewest = 200; // particles, as the engine has it
const kMost = 2_000_000;

class FluidTool implements Tool {
  readonly id = "fluid";
  readonly title = "Water";
  readonly key = "w";
  readonly icon = "M3 8c3-3 6 3 9 0s6 3 9 0M3 13c3-3 6 3 9 0s6 3 9 0M3 18c3-3 6 3 9 0s6 3 9 0";
  readonly hint = "Drag to push, stir or move the obstacle; [ ] radius, P pauses, Backspace restarts";
  private scene = "dam-break";
  private particles = 20_000;
  private hand: Hand = "push";
  private radius = 0.25;
  private strength = 40;
  private starting = false;
  private tank: WaterFacts | null = null; // as the scene began
  private before: { show: ShowMode; view: ViewCamera } | null = null; // how the scene was looked at
  private held: { at: Vec3; depth: Vec3; seconds: number } | null = null;
  private cursor: Vec3 | null = null;
  private last = ""; // the request that was sent last, so that none is sent twice
  private sending = false;
  private next: object | null = null;

  constructor(private readonly context: ToolContext) {
    context.store.addEventListener("change", () => this.running || this.starting || this.restoreView());
  }

  /// The scene is shown again as it was before the water.
  private restoreView(): void {
    if (!this.before) return;
    const { show, view } = this.before;
    this.before = null;
    this.context.store.setView({ show });
    this.context.viewport.flyTo(view);
  }

  private get running(): boolean {
    return this.context.store.sequence?.kind === "fluid";
  }

  private get paused(): boolean {
    return this.running && !this.context.store.sequence!.playing;
  }

  private get facts() {
    const frame = this.context.store.sequence?.frame;
    return this.running ? ((frame && readFacts(frame)) ?? this.tank) : null;
  }

  // ---- requests ----

  private async start(): Promise<void> {
    const { connection, store, viewport } = this.context;
    this.starting = true;
    this.context.redraw();
    const label = kScenes.find(({ value }) => value === this.scene)!.label;
    store.update({ sequence: { kind: "fluid", name: label, frames: 0, index: 0, playing: true, loop: false, cached: new Set(), frame: null } });
    try {
      const facts = await connection.request("fluid", { start: { scene: this.scene, particles: this.particles } });
      this.tank = readFacts(facts);
      this.before ??= { show: store.view.show, view: viewport.view.clone() };
      store.setView({ show: "mesh" }); // the scene's points have nothing to do with the water
      if (this.tank) viewport.frame({ lower: [0, 0, 0], upper: this.tank.tank });
    } catch (error) {
      store.update({ sequence: null });
      this.context.notice("error", (error as Error).message);
    }
    this.starting = false;
    this.context.redraw();
  }

  private async ask(body: object): Promise<void> {
    await this.context.connection.request("fluid", body).catch((error: Error) => this.context.notice("error", error.message));
  }

  private pause(): void {
    const { sequence } = this.context.store;
    if (!sequence || !this.running) return;
    this.context.store.update({ sequence: { ...sequence, playing: !sequence.playing } });
    void this.ask({ pause: sequence.playing });
  }

  private async stop(): Promise<void> {
    const { connection, store } = this.context;
    store.update({ sequence: null });
    await this.ask({ stop: true });
    // The scene's own surface is shown again.
    if (store.scene) await connection.request("reference_end").catch(() => undefined);
    this.held = null;
    this.context.redraw();
  }

  /// Sends what the hand does, the newest only, and never the same twice.
  private send(body: object): void {
    const text = JSON.stringify(body);
    if (text === this.last) return;
    this.last = text;
    this.next = body;
    if (!this.sending) void this.sendAll();
  }

  private async sendAll(): Promise<void> {
    this.sending = true;
    for (let body = this.next; body; body = this.next) {
      this.next = null;
      await this.ask(body);
    }
    this.sending = false;
  }

  // ---- pointer and keys ----

  pointerDown(e: ToolPointer): boolean {
    const { facts } = this;
    if (!facts || e.button !== 0) return false;
    const view = new View(this.context.viewport.cameraDocument());
    const depth = this.hand === "obstacle" ? (facts.obstacle?.centre ?? middleOf(facts.tank)) : e.pick()?.point;
    if (!depth) return false; // beside the water: the view turns
    const at = placeInWater(view, pixelOf(e), depth, facts.tank);
    if (!at) return false;
    this.held = { at, depth, seconds: performance.now() / 1000 };
    this.act(at, view);
    return true;
  }

  pointerMove(e: ToolPointer): void {
    const { facts } = this;
    if (!facts) return;
    const view = new View(this.context.viewport.cameraDocument());
    const depth = this.held?.depth ?? middleOf(facts.tank);
    this.cursor = placeInWater(view, pixelOf(e), depth, facts.tank);
    if (this.held && this.cursor) this.act(this.cursor, view);
    this.context.redraw();
  }

  private act(to: Vec3, view: View): void {
    const { facts, held } = this;
    if (!facts || !held) return;
    if (this.hand === "obstacle") {
      const radius = facts.obstacle?.radius ?? 0;
      return this.send({ obstacle: insideTank(to, facts.tank, radius) });
    }
    const now = performance.now() / 1000;
    const force: Force | null = forceOf(this.hand, held.at, to, now - held.seconds, { radius: this.radius, strength: this.strength, back: view.back });
    this.held = { ...held, at: to, seconds: now };
    this.send({ push: force ? [force] : [] });
  }

  pointerUp(): void {
    if (this.held && this.hand !== "obstacle") this.send({ push: [] });
    this.held = null;
    this.context.redraw();
  }

  keyDown(e: KeyboardEvent): boolean {
    if (!this.running || e.ctrlKey || e.metaKey) return false;
    const grow = { "[": -1, "]": 1 }[e.key];
    if (grow) this.radius *= 1.1 ** grow;
    else if (e.key.toLowerCase() === "p") this.pause();
    else if (e.key === "Backspace") void this.ask({ restart: true });
    else return false;
    this.context.redraw();
    return true;
  }

  // ---- what is shown ----

  overlay(): SVGTemplateResult {
    const { facts, cursor } = this;
    if (!facts || !cursor) return svg``;
    const view = new View(this.context.viewport.cameraDocument());
    const at = this.hand === "obstacle" && !this.held ? (facts.obstacle?.centre ?? cursor) : cursor;
    const radius = this.hand === "obstacle" ? (facts.obstacle?.radius ?? 0) : this.radius;
    const p = view.project(at);
    return svg`<g data-testid="tool-overlay">
      ${p ? drawRing([p.x, p.y], radius / view.pixelSize(at), kOrange, !this.held) : nothing}
    </g>`;
  }

  settings(): TemplateResult {
    const { running } = this;
    return html`
      ${selectRow({
        label: "Scene",
        testid: "fluid-scene",
        value: this.scene,
        choices: kScenes,
        change: (scene) => {
          this.scene = scene;
          this.context.redraw();
        },
      })}
      ${numberRow({
        label: "Particles",
        testid: "fluid-particles",
        value: this.particles,
        min: kFewest,
        max: kMost,
        step: 1000,
        change: (particles) => {
          this.particles = Math.round(particles);
          this.context.redraw();
        },
      })}
      ${actions(
        button({ label: running ? "Start anew" : "Start", testid: "fluid-start", title: "Run the scene", primary: !running, disabled: this.starting, run: () => void this.start() }),
        button({ label: this.paused ? "Go on" : "Pause", testid: "fluid-pause", title: "Pause or go on (P)", disabled: !running, run: () => this.pause() }),
        button({ label: "Restart", testid: "fluid-restart", title: "Back to the first frame (Backspace)", disabled: !running, run: () => void this.ask({ restart: true }) }),
        button({ label: "Stop", testid: "fluid-stop", title: "End the simulation", disabled: !running, run: () => void this.stop() }),
      )}
      ${running ? this.handRows() : note("Water runs on the engine while its surface is shown here", "tool-state")}`;
  }

  private handRows(): TemplateResult {
    const { facts } = this;
    const widest = facts ? widestRadius(facts.tank) : 1;
    const set = (patch: { radius?: number; strength?: number }) => {
      this.radius = patch.radius ?? this.radius;
      this.strength = patch.strength ?? this.strength;
      this.context.redraw();
    };
    return html`
      ${segmentsRow<Hand>({
        label: "Mouse",
        testid: "fluid-hand",
        value: this.hand,
        choices: [
          { value: "push", label: "Push", title: "Dragging pushes the water along" },
          { value: "swirl", label: "Swirl", title: "Holding stirs the water about the line of sight" },
          { value: "obstacle", label: "Obstacle", title: "Dragging moves the obstacle", disabled: !facts?.obstacle },
        ],
        change: (hand) => {
          this.hand = hand;
          this.context.redraw();
        },
      })}
      ${this.hand === "obstacle" ? nothing : html`
        ${sliderRow({ label: "Radius", title: "Of the push, metres ([ and ])", testid: "fluid-radius", value: this.radius, min: 0.02, max: widest, step: 0.01, input: (radius) => set({ radius }), change: (radius) => set({ radius }) })}
        ${sliderRow({ label: "Strength", title: "Of the push, metres / second²", testid: "fluid-strength", value: this.strength, min: 0, max: 200, step: 1, input: (strength) => set({ strength }), change: (strength) => set({ strength }) })}`}
      ${note(this.paused ? "Paused" : "Running", "tool-state")}`;
  }
}

export const fluid = register((context) => new FluidTool(context));
