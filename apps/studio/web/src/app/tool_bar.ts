// The tools, one button each; the arrow keys go from one to the next.
import { css, html } from "lit";
import { customElement } from "lit/decorators.js";
import type { Tool } from "../tools/tool";
import { glyph } from "../ui/icons";
import { base } from "../ui/styles";
import { Part } from "./context";

@customElement("psk-tool-bar")
export class ToolBar extends Part {
  static override styles = [
    base,
    css`
      :host {
        background: var(--bar);
        border-right: 1px solid var(--line);
        padding: 6px;
        overflow-y: auto;
      }
      [role="toolbar"] {
        display: flex;
        flex-direction: column;
        gap: 4px;
      }
      .icon {
        position: relative;
        width: 31px;
        height: 31px;
      }
      .icon small {
        position: absolute;
        right: 2px;
        bottom: 1px;
        font-size: 9px;
        line-height: 9px;
        color: var(--text-3);
      }
      .icon[aria-pressed="true"] small {
        color: var(--text);
      }
      .icon[aria-pressed="true"] {
        box-shadow: inset 2px 0 0 var(--blue);
      }
    `,
  ];

  override render() {
    return html`<div role="toolbar" aria-label="Tools" aria-orientation="vertical" @keydown=${(event: KeyboardEvent) => this.key(event)}>
      ${this.context.tools.map((tool) => this.tool(tool))}
    </div>`;
  }

  private tool(tool: Tool) {
    const chosen = tool.id === this.store.tool;
    return html`<button
      class="icon"
      data-testid="tool-${tool.id}"
      title="${tool.title} (${tool.key.toUpperCase()})
${tool.hint}"
      aria-label=${tool.title}
      aria-keyshortcuts=${tool.key.toUpperCase()}
      aria-pressed=${String(chosen)}
      tabindex=${chosen ? 0 : -1}
      @click=${() => this.context.chooseTool(tool.id)}
    >
      ${glyph(tool.icon)}<small aria-hidden="true">${tool.key.toUpperCase()}</small>
    </button>`;
  }

  private key(event: KeyboardEvent): void {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const buttons = [...this.renderRoot.querySelectorAll<HTMLElement>("button")];
    const at = buttons.indexOf(event.target as HTMLElement);
    buttons[(at + step + buttons.length) % buttons.length]?.focus();
  }
}
