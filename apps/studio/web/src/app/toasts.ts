// Notices, and the chip that says what the last operation did.
import { css, html, nothing } from "lit";
import { customElement } from "lit/decorators.js";
import { repeat } from "lit/directives/repeat.js";
import type { Notice } from "../engine/store";
import { duration } from "../ui/format";
import { glyph, icons } from "../ui/icons";
import { base } from "../ui/styles";
import { chipText } from "./chip";
import { Part } from "./context";

@customElement("psk-toasts")
export class Toasts extends Part {
  static override styles = [
    base,
    css`
      :host {
        position: absolute;
        left: 12px;
        right: 12px;
        bottom: 12px;
        display: flex;
        flex-direction: column;
        align-items: center;
        gap: 8px;
        pointer-events: none;
      }
      .toast {
        pointer-events: auto;
        display: flex;
        align-items: flex-start;
        gap: 8px;
        max-width: min(560px, 100%);
        padding: 6px 6px 6px 12px;
        border: 1px solid var(--line);
        border-left: 3px solid var(--blue);
        border-radius: 5px;
        background: var(--raised);
        box-shadow: var(--shadow);
        user-select: text;
        -webkit-user-select: text;
      }
      .toast p {
        padding: 4px 0;
        overflow-wrap: anywhere;
      }
      .warning,
      .error {
        border-left-color: var(--orange);
      }
      .error {
        background: color-mix(in srgb, var(--orange) 14%, var(--raised));
      }
      .chip {
        padding: 4px 16px;
        border-radius: 14px;
        border: 1px solid var(--line);
        background: var(--raised);
        box-shadow: var(--shadow);
      }
      .chip small {
        color: var(--text-3);
        font-size: 12px;
        padding-left: 8px;
      }
    `,
  ];
  private chipTimed = 0;
  private readonly timers = new Map<number, number>();

  override render() {
    const { notices, chip } = this.store;
    return html`<div class="unseen" role="status" aria-live="polite">${chip ? chipText(chip.record) : ""}</div>
      ${repeat(notices, (n) => n.id, (n) => this.toast(n))}
      ${chip
        ? html`<div class="chip" data-testid="chip">${chipText(chip.record)}<small>${duration(chip.record.total_ms)}</small></div>`
        : nothing}`;
  }

  override updated(): void {
    const { chip } = this.store;
    if (chip && chip.id !== this.chipTimed) {
      this.chipTimed = chip.id;
      setTimeout(() => this.store.chip?.id === chip.id && this.store.update({ chip: null }), 12_000);
    }
    for (const { id, level } of this.store.notices) {
      if (this.timers.has(id) || level === "error") continue;
      this.timers.set(id, window.setTimeout(() => this.store.dropNotice(id), level === "info" ? 5000 : 9000));
    }
  }

  private toast(notice: Notice) {
    return html`<div class="toast ${notice.level}" role=${notice.level === "error" ? "alert" : "status"} data-testid="notice" data-level=${notice.level}>
      <p>${notice.text}</p>
      <button class="icon" aria-label="Close this notice" title="Close" @click=${() => this.store.dropNotice(notice.id)}>${glyph(icons.close)}</button>
    </div>`;
  }
}
