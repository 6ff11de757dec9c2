// Bends the cloud by a lattice around it whose control points are dragged. Source: Sederberg & Parry 1986.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { DeformOperation, Pixel, Vec3 } from "../engine/protocol";
import { button, segmentsRow, switchRow } from "../ui/controls";
import { DeformTool } from "./shared/deform_tool";
import { type LatticeState, latticeOf } from "./shared/documents";
import { drawHandle, drawPath, kBlue } from "./shared/draw";
import { actions, applyBar, countOf, note, vectorRow } from "./shared/fields";
import { RectangleGesture } from "./shared/gestures";
import { type Constraint, controlPoints, dragBy, edges, grown, pointAt, pointsIn } from "./shared/lattice_grid";
import { linePath } from "./shared/shapes";
import { add, mul, zero } from "./shared/vec";
import { View, pixelOf } from "./shared/view";
import { register } from "./registry";
import type { ToolContext, ToolPointer } from "./tool";

const kMostPoints = 8; // along an axis: more are too near to one another to be gripped
const kMargin = 0.04; // share of the box between it and the lattice

interface Hold {
  at: Vec3; // the control point under the pointer, as the drag began
  from: Pixel;
  view: View;
  moves: Map<string, Vec3>; // as the drag began
}

class LatticeTool extends DeformTool<LatticeState> {
  readonly id = "lattice";
  readonly title = "Bend by a lattice";
  readonly key = "g";
  readonly icon = "M4 5c5-2 11 2 16 0v14c-5 2-11-2-16 0zM9.3 4.6v14M14.7 5.4v14M4 12c5-2 11 2 16 0";
  readonly hint = "Drag control points; Shift chooses more, X Y Z keep to an axis, Enter applies";
  protected state: LatticeState;
  private chosen = new Set<string>();
  private along: Constraint = "view";
  private hold: Hold | null = null;
  private readonly band = new RectangleGesture();

  constructor(context: ToolContext) {
    super(context);
    this.state = this.around([2, 2, 2], "extend");
  }

  private around(spans: Vec3, outside: LatticeState["outside"]): LatticeState {
    return { box: grown(this.context.viewport.box, kMargin), spans, moves: new Map(), outside };
  }

  protected operation(): DeformOperation | null {
    const moved = [...this.state.moves.values()].some((by) => by.some((v) => v !== 0));
    return moved ? latticeOf(this.state) : null;
  }

  /// The lattice keeps around the surface while nobody drags it.
  protected override meshChanged(): void {
    if (!this.pending && !this.hold && !this.previews.committing) this.refit();
  }

  /// The lattice is straight again, around the surface as it is now.
  protected settled(): LatticeState {
    return this.around(this.state.spans, this.state.outside);
  }

  protected reset(): void {
    this.state = { ...this.state, moves: new Map() };
  }

  protected forget(): void {
    this.chosen = new Set();
    this.refit();
  }

  private refit(): void {
    this.state = this.around(this.state.spans, this.state.outside);
    this.context.redraw();
  }

  private set(patch: Partial<LatticeState>): void {
    if (this.previews.committing) return;
    this.drop();
    this.chosen = new Set();
    this.state = { ...this.around(this.state.spans, this.state.outside), ...patch };
    this.context.redraw();
  }

  // ---- pointer and keys ----

  private view(): View {
    return new View(this.context.viewport.cameraDocument());
  }

  pointerDown(e: ToolPointer): boolean {
    if (e.button !== 0 || !this.context.store.scene || this.previews.committing) return false;
    const view = this.view();
    const point = pointAt(controlPoints(this.state), view, pixelOf(e), e.pointerType === "touch" ? 20 : 9);
    if (!point && !e.shift) return false;
    if (!point) {
      this.band.down(pixelOf(e));
      return true;
    }
    if (e.shift) this.toggle(point.key);
    else if (!this.chosen.has(point.key)) this.chosen = new Set([point.key]);
    this.hold = { at: point.at, from: pixelOf(e), view, moves: this.state.moves };
    this.context.redraw();
    return true;
  }

  private toggle(key: string): void {
    this.chosen = new Set(this.chosen);
    if (!this.chosen.delete(key)) this.chosen.add(key);
  }

  pointerMove(e: ToolPointer): void {
    this.band.move(pixelOf(e));
    const { hold } = this;
    if (hold && this.chosen.size > 0) {
      this.shift(hold.moves, dragBy(hold.view, hold.at, hold.from, pixelOf(e), this.along));
    } else if (this.band.drawing) {
      this.context.redraw();
    }
  }

  /// All chosen points moved by as much, from where `before` has them.
  private shift(before: Map<string, Vec3>, by: Vec3): void {
    const moves = new Map(before);
    for (const key of this.chosen) moves.set(key, add(before.get(key) ?? zero, by));
    this.state = { ...this.state, moves };
    this.preview();
  }

  pointerUp(e: ToolPointer): void {
    if (this.band.drawing) {
      this.band.up(pixelOf(e));
      const shape = this.band.shape();
      if (shape?.kind === "rectangle") {
        const inside = pointsIn(controlPoints(this.state), this.view(), shape.corners);
        this.chosen = new Set([...this.chosen, ...inside]);
      }
      this.band.clear();
    }
    const dragged = this.hold !== null && this.hold.moves !== this.state.moves;
    this.hold = null;
    if (dragged) this.released();
    this.context.redraw();
  }

  override keyDown(e: KeyboardEvent): boolean {
    const key = e.key.toLowerCase();
    const side = { arrowleft: -1, arrowright: 1 }[key] ?? 0;
    const rise = { arrowdown: -1, arrowup: 1 }[key] ?? 0;
    if ((side !== 0 || rise !== 0) && this.chosen.size > 0 && !this.previews.committing) {
      this.nudge(side, rise, e.shiftKey ? 10 : 1);
    } else if (["x", "y", "z"].includes(key) && !e.ctrlKey && !e.metaKey) {
      this.along = this.along === key ? "view" : (key as Constraint);
    } else if (key === "a" && e.ctrlKey) {
      this.chosen = new Set(controlPoints(this.state).map((point) => point.key));
    } else if (key === "escape" && !this.pending && this.chosen.size > 0) {
      this.chosen = new Set();
    } else {
      return super.keyDown(e);
    }
    this.context.redraw();
    return true;
  }

  private nudge(side: number, rise: number, pixels: number): void {
    const view = this.view();
    const size = pixels * view.pixelSize(this.state.box.lower);
    this.shift(this.state.moves, add(mul(view.right, side * size), mul(view.up, rise * size)));
  }

  // ---- what is shown ----

  overlay(): SVGTemplateResult {
    if (!this.context.store.scene) return svg``;
    const view = this.view();
    const pixel = (p: Vec3): Pixel | null => {
      const at = view.project(p);
      return at && [at.x, at.y];
    };
    const lines = edges(this.state).flatMap(([a, b]) => {
      const [p, q] = [pixel(a), pixel(b)];
      return p && q ? [linePath([p, q])] : [];
    });
    return svg`<g data-testid="tool-overlay">
      ${drawPath(lines.join(""), { colour: kBlue, width: 1, faint: true })}
      ${controlPoints(this.state).map(({ key, at }) => {
        const p = pixel(at);
        return p ? drawHandle(p, this.chosen.has(key), `lattice-point-${key.replaceAll(",", "-")}`, this.chosen.has(key) ? undefined : kBlue) : nothing;
      })}
      ${drawPath(linePath(this.band.open()), { dashes: true })}
    </g>`;
  }

  settings(): TemplateResult {
    const { spans, outside } = this.state;
    return html`
      ${vectorRow({
        label: "Points",
        title: "Control points along x, y and z",
        testid: "lattice-points",
        value: spans.map((n) => n + 1) as Vec3,
        step: 1,
        min: 2,
        change: (n) => this.set({ spans: n.map((v) => Math.min(kMostPoints, Math.max(2, Math.round(v))) - 1) as Vec3 }),
      })}
      ${segmentsRow<Constraint>({
        label: "Drag along",
        testid: "lattice-along",
        value: this.along,
        choices: [
          { value: "view", label: "View", title: "In the plane of the picture" },
          ...(["x", "y", "z"] as const).map((axis) => ({ value: axis, label: axis.toUpperCase(), title: `Along the ${axis} axis (${axis.toUpperCase()})` })),
        ],
        change: (along) => {
          this.along = along;
          this.context.redraw();
        },
      })}
      ${segmentsRow<LatticeState["outside"]>({
        label: "Outside",
        testid: "lattice-outside",
        value: outside,
        choices: [
          { value: "extend", label: "Follows", title: "What is outside goes on along the tangents at the faces" },
          { value: "stay", label: "Stays", title: "What is outside stays; the cloud may tear there" },
        ],
        change: (value) => this.set({ outside: value }),
      })}
      ${switchRow({
        label: "Auto-apply",
        title: "A drag is a step of the history when it ends; else Enter applies",
        testid: "lattice-each-drag",
        value: this.eachDrag,
        change: (value) => {
          this.eachDrag = value;
          this.context.redraw();
        },
      })}
      ${note(this.previews.error || `${countOf(this.chosen.size, "control point")} chosen`, "tool-state", this.previews.error !== "")}
      ${actions(button({ label: "Fit to the surface", testid: "lattice-fit", title: "Put the lattice around the present surface", disabled: this.previews.committing, run: () => this.set({}) }))}
      ${applyBar({ ready: this.pending, busy: this.previews.committing, apply: () => void this.commit(), drop: () => this.drop() })}`;
  }
}

export const lattice = register((context) => new LatticeTool(context));
