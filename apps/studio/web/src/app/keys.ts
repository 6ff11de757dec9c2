// The keyboard: the tool in hand first, then commands. Fields of text keep their keys.
import type { Controls } from "../view/controls";
import { add, centreOf } from "../view/camera";
import type { StudioContext } from "./context";

const kTurn = Math.PI / 36;

function isTyping(event: KeyboardEvent): boolean {
  const target = event.composedPath()[0] as HTMLElement | undefined;
  if (!target?.matches) return false;
  return target.matches("input:not([type=range]), textarea, select, [contenteditable]");
}

/// Arrow keys belong to the control that has the focus; Space and Enter, too.
function isControl(event: KeyboardEvent, canvas: HTMLElement): boolean {
  const target = event.composedPath()[0];
  return target instanceof HTMLElement && target !== canvas && target.matches("button, a, input, [role], [tabindex]");
}

export class Keys {
  constructor(
    private readonly context: StudioContext,
    private readonly controls: Controls,
    private readonly canvas: HTMLCanvasElement,
  ) {
    window.addEventListener("keydown", (event) => this.down(event));
    window.addEventListener("keyup", (event) => {
      if (event.key === " ") this.controls.spaceHeld = false;
    });
    window.addEventListener("blur", () => (this.controls.spaceHeld = false));
  }

  private down(event: KeyboardEvent): void {
    if (event.defaultPrevented || document.querySelector("psk-app")?.shadowRoot?.querySelector("psk-dialogs, psk-palette")) return;
    const typing = isTyping(event);
    const held = event.ctrlKey || event.metaKey;
    const control = isControl(event, this.canvas);
    if (typing && !held && event.key !== "Escape") return;
    if (event.key === " " && !control) {
      this.controls.spaceHeld = true;
      event.preventDefault();
      return;
    }
    if (control && [" ", "Enter", "Tab"].includes(event.key)) return;
    if (control && event.key.startsWith("Arrow")) return;
    if (!typing && this.context.tool()?.keyDown?.(event)) return event.preventDefault();
    if (!held && !control && this.moveView(event)) return event.preventDefault();
    const command = this.context.commands.byKey(event);
    if (!command) return;
    if (typing && ["z", "y", "a", "c", "v", "x"].includes(event.key.toLowerCase())) return; // the field's own
    event.preventDefault();
    this.context.commands.run(command.id);
  }

  /// The view by keys alone.
  private moveView(event: KeyboardEvent): boolean {
    const { viewport } = this.context;
    const { view } = viewport;
    const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) view.pan(arrow[0] * 40, arrow[1] * 40);
    else if (arrow) view.orbit(add(centreOf(viewport.box), [0, 0, 0]), arrow[0] * kTurn, arrow[1] * kTurn);
    else if (event.key === "+" || event.key === "=") view.dolly(0.85, view.target);
    else if (event.key === "-") view.dolly(1 / 0.85, view.target);
    else return false;
    viewport.land();
    viewport.requestRender();
    return true;
  }
}
