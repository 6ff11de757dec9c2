// The list of all commands, searched as one types.
import { LitElement, css, html } from "lit";
import { customElement, property, query, state } from "lit/decorators.js";
import type { Command, Commands } from "./commands";
import { base } from "./styles";

@customElement("psk-palette")
export class Palette extends LitElement {
  static override styles = [
    base,
    css`
      :host {
        position: fixed;
        inset: 0;
        z-index: 20;
        display: flex;
        justify-content: center;
        align-items: flex-start;
        padding-top: 12vh;
        background: rgb(0 0 0 / 28%);
      }
      .box {
        width: min(520px, 92vw);
        max-height: 60vh;
        display: flex;
        flex-direction: column;
        background: var(--panel);
        border: 1px solid var(--line);
        border-radius: 8px;
        box-shadow: var(--shadow);
        overflow: hidden;
      }
      input {
        flex: none;
        height: 44px;
        border: 0;
        border-bottom: 1px solid var(--line);
        background: none;
        padding: 0 16px;
        outline: none;
        font-size: 15px;
      }
      ul {
        list-style: none;
        margin: 0;
        padding: 4px;
        overflow-y: auto;
      }
      li {
        display: flex;
        align-items: center;
        gap: 8px;
        height: 28px;
        padding: 0 12px;
        border-radius: 5px;
      }
      li span {
        flex: 1;
      }
      li[aria-selected="true"] {
        background: color-mix(in srgb, var(--blue) 30%, var(--panel));
      }
      li[aria-disabled="true"] {
        color: var(--text-3);
      }
      .none {
        color: var(--text-3);
      }
    `,
  ];
  @property({ attribute: false }) commands!: Commands;
  @state() private text = "";
  @state() private at = 0;
  @query("input") private input!: HTMLInputElement;
  private readonly returnTo = document.activeElement as HTMLElement | null;

  override firstUpdated(): void {
    this.input.focus();
  }

  private get found(): Command[] {
    return this.commands.search(this.text).filter((command) => command.id !== "palette");
  }

  override render() {
    const found = this.found;
    const chosen = found[this.at];
    return html`<div class="box" role="dialog" aria-modal="true" aria-label="Commands" data-testid="palette" @click=${(e: Event) => e.stopPropagation()}>
      <input
        type="text"
        role="combobox"
        aria-expanded="true"
        aria-controls="list"
        aria-label="Search commands"
        aria-activedescendant=${chosen ? `c-${chosen.id}` : ""}
        placeholder="Type what to do"
        data-testid="palette-input"
        .value=${this.text}
        @input=${this.typed}
        @keydown=${(event: KeyboardEvent) => this.key(event)}
      />
      <ul id="list" role="listbox" aria-label="Commands">
        ${found.map((command, i) => this.item(command, i))}
        ${found.length === 0 ? html`<li class="none" role="option" aria-selected="false">No command has these letters</li>` : null}
      </ul>
    </div>`;
  }

  override updated(): void {
    this.renderRoot.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }

  private item(command: Command, i: number) {
    const off = command.enabled?.() === false;
    return html`<li
      id="c-${command.id}"
      role="option"
      aria-selected=${String(i === this.at)}
      aria-disabled=${String(off)}
      data-testid="palette-${command.id}"
      @pointermove=${() => (this.at = i)}
      @click=${() => this.choose(command)}
    >
      <span>${command.title}</span>${command.key ? html`<kbd>${command.key}</kbd>` : null}
    </li>`;
  }

  private readonly typed = () => {
    this.text = this.input.value;
    this.at = 0;
  };

  private key(event: KeyboardEvent): void {
    const found = this.found;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) this.at = (this.at + step + found.length) % Math.max(found.length, 1);
    else if (event.key === "Enter" && found[this.at]) this.choose(found[this.at]!);
    else if (event.key === "Escape") this.close();
    else if (event.key !== "Tab") return event.stopPropagation();
    event.preventDefault();
    event.stopPropagation();
  }

  private choose(command: Command): void {
    if (command.enabled?.() === false) return;
    this.close();
    command.run();
  }

  private close(): void {
    this.returnTo?.focus?.();
    this.dispatchEvent(new Event("close"));
  }

  override connectedCallback(): void {
    super.connectedCallback();
    this.addEventListener("click", () => this.close());
  }
}
