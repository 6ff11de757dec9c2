// Saving: what, in which format, where. The server writes below its root, or the browser downloads.
import { css, html, nothing } from "lit";
import { customElement, state } from "lit/decorators.js";
import type { FileEntry, SaveWhat } from "../engine/protocol";
import { EngineError } from "../engine/connection";
import { button, segmentsRow, selectRow, switchRow } from "../ui/controls";
import { bytes, count } from "../ui/format";
import { base } from "../ui/styles";
import { Part, tell } from "./context";
import { joined, parentOf, withExtension } from "./paths";
import { handOver, savePicture, takePicture } from "./picture";

const kFixed: Partial<Record<SaveWhat, string>> = { session: "json", script: "json", picture: "png" };

@customElement("psk-save-dialog")
export class SaveDialog extends Part {
  static override styles = [
    base,
    css`
      :host {
        display: block;
        padding: 8px 16px 16px;
      }
      .foot {
        display: flex;
        justify-content: flex-end;
        gap: 8px;
        margin-top: 12px;
      }
      .said {
        margin-right: auto;
        align-self: center;
      }
    `,
  ];
  @state() private what: SaveWhat = "mesh";
  @state() private format = "ply";
  @state() private name = "";
  @state() private folder = "";
  @state() private folders: string[] | null = null;
  @state() private toServer = true;
  @state() private overwrite = false;
  @state() private asked = false; // the file is there already
  @state() private busy = false;
  @state() private said = "";
  private forget: () => void = () => undefined;

  override firstUpdated(): void {
    const cloud = this.store.scene?.clouds[0]?.name ?? "scene";
    this.name = withExtension(cloud.split("/").pop() ?? "scene", "ply").replace(/\.ply$/, "_surface.ply");
  }

  override connectedCallback(): void {
    super.connectedCallback();
    this.forget = this.context.connection.whenOpen(() => void (this.folders ?? this.look("")));
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.forget();
  }

  private async look(folder: string): Promise<void> {
    try {
      const { entries, folder: named } = await this.context.connection.request("files", { folder });
      this.folder = named;
      this.folders = entries.filter((entry: FileEntry) => entry.kind === "folder").map((entry) => entry.name);
    } catch (error) {
      tell(this.context, error);
    }
  }

  private get extensions(): string[] {
    const fixed = kFixed[this.what];
    if (fixed) return [fixed];
    const formats = this.store.hello?.formats ?? [];
    const fitting = formats.filter((format) => (this.what === "mesh" ? format.mesh : format.cloud));
    const all = fitting.flatMap((format) => format.extensions.map((extension) => extension.replace(/^\./, "")));
    return all.length > 0 ? [...new Set(all)] : ["ply"];
  }

  private choose(what: SaveWhat): void {
    this.what = what;
    this.said = "";
    const first = this.extensions.includes(this.format) ? this.format : this.extensions[0]!;
    this.setFormat(first);
  }

  private setFormat(format: string): void {
    this.format = format;
    this.name = withExtension(this.name, format);
    this.asked = false;
  }

  override render() {
    return html`${segmentsRow({
        label: "What",
        testid: "save-what",
        value: this.what,
        choices: [
          { value: "mesh", label: "Surface" },
          { value: "cloud", label: "Points" },
          { value: "session", label: "Session", title: "All operations, to go on later" },
          { value: "script", label: "Script", title: "For pointskin edit --script" },
          { value: "picture", label: "Picture" },
        ],
        change: (what) => this.choose(what),
      })}
      ${selectRow({ label: "Format", testid: "save-format", value: this.format, choices: this.extensions.map((value) => ({ value, label: value.toUpperCase() })), change: (value) => this.setFormat(value) })}
      <label class="row"><span class="label">Name</span><input class="text" type="text" data-testid="save-name" aria-label="Name" .value=${this.name} @input=${this.named} @keydown=${this.entered} /></label>
      ${segmentsRow({
        label: "To",
        testid: "save-to",
        value: this.toServer ? "folder" : "download",
        choices: [
          { value: "folder", label: "Folder of the program" },
          { value: "download", label: "Download" },
        ],
        change: (value) => (this.toServer = value === "folder"),
      })}
      ${this.toServer ? this.where() : nothing}
      <div class="foot">
        <span class="said" role="status" data-testid="saved">${this.said}</span>
        ${button({ label: this.asked ? "Replace the file" : "Save", testid: "save-confirm", primary: true, disabled: this.busy || this.name === "", run: () => void this.save() })}
      </div>`;
  }

  private where() {
    const roots = this.store.hello?.roots ?? [];
    const above = parentOf(this.folder, roots);
    const choices = [
      { value: this.folder, label: this.folder },
      ...(above === null ? [] : [{ value: above, label: "↑ folder above" }]),
      ...(this.folders ?? []).map((name) => ({ value: joined(this.folder, name), label: `→ ${name}` })),
      ...roots.filter((root) => root !== this.folder && root !== above).map((root) => ({ value: root, label: root })),
    ];
    const go = (value: string) => void this.look(value);
    return html`${selectRow({ label: "Folder", testid: "save-folder", value: this.folder, choices, change: go })}
    ${switchRow({ label: "Replace a file", testid: "save-overwrite", title: "A file of this name is replaced without a question", value: this.overwrite, change: (value) => (this.overwrite = value) })}`;
  }

  private readonly named = (event: Event) => {
    this.name = (event.target as HTMLInputElement).value;
    this.asked = false;
  };

  private readonly entered = (event: KeyboardEvent) => {
    if (event.key === "Enter") void this.save();
  };

  private async save(): Promise<void> {
    this.busy = true;
    try {
      await this.write();
      this.asked = false;
    } catch (error) {
      const there = error instanceof EngineError && /already|overwrite/i.test(error.message);
      this.asked = there && !this.asked;
      this.said = (error as Error).message;
    }
    this.busy = false;
  }

  private async write(): Promise<void> {
    const { context, what, name, folder } = this;
    const overwrite = this.overwrite || this.asked;
    if (what === "picture" && !this.toServer) return takePicture(context, name);
    const body = this.toServer ? { what, name, folder, overwrite } : { what, name, download: true };
    const saved = what === "picture" ? await savePicture(context, name, folder, overwrite) : await context.connection.request("save", body);
    if (saved.download !== undefined) handOver(`/download/${saved.download}`, name);
    this.said = `Saved, ${count(saved.bytes)} bytes`;
    context.notice("info", `Saved ${saved.path ?? name}, ${bytes(saved.bytes)}`);
  }
}
