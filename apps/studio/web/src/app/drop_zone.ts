// What an empty view offers, and where files are dropped at any time.
import { css, html, nothing } from "lit";
import { customElement, state } from "lit/decorators.js";
import { button } from "../ui/controls";
import { percent } from "../ui/format";
import { glyph, icons } from "../ui/icons";
import { styled } from "../ui/styled";
import { base } from "../ui/styles";
import { Part } from "./context";
import { chooseFiles, openDropped, openPlaces } from "./opening";

const kMostShapes = 8;
const kDemoPoints = 60_000;

@customElement("psk-drop-zone")
export class DropZone extends Part {
  static override styles = [
    base,
    css`
      :host {
        position: absolute;
        inset: 0;
        display: grid;
        place-items: center;
        pointer-events: none;
      }
      .card-empty {
        pointer-events: auto;
        width: min(440px, 90%);
        padding: 24px;
        border: 1px dashed var(--line-strong);
        border-radius: 8px;
        background: color-mix(in srgb, var(--panel) 92%, transparent);
        text-align: center;
      }
      .card-empty svg.glyph {
        width: 32px;
        height: 32px;
        margin: 0 auto 8px;
        color: var(--text-3);
      }
      .button svg.glyph {
        display: none;
      }
      h2 {
        font-size: 16px;
        line-height: 24px;
        font-weight: 600;
      }
      .actions {
        justify-content: center;
        margin: 12px 0;
      }
      .shapes {
        border-top: 1px solid var(--line);
        padding-top: 12px;
        margin-top: 16px;
      }
      .over {
        position: absolute;
        inset: 8px;
        display: grid;
        place-items: center;
        border: 2px dashed var(--blue);
        border-radius: 8px;
        background: color-mix(in srgb, var(--blue) 18%, transparent);
        font-size: 16px;
      }
      .sending {
        width: 280px;
        padding: 12px 16px;
        border-radius: 5px;
        background: var(--raised);
        border: 1px solid var(--line);
        box-shadow: var(--shadow);
      }
      .track {
        height: 6px;
        border-radius: 3px;
        background: var(--field);
        overflow: hidden;
        margin-top: 8px;
      }
      .track div {
        height: 100%;
        background: var(--orange);
      }
    `,
  ];
  @state() private over = false;
  @state() private sending: { name: string; fraction: number } | null = null;

  override connectedCallback(): void {
    super.connectedCallback();
    window.addEventListener("dragover", this.dragOver);
    window.addEventListener("dragleave", this.dragLeave);
    window.addEventListener("drop", this.drop);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    window.removeEventListener("dragover", this.dragOver);
    window.removeEventListener("dragleave", this.dragLeave);
    window.removeEventListener("drop", this.drop);
  }

  override render() {
    if (this.sending) return this.progress(this.sending);
    if (this.over) return html`<div class="over">Drop to open</div>`;
    const { scene, hello, sequence } = this.store;
    if (sequence || !hello || (scene && scene.clouds.length > 0)) return nothing;
    return this.empty(hello.shapes);
  }

  private empty(shapes: string[]) {
    return html`<section class="card-empty" data-testid="empty-state" aria-label="Open a scan">
      ${glyph(icons.points)}
      <h2>Drop a scan here</h2>
      <p class="hint">PLY, XYZ, VTK, OBJ and more: points, with normals or without. Nothing leaves this machine.</p>
      <div class="actions">
        ${button({ label: "Open…", testid: "empty-open", primary: true, title: "Files below the program's root (Ctrl+O)", run: () => this.context.openDialog("open") })}
        ${button({ label: "From this computer…", testid: "empty-choose", run: () => void this.choose() })}
      </div>
      ${shapes.length > 0
        ? html`<div class="shapes">
            <p class="hint">No scan at hand? Generated shapes:</p>
            <div class="actions">${shapes.slice(0, kMostShapes).map((shape) => this.shape(shape))}</div>
          </div>`
        : nothing}
    </section>`;
  }

  private shape(shape: string) {
    const run = () => void openPlaces(this.context, [{ shape, points: kDemoPoints }], false);
    return button({ label: shape.replaceAll("_", " "), testid: `shape-${shape}`, title: `Open the generated ${shape}`, run });
  }

  private progress({ name, fraction }: { name: string; fraction: number }) {
    return html`<div class="sending" role="status" data-testid="upload-progress">
      ${name} ${percent(fraction)}
      <div class="track"><div ${styled({ width: `${100 * fraction}%` })}></div></div>
    </div>`;
  }

  private async choose(): Promise<void> {
    await this.send(await chooseFiles(true));
  }

  private async send(files: File[]): Promise<void> {
    if (files.length === 0) return;
    this.sending = { name: files[0]!.name, fraction: 0 };
    await openDropped(this.context, files, (fraction, name) => (this.sending = { name, fraction }));
    this.sending = null;
  }

  private readonly dragOver = (event: DragEvent) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    this.over = true;
  };

  private readonly dragLeave = (event: DragEvent) => {
    if (event.relatedTarget === null) this.over = false;
  };

  private readonly drop = (event: DragEvent) => {
    if (!event.dataTransfer?.files.length) return;
    event.preventDefault();
    this.over = false;
    void this.send([...event.dataTransfer.files]);
  };
}
