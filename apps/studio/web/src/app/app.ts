// The frame of the page: bars around the view, and what ties the parts together.
import { LitElement, html, nothing, svg } from "lit";
import { customElement, query, state } from "lit/decorators.js";
import { Blobs } from "../engine/blobs";
import { Connection } from "../engine/connection";
import { Link } from "../engine/link";
import { admission, exchangeToken, socketAddress } from "../engine/session";
import { Store } from "../engine/store";
import type { Level } from "../engine/store";
import { LiveOptions } from "../panels/live_options";
import { tools } from "../tools";
import type { Tool } from "../tools/tool";
import { Commands } from "../ui/commands";
import { base } from "../ui/styles";
import { Controls } from "../view/controls";
import { Viewport } from "../view/viewport";
import { addCommands } from "./command_list";
import type { DialogId, StudioContext } from "./context";
import { Keys } from "./keys";
import { frameStyles } from "./app_styles";
import { chosenTheme, paintTheme } from "./theme";
import "./dialogs";
import "./drop_zone";
import "./legend";
import "./side";
import "./status_bar";
import "./timeline";
import "./toasts";
import "./tool_bar";
import "./top_bar";
import "./view_gizmo";
import "../ui/palette";

@customElement("psk-app")
export class App extends LitElement {
  static override styles = [base, frameStyles];
  @state() private dialog: DialogId | null = null;
  @state() private palette = false;
  @state() private refused = "";
  @state() private beat = 0; // settings and overlay of the tool are rendered anew
  @state() private overlayBeat = 0; // the overlay alone, with each frame
  @query("canvas") private canvas!: HTMLCanvasElement;
  private context: StudioContext | null = null;
  private active: Tool | null = null;
  private lastView: unknown = null;

  /// In a task of its own, so that the one that loads the page stays short.
  override firstUpdated(): void {
    setTimeout(() => this.start());
  }

  private start(): void {
    const store = new Store();
    const connection = new Connection(socketAddress(), async () => (await admission()) === "refused");
    const viewport = new Viewport(this.canvas);
    const commands = new Commands();
    const notice = (level: Level, text: string) => void store.addNotice(level, text);
    const context: StudioContext = {
      connection,
      store,
      viewport,
      commands,
      link: new Link(connection, store, viewport, new Blobs("/assets/worker.js")),
      live: new LiveOptions(connection, store, notice),
      tools: [],
      tool: () => this.active,
      chooseTool: (id) => this.chooseTool(id),
      openDialog: (id) => (this.dialog = id),
      openPalette: () => (this.palette = true),
      setTheme: (theme) => paintTheme(theme, viewport),
      redraw: () => this.beat++,
      notice,
      run: (command) => void commands.run(command),
    };
    context.tools.push(...tools.map((factory) => factory(context)));
    this.context = context;
    this.begin(context);
  }

  private begin(context: StudioContext): void {
    const { store, viewport } = context;
    addCommands(context);
    const controls = new Controls(viewport, () => this.active, () => undefined);
    new Keys(context, controls, this.canvas);
    viewport.onFrame(() => this.active?.overlay && this.overlayBeat++);
    store.addEventListener("change", () => this.storeChanged(context));
    paintTheme(chosenTheme(), viewport);
    this.chooseTool("navigate");
    this.beat++;
    // The address of a program that was started again differs after # alone, which loads no page.
    window.addEventListener("hashchange", () => location.hash && void this.connect(context));
    void this.connect(context);
  }

  private async connect(context: StudioContext): Promise<void> {
    const answer = await exchangeToken();
    const outside = answer === "refused" && context.connection.state !== "open";
    this.refused = outside ? "This page is not signed in. Open the address that the program printed, with the part after #." : "";
    if (answer !== "refused") context.connection.start();
  }

  private storeChanged(context: StudioContext): void {
    const { store, viewport, link } = context;
    if (this.lastView !== store.view) {
      this.lastView = store.view;
      viewport.apply(store.view);
      link.legend();
      void link.lines();
    }
    const name = store.scene?.clouds[0]?.name;
    document.title = name ? `${name} – Pointskin studio` : "Pointskin studio";
    this.beat++;
  }

  private chooseTool(id: string): void {
    const context = this.context;
    const next = context?.tools.find((tool) => tool.id === id);
    if (!context || !next || next === this.active) return;
    this.active?.deactivate?.();
    this.active = next;
    next.activate?.();
    this.canvas.dataset["tool"] = id;
    context.store.update({ tool: id });
  }

  override render() {
    const context = this.context;
    return html`
      ${context ? html`<psk-top-bar role="banner" .context=${context}></psk-top-bar>` : nothing}
      ${context ? html`<psk-tool-bar role="region" aria-label="Tool bar" .context=${context}></psk-tool-bar>` : nothing}
      <main aria-label="View">
        <canvas
          data-testid="viewport"
          tabindex="0"
          role="application"
          aria-label="3D view of the scene. Arrow keys turn it, plus and minus go nearer and farther."
        ></canvas>
        <svg class="overlay" aria-hidden="true" data-beat=${this.overlayBeat}>${this.active?.overlay?.() ?? svg``}</svg>
        ${context ? this.overView(context) : nothing}
      </main>
      ${context ? this.around(context) : nothing}
    `;
  }

  private overView(context: StudioContext) {
    const { connection } = context.store;
    const again = "The program was started again. Open the address that it printed then, here or in another tab; this page goes on by itself.";
    const refused = this.refused || (connection === "refused" ? again : "");
    return html`
      <psk-view-gizmo .context=${context}></psk-view-gizmo>
      <psk-legend .context=${context}></psk-legend>
      <psk-drop-zone .context=${context}></psk-drop-zone>
      <psk-toasts .context=${context}></psk-toasts>
      ${connection === "lost" ? html`<div class="banner" role="status" data-testid="connection-banner">Connection lost, trying again</div>` : nothing}
      ${refused ? html`<div class="banner" role="alert" data-testid="refused-banner">${refused}</div>` : nothing}
    `;
  }

  private around(context: StudioContext) {
    const close = () => {
      this.dialog = null;
      this.canvas.focus({ preventScroll: true });
    };
    return html`
      <psk-side role="complementary" aria-label="Panels" .context=${context} .beat=${this.beat}></psk-side>
      <psk-timeline role="region" aria-label="Sequence" .context=${context}></psk-timeline>
      <psk-status-bar role="contentinfo" .context=${context}></psk-status-bar>
      ${this.dialog ? html`<psk-dialogs .context=${context} .which=${this.dialog} @close=${close}></psk-dialogs>` : nothing}
      ${this.palette ? html`<psk-palette .commands=${context.commands} @close=${() => (this.palette = false)}></psk-palette>` : nothing}
    `;
  }
}
