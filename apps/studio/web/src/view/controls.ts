// Pointer, wheel, touch and pen on the canvas. The tool in hand is asked first; what it does not take moves the view.
import type { Vec3 } from "../engine/protocol";
import type { Tool, ToolPointer } from "../tools/tool";
import type { Viewport } from "./viewport";

type Drag = "orbit" | "pan" | "tool";
interface Touch {
  x: number;
  y: number;
}
const kTurn = 0.0065; // radians a pixel
const kWheel = 0.0016; // share of the distance a pixel of the wheel, as an exponent

/// Factor by which a turn of the wheel changes the distance.
export function wheelFactor(event: { deltaY: number; deltaMode: number; ctrlKey?: boolean }): number {
  const pixels = event.deltaMode === 1 ? event.deltaY * 18 : event.deltaMode === 2 ? event.deltaY * 400 : event.deltaY;
  const clipped = Math.min(Math.max(pixels, -240), 240);
  return Math.exp(clipped * (event.ctrlKey ? 4 : 1) * kWheel); // a pinch on a touch pad comes as Ctrl and small steps
}

/// How two fingers moved: middle before and after, and how much nearer they came (< 1: spread, goes nearer).
export function pinch(before: [Touch, Touch], after: [Touch, Touch]): { dx: number; dy: number; factor: number } {
  const middle = ([a, b]: [Touch, Touch]) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
  const gap = ([a, b]: [Touch, Touch]) => Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1);
  const [m, n] = [middle(before), middle(after)];
  return { dx: n.x - m.x, dy: n.y - m.y, factor: gap(before) / gap(after) };
}

export class Controls {
  spaceHeld = false;
  private drag: Drag | null = null;
  private pointer = -1;
  private last: Touch = { x: 0, y: 0 };
  private pivot: Vec3 = [0, 0, 0];
  private anchor: { x: number; y: number; time: number; point: Vec3 } | null = null;
  private readonly touches = new Map<number, Touch>();

  constructor(
    private readonly viewport: Viewport,
    private readonly tool: () => Tool | null,
    private readonly moved: () => void,
  ) {
    const { canvas } = viewport;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.up(event));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("dblclick", (event) => this.doubleClick(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  private place(event: MouseEvent): Touch {
    const box = this.viewport.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private toolPointer(event: PointerEvent | MouseEvent): ToolPointer {
    const { x, y } = this.place(event);
    const pen = event as PointerEvent;
    return {
      x,
      y,
      buttons: event.buttons,
      button: event.button,
      shift: event.shiftKey,
      ctrl: event.ctrlKey || event.metaKey,
      alt: event.altKey,
      pressure: pen.pressure ?? 0.5,
      pointerType: pen.pointerType ?? "mouse",
      pick: () => this.viewport.pick(x, y),
    };
  }

  private down(event: PointerEvent): void {
    const { canvas } = this.viewport;
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    this.viewport.land();
    this.last = this.place(event);
    if (event.pointerType === "touch") {
      this.touches.set(event.pointerId, this.last);
      if (this.touches.size > 1) return this.begin(event, "pan"); // two fingers always move the view
    }
    if (this.drag) return;
    const mine = this.spaceHeld || event.button !== 0;
    if (!mine && this.tool()?.pointerDown?.(this.toolPointer(event))) return this.begin(event, "tool");
    this.begin(event, event.button === 0 && !event.shiftKey ? "orbit" : "pan");
  }

  private begin(event: PointerEvent, drag: Drag): void {
    if (this.drag === "tool" && drag !== "tool") this.tool()?.pointerUp?.(this.toolPointer(event));
    this.drag = drag;
    this.pointer = event.pointerId;
    if (drag === "tool") return;
    this.pivot = this.viewport.pick(this.last.x, this.last.y)?.point ?? this.viewport.view.target;
    this.viewport.canvas.dataset["drag"] = drag;
  }

  private move(event: PointerEvent): void {
    const now = this.place(event);
    if (this.touches.has(event.pointerId) && this.touches.size === 2) return this.moveTwo(event, now);
    if (this.drag === null || this.drag === "tool") {
      if (!this.spaceHeld || this.drag === "tool") this.tool()?.pointerMove?.(this.toolPointer(event));
      return;
    }
    if (event.pointerId !== this.pointer) return;
    const [dx, dy] = [now.x - this.last.x, now.y - this.last.y];
    this.last = now;
    const { view } = this.viewport;
    if (this.drag === "orbit") view.orbit(this.pivot, dx * kTurn, dy * kTurn);
    else view.pan(dx, dy, Math.max(view.depthOf(this.pivot), 1e-9));
    this.changed();
  }

  private moveTwo(event: PointerEvent, now: Touch): void {
    const others = [...this.touches].filter(([id]) => id !== event.pointerId).map(([, touch]) => touch);
    const before = this.touches.get(event.pointerId)!;
    this.touches.set(event.pointerId, now);
    const other = others[0]!;
    const { dx, dy, factor } = pinch([before, other], [now, other]);
    const { view } = this.viewport;
    view.pan(dx, dy, Math.max(view.depthOf(this.pivot), 1e-9));
    view.dolly(factor, view.pointAt((now.x + other.x) / 2, (now.y + other.y) / 2, Math.max(view.depthOf(this.pivot), 1e-9)));
    this.changed();
  }

  private up(event: PointerEvent): void {
    this.touches.delete(event.pointerId);
    if (this.drag === "tool") this.tool()?.pointerUp?.(this.toolPointer(event));
    if (this.touches.size > 0) {
      [this.last] = [...this.touches.values()] as [Touch];
      [this.pointer] = [...this.touches.keys()] as [number];
      this.drag = "orbit";
      return;
    }
    this.drag = null;
    delete this.viewport.canvas.dataset["drag"];
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.viewport.land();
    const { x, y } = this.place(event);
    const { view } = this.viewport;
    view.dolly(wheelFactor(event), this.wheelAnchor(x, y, event.timeStamp));
    this.changed();
  }

  /// What is under the cursor, found once for a run of the wheel: while it turns that point stays under the cursor.
  private wheelAnchor(x: number, y: number, time: number): Vec3 {
    const { view } = this.viewport;
    const { anchor } = this;
    const same = anchor !== null && time - anchor.time < 400 && Math.hypot(x - anchor.x, y - anchor.y) < 3;
    const point = same ? anchor.point : (this.viewport.pick(x, y)?.point ?? view.pointAt(x, y));
    this.anchor = { x, y, time, point };
    return point;
  }

  private doubleClick(event: MouseEvent): void {
    const tool = this.tool();
    if (tool?.doubleClick) return tool.doubleClick(this.toolPointer(event));
    const { x, y } = this.place(event);
    const point = this.viewport.pick(x, y)?.point;
    if (!point) return;
    const goal = this.viewport.view.clone();
    goal.distance = goal.orthographic ? goal.distance : Math.max(goal.depthOf(point), 1e-9);
    goal.target = point;
    this.viewport.flyTo(goal);
  }

  private changed(): void {
    this.viewport.requestRender();
    this.moved();
  }
}
