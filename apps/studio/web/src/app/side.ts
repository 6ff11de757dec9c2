// The right side: settings of the tool in hand, then one panel at a time.
import { css, html, nothing } from "lit";
import { customElement, property } from "lit/decorators.js";
import type { PanelId } from "../engine/store";
import { historyPanel, historyStyles } from "../panels/history";
import { pointsPanel } from "../panels/points";
import { problemsPanel, problemStyles } from "../panels/problems";
import { reconstructPanel, reconstructStyles, refreshReconstruct } from "../panels/reconstruct";
import { comparisonStyles, surfacePanel } from "../panels/surface";
import { base } from "../ui/styles";
import { Part } from "./context";

const kPanels: [PanelId, string][] = [
  ["reconstruct", "Reconstruct"],
  ["points", "Points"],
  ["surface", "Surface"],
  ["problems", "Problems"],
  ["history", "History"],
];

@customElement("psk-side")
export class Side extends Part {
  static override styles = [
    base,
    reconstructStyles,
    historyStyles,
    problemStyles,
    comparisonStyles,
    css`
      :host {
        display: flex;
        flex-direction: column;
        background: var(--panel);
        border-left: 1px solid var(--line);
        overflow: hidden;
      }
      .tool {
        border-bottom: 1px solid var(--line);
        padding: 8px 12px;
        max-height: 50%;
        overflow-y: auto;
        flex: none;
      }
      .tool h2 {
        font-weight: 600;
        line-height: 28px;
        display: flex;
        gap: 8px;
        align-items: center;
      }
      [role="tablist"] {
        display: flex;
        flex: none;
        padding: 0 4px;
        border-bottom: 1px solid var(--line);
        background: var(--bar);
      }
      [role="tab"] {
        flex: 1 1 auto;
        border: 0;
        border-bottom: 2px solid transparent;
        background: none;
        height: 36px;
        padding: 2px 4px 0;
        color: var(--text-2);
        min-width: 0;
        font-size: 12px;
      }
      [role="tab"]:hover {
        color: var(--text);
      }
      [role="tab"]:focus-visible {
        outline-offset: -2px;
      }
      [role="tab"][aria-selected="true"] {
        color: var(--text);
        border-bottom-color: var(--blue);
      }
      [role="tabpanel"] {
        flex: 1 1 auto;
        min-height: 0;
        overflow-y: auto;
        padding: 8px 12px 16px;
        outline: none;
      }
      h3 {
        font-weight: 600;
        margin: 16px 0 4px;
        line-height: 20px;
      }
      .unseen + h3 {
        margin-top: 4px;
      }
    `,
  ];
  @property({ type: Number }) beat = 0; // changes when the tool wants its settings rendered anew

  override render() {
    const { panel } = this.store;
    const name = kPanels.find(([id]) => id === panel)?.[1] ?? "";
    return html`${this.tool()}
      <div role="tablist" aria-label="Panels" @keydown=${(event: KeyboardEvent) => this.key(event)}>
        ${kPanels.map(([id, name], i) => this.tab(id, name, i, panel))}
      </div>
      <div role="tabpanel" tabindex="0" aria-label=${name} data-testid="panel-${panel}"><h2 class="unseen">${name}</h2>${this.panel(panel)}</div>`;
  }

  override updated(): void {
    refreshReconstruct(this.context);
  }

  private tool() {
    const tool = this.context.tool();
    const settings = tool?.settings?.();
    if (!tool || !settings) return nothing;
    return html`<section class="tool" aria-label="Settings of the tool" data-testid="tool-settings"><h2>${tool.title} <kbd>${tool.key.toUpperCase()}</kbd></h2>${settings}</section>`;
  }

  private tab(id: PanelId, name: string, i: number, chosen: PanelId) {
    return html`<button
      role="tab"
      data-testid="tab-${id}"
      aria-selected=${String(id === chosen)}
      tabindex=${id === chosen ? 0 : -1}
      title="${name} (Alt+${i + 1})"
      @click=${() => this.store.update({ panel: id })}
    >
      ${name}
    </button>`;
  }

  private panel(id: PanelId) {
    const { context } = this;
    if (id === "reconstruct") return reconstructPanel(context);
    if (id === "points") return pointsPanel(context);
    if (id === "surface") return surfacePanel(context);
    if (id === "problems") return problemsPanel(context);
    return historyPanel(context);
  }

  private key(event: KeyboardEvent): void {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const at = kPanels.findIndex(([id]) => id === this.store.panel);
    const [id] = kPanels[(at + step + kPanels.length) % kPanels.length]!;
    this.store.update({ panel: id });
    void this.updateComplete.then(() => this.renderRoot.querySelector<HTMLElement>(`[data-testid="tab-${id}"]`)?.focus());
  }
}
