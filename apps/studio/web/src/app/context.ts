// What the parts of the page have in common, and the class that they are made from.
import { LitElement } from "lit";
import { property } from "lit/decorators.js";
import type { Connection } from "../engine/connection";
import { EngineError } from "../engine/connection";
import type { Link } from "../engine/link";
import type { Level, Store } from "../engine/store";
import type { LiveOptions } from "../panels/live_options";
import type { Tool, ToolContext } from "../tools/tool";
import type { Commands } from "../ui/commands";
import type { Viewport } from "../view/viewport";

export type DialogId = "open" | "save" | "reference" | "keys";

export interface StudioContext extends ToolContext {
  readonly connection: Connection;
  readonly store: Store;
  readonly viewport: Viewport;
  readonly commands: Commands;
  readonly link: Link;
  readonly live: LiveOptions;
  readonly tools: Tool[];
  tool(): Tool | null;
  chooseTool(id: string): void;
  openDialog(id: DialogId): void;
  openPalette(): void;
  setTheme(theme: "dark" | "light"): void;
}

/// Says what went wrong, unless nobody needs to hear it.
export function tell(context: { notice(level: Level, text: string): void }, error: unknown): void {
  if (error instanceof EngineError && (error.quiet || error.code === "lost")) return;
  context.notice("error", error instanceof Error ? error.message : String(error));
}

/// A part of the page: renders again when the store changes.
export abstract class Part extends LitElement {
  @property({ attribute: false }) context!: StudioContext;
  private readonly changed = () => this.requestUpdate();

  get store(): Store {
    return this.context.store;
  }

  override connectedCallback(): void {
    super.connectedCallback();
    this.context?.store.addEventListener("change", this.changed);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.context?.store.removeEventListener("change", this.changed);
  }
}
