// Folders below the program's root, and files of this computer. Also chooses the reference of a comparison.
import { css, html, nothing } from "lit";
import { customElement, property, state } from "lit/decorators.js";
import type { FileEntry, FilePlace } from "../engine/protocol";
import { button, selectRow, switchRow } from "../ui/controls";
import { bytes, percent } from "../ui/format";
import { glyph, icons } from "../ui/icons";
import { styled } from "../ui/styled";
import { base } from "../ui/styles";
import { Part, tell } from "./context";
import { chooseFiles, openPlaces, resume, uploadAll } from "./opening";
import { joined, parentOf } from "./paths";
import { startSequence } from "./sequence";

@customElement("psk-open-dialog")
export class OpenDialog extends Part {
  static override styles = [
    base,
    css`
      :host {
        display: flex;
        flex-direction: column;
        min-height: 0;
        padding: 8px 16px 16px;
      }
      .path {
        display: flex;
        gap: 4px;
        align-items: center;
        color: var(--text-2);
        min-height: 28px;
      }
      .path span {
        overflow: hidden;
        text-overflow: ellipsis;
        white-space: nowrap;
        direction: rtl;
      }
      ul {
        list-style: none;
        margin: 4px 0 8px;
        padding: 4px;
        height: 320px;
        overflow-y: auto;
        border: 1px solid var(--line);
        border-radius: 5px;
        background: var(--field);
      }
      li button {
        display: grid;
        grid-template-columns: 20px minmax(0, 1fr) 80px 80px;
        gap: 8px;
        align-items: center;
        width: 100%;
        height: 28px;
        border: 0;
        border-radius: 4px;
        background: none;
        text-align: left;
        padding: 0 8px;
      }
      li button:hover {
        background: var(--hover);
      }
      li button[aria-selected="true"] {
        background: color-mix(in srgb, var(--blue) 30%, var(--field));
      }
      li span:nth-of-type(1) {
        overflow: hidden;
        text-overflow: ellipsis;
        white-space: nowrap;
      }
      li .hint:last-child {
        text-align: right;
      }
      .empty {
        padding: 8px;
      }
      .foot {
        display: flex;
        gap: 8px;
        align-items: center;
      }
      .foot .row {
        margin: 0 auto 0 0;
        grid-template-columns: auto auto;
      }
      .track {
        height: 6px;
        border-radius: 3px;
        background: var(--field);
        overflow: hidden;
        margin: 4px 0 8px;
      }
      .track div {
        height: 100%;
        background: var(--orange);
      }
    `,
  ];
  @property({ type: Boolean }) reference = false;
  @state() private folder = "";
  @state() private entries: FileEntry[] | null = null;
  @state() private chosen = new Set<string>();
  @state() private add = false;
  @state() private busy = "";
  @state() private fraction = 0;
  private forget: () => void = () => undefined;

  /// The list comes when there is an engine to ask: a dialog that is open before that waits for it.
  override connectedCallback(): void {
    super.connectedCallback();
    this.forget = this.context.connection.whenOpen(() => void (this.entries ?? this.enter("")));
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.forget();
  }

  private async enter(folder: string): Promise<void> {
    try {
      const { entries, folder: named } = await this.context.connection.request("files", { folder });
      const order = (entry: FileEntry) => (entry.kind === "folder" ? 0 : 1);
      this.entries = [...entries].sort((a, b) => order(a) - order(b) || a.name.localeCompare(b.name, "en", { numeric: true }));
      this.folder = named;
      this.chosen = new Set();
    } catch (error) {
      if (this.context.connection.state === "open") this.entries ??= [];
      tell(this.context, error);
    }
  }

  /// The folder above, as long as one of the roots holds it; null: there is none.
  private get above(): string | null {
    return parentOf(this.folder, this.store.hello?.roots ?? []);
  }

  private async goUp(): Promise<void> {
    if (this.above !== null) await this.enter(this.above);
  }

  private roots() {
    const roots = this.store.hello?.roots ?? [];
    if (roots.length < 2) return nothing;
    const choices = roots.map((value) => ({ value, label: value }));
    const root = roots.find((value) => this.folder.startsWith(value)) ?? roots[0]!;
    return selectRow({ label: "Root", testid: "open-root", value: root, choices, change: (value) => void this.enter(value) });
  }

  override render() {
    const { scene } = this.store;
    return html`${this.roots()}
      <div class="path">
        <button class="icon" aria-label="Folder above" title="Folder above (Backspace)" data-testid="open-up" ?disabled=${this.above === null} @click=${() => void this.goUp()}>
          ${glyph(icons.up)}
        </button>
        <span title=${this.folder}>${this.folder}</span>
      </div>
      <ul role="listbox" aria-label="Files" aria-multiselectable=${String(!this.reference)} @keydown=${(event: KeyboardEvent) => this.key(event)}>
        ${this.entries?.map((entry, i) => this.entry(entry, i))}
        ${this.entries?.length === 0 ? html`<li class="hint empty">There is nothing here that can be opened</li>` : nothing}
      </ul>
      ${this.busy ? html`<div role="status">${this.busy} ${percent(this.fraction)}</div><div class="track"><div ${styled({ width: `${100 * this.fraction}%` })}></div></div>` : nothing}
      <div class="foot">
        ${scene?.clouds.length && !this.reference
          ? switchRow({ label: "Add to the scene", testid: "open-add", title: "Merges with what is open instead of replacing it", value: this.add, change: (add) => (this.add = add) })
          : html`<span class="row"></span>`}
        ${button({ label: "From this computer…", testid: "open-upload", disabled: !!this.busy, run: () => void this.fromHere() })}
        ${button({ label: this.reference ? "Compare" : "Open", testid: "open-confirm", primary: true, disabled: this.chosen.size === 0 || !!this.busy, run: () => void this.confirm() })}
      </div>`;
  }

  private entry(entry: FileEntry, i: number) {
    const folder = entry.kind === "folder";
    return html`<li role="none">
      <button
        role="option"
        aria-selected=${String(this.chosen.has(entry.name))}
        tabindex=${i === 0 ? 0 : -1}
        data-testid="file-${entry.name}"
        @click=${(event: MouseEvent) => this.select(entry, event)}
        @dblclick=${() => !folder && void this.confirm()}
      >
        ${glyph(folder ? icons.folder : icons.file)}<span>${entry.name}</span><span class="hint">${folder ? "" : entry.kind}</span><span class="hint">${folder || entry.bytes === 0 ? "" : bytes(entry.bytes)}</span>
      </button>
    </li>`;
  }

  private select(entry: FileEntry, event: MouseEvent): void {
    if (entry.kind === "folder") return void this.enter(joined(this.folder, entry.name));
    const many = !this.reference && (event.ctrlKey || event.metaKey) && entry.kind !== "session" && entry.kind !== "sequence";
    const next = new Set(many ? this.chosen : []);
    if (many && next.has(entry.name)) next.delete(entry.name);
    else next.add(entry.name);
    this.chosen = next;
  }

  private key(event: KeyboardEvent): void {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) {
      const buttons = [...this.renderRoot.querySelectorAll<HTMLElement>("li button")];
      buttons[buttons.indexOf(event.target as HTMLElement) + step]?.focus();
    } else if (event.key === "Backspace") {
      void this.goUp();
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  private async confirm(): Promise<void> {
    const chosen = (this.entries ?? []).filter((entry) => this.chosen.has(entry.name));
    const first = chosen[0];
    if (!first) return;
    const path = joined(this.folder, first.name);
    this.finish();
    if (this.reference) await this.compare({ path });
    else if (first.kind === "session") await resume(this.context, path);
    else if (first.kind === "sequence") await startSequence(this.context, path);
    else await openPlaces(this.context, chosen.map(({ name }) => ({ path: joined(this.folder, name) })), this.add);
  }

  private async fromHere(): Promise<void> {
    const files = await chooseFiles(!this.reference);
    if (files.length === 0) return;
    const places = await uploadAll(this.context, files, (fraction, name) => ([this.fraction, this.busy] = [fraction, name]));
    this.busy = "";
    if (!places?.length) return;
    this.finish();
    if (this.reference) await this.compare(places[0]!);
    else await openPlaces(this.context, places, this.add);
  }

  private async compare(reference: FilePlace): Promise<void> {
    try {
      const comparison = await this.context.connection.request("compare", { reference });
      this.store.update({ comparison, panel: "surface", view: { ...this.store.view, colour: "distance" } });
    } catch (error) {
      tell(this.context, error);
    }
  }

  private finish(): void {
    this.dispatchEvent(new Event("done"));
  }
}
