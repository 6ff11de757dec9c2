// What a tool is to the page: it gets pointer and key events of the view, draws over it, and shows its settings.
import type { SVGTemplateResult, TemplateResult } from "lit";
import type { Connection } from "../engine/connection";
import type { Vec3 } from "../engine/protocol";
import type { Store } from "../engine/store";
import type { Viewport } from "../view/viewport";

/// A place on the surface or on the points.
export interface Pick {
  point: Vec3; // world
  normal: Vec3; // towards the viewer's side of the surface, unit length
}

export interface ToolPointer {
  readonly x: number; // CSS pixels in the canvas, as cameraDocument() counts
  readonly y: number;
  readonly buttons: number;
  readonly button: number;
  readonly shift: boolean;
  readonly ctrl: boolean; // Command on a Mac
  readonly alt: boolean;
  readonly pressure: number; // 0 to 1; 0.5 for a mouse
  readonly pointerType: string;
  pick(): Pick | null; // what is under the pointer; drawn only when asked for
}

export interface Tool {
  readonly id: string;
  readonly title: string;
  readonly key: string; // one letter, chooses the tool
  readonly icon: string; // path data of a 24 x 24 picture, stroked
  readonly hint: string; // one line for the status bar
  activate?(): void;
  deactivate?(): void;
  pointerDown?(e: ToolPointer): boolean; // true: taken, the view does not move
  pointerMove?(e: ToolPointer): void; // also without a button
  pointerUp?(e: ToolPointer): void;
  doubleClick?(e: ToolPointer): void;
  keyDown?(e: KeyboardEvent): boolean; // true: taken
  settings?(): TemplateResult; // at the head of the right side; rendered anew by redraw()
  overlay?(): SVGTemplateResult; // over the canvas, in CSS pixels; rendered anew by redraw() and with each frame
}

export interface ToolContext {
  readonly connection: Connection;
  readonly store: Store;
  readonly viewport: Viewport;
  redraw(): void; // settings and overlay
  notice(level: "info" | "warning" | "error", text: string): void;
  run(command: string): void; // by the id of the command
}

export type ToolFactory = (context: ToolContext) => Tool;
