// Dialogs: one at a time, modal, closed by Esc. The browser's <dialog> keeps the focus inside.
import { css, html } from "lit";
import { customElement, property, query } from "lit/decorators.js";
import { glyph, icons } from "../ui/icons";
import { base } from "../ui/styles";
import type { DialogId } from "./context";
import { Part } from "./context";
import "./keys_list";
import "./open_dialog";
import "./save_dialog";

const kTitles: Record<DialogId, string> = { open: "Open", save: "Save", reference: "Compare with a reference", keys: "Keys" };

@customElement("psk-dialogs")
export class Dialogs extends Part {
  static override styles = [
    base,
    css`
      dialog {
        width: min(600px, 94vw);
        max-height: 84vh;
        padding: 0;
        border: 1px solid var(--line);
        border-radius: 8px;
        background: var(--panel);
        color: inherit;
        box-shadow: var(--shadow);
        overflow: hidden;
      }
      dialog[open] {
        display: flex;
        flex-direction: column;
      }
      dialog::backdrop {
        background: rgb(0 0 0 / 42%);
      }
      .head {
        display: flex;
        align-items: center;
        justify-content: space-between;
        height: 40px;
        padding: 0 8px 0 16px;
        border-bottom: 1px solid var(--line);
        flex: none;
      }
      h2 {
        font-weight: 600;
      }
    `,
  ];
  @property() which: DialogId = "open";
  @query("dialog") private dialog!: HTMLDialogElement;

  override firstUpdated(): void {
    this.dialog.showModal();
  }

  private close(): void {
    this.dialog.close();
  }

  override render() {
    const id = this.which === "reference" ? "open-dialog" : `${this.which}-dialog`;
    return html`<dialog aria-label=${kTitles[this.which]} data-testid=${id} @close=${() => this.dispatchEvent(new Event("close"))}>
      <div class="head">
        <h2>${kTitles[this.which]}</h2>
        <button class="icon" data-testid="dialog-close" aria-label="Close" title="Close (Esc)" @click=${() => this.close()}>${glyph(icons.close)}</button>
      </div>
      ${this.content()}
    </dialog>`;
  }

  private content() {
    const done = () => this.close();
    if (this.which === "save") return html`<psk-save-dialog .context=${this.context} @done=${done}></psk-save-dialog>`;
    if (this.which === "keys") return html`<psk-keys-list tabindex="0" role="region" aria-label="List of keys" .context=${this.context}></psk-keys-list>`;
    return html`<psk-open-dialog .context=${this.context} .reference=${this.which === "reference"} @done=${done}></psk-open-dialog>`;
  }
}
