// Chooses a second cloud, mesh or generated shape: one of the shapes that the engine makes, a file below its root, or
// one of this computer, which is sent.
import { type TemplateResult, html, nothing } from "lit";
import type { FileEntry, FileKind } from "../../engine/protocol";
import { upload } from "../../engine/session";
import { button, segmentsRow, selectRow } from "../../ui/controls";
import type { ToolContext } from "../tool";
import type { Source } from "./documents";

export class SourcePicker {
  source: Source | null = null;
  private kind: "shape" | "file" = "shape";
  private sent = ""; // name of the file that was sent
  private sending = -1; // share of it that has gone; -1: none is
  private folder = "";
  private entries: FileEntry[] = [];
  private listed = false;
  private error = "";

  constructor(
    private readonly context: ToolContext,
    private readonly name: string, // begins the test ids
    private readonly kinds: FileKind[], // of the files that fit
    private readonly chosen: () => void,
  ) {}

  get title(): string {
    if (!this.source) return "nothing yet";
    if ("upload" in this.source) return this.sent;
    return "file" in this.source ? this.source.file.split("/").pop()! : this.source.shape;
  }

  private choose(source: Source): void {
    this.source = source;
    this.chosen();
    this.context.redraw();
  }

  private setKind(kind: "shape" | "file"): void {
    this.kind = kind;
    if (kind === "file" && !this.listed) void this.list("");
    this.context.redraw();
  }

  private async list(folder: string): Promise<void> {
    try {
      const reply = await this.context.connection.request("files", { folder });
      this.folder = reply.folder;
      this.entries = reply.entries.filter((entry) => entry.kind === "folder" || this.kinds.includes(entry.kind));
      this.listed = true;
      this.error = "";
    } catch (error) {
      this.error = (error as Error).message;
    }
    this.context.redraw();
  }

  /// A file of this computer goes to the engine.
  private async send(): Promise<void> {
    const input = document.createElement("input");
    input.type = "file";
    input.dataset["testid"] = `${this.name}-input`;
    await new Promise<void>((resolve) => {
      input.onchange = input.oncancel = () => resolve();
      input.click();
    });
    const file = input.files?.[0];
    if (!file) return;
    const progress = (share: number) => {
      this.sending = share;
      this.context.redraw();
    };
    progress(0);
    try {
      const reply = await upload(file, file.name, progress);
      this.sent = file.name;
      this.choose({ upload: reply.upload });
    } catch (error) {
      this.context.notice("error", `${file.name}: ${(error as Error).message}`);
    }
    progress(-1);
  }

  private path(name: string): string {
    return this.folder === "" || this.folder.endsWith("/") ? `${this.folder}${name}` : `${this.folder}/${name}`;
  }

  template(): TemplateResult {
    return html`
      ${segmentsRow<"shape" | "file">({
        label: "From",
        testid: `${this.name}-from`,
        value: this.kind,
        choices: [
          { value: "shape", label: "Shape", title: "A generated shape" },
          { value: "file", label: "File", title: "A file below the folder that the program was given" },
        ],
        change: (kind) => this.setKind(kind),
      })}
      ${this.kind === "shape" ? this.shapes() : this.files()}`;
  }

  private shapes(): TemplateResult {
    const names = this.context.store.hello?.shapes ?? [];
    const value = this.source && "shape" in this.source ? this.source.shape : "";
    return selectRow({
      label: "Shape",
      testid: `${this.name}-shape`,
      value,
      choices: [{ value: "", label: "Choose…", disabled: true }, ...names.map((name) => ({ value: name, label: name }))],
      change: (shape) => this.choose({ shape }),
    });
  }

  private files(): TemplateResult {
    const rank = (entry: FileEntry) => (entry.kind === "folder" ? 0 : 1);
    const sorted = [...this.entries].sort((a, b) => rank(a) - rank(b) || a.name.localeCompare(b.name));
    const chosen = this.source && "file" in this.source ? this.source.file : "";
    return html`
      <p class="hint" data-testid="${this.name}-folder">${this.folder || "The folder that the program was given"}</p>
      ${this.error ? html`<p class="card" role="alert">${this.error}</p>` : nothing}
      <div class="actions" data-testid="${this.name}-files">
        ${this.folder ? this.entryButton("..", "Up", () => void this.list(this.path(".."))) : nothing}
        ${sorted.map((entry) =>
          entry.kind === "folder"
            ? this.entryButton(entry.name, `${entry.name}/`, () => void this.list(this.path(entry.name)))
            : this.entryButton(entry.name, entry.name, () => this.choose({ file: this.path(entry.name) }), this.path(entry.name) === chosen),
        )}
        ${button({
          label: this.sending < 0 ? "This computer…" : `Sending ${Math.round(100 * this.sending)} %`,
          testid: `${this.name}-upload`,
          title: "Send a file of this computer to the engine",
          disabled: this.sending >= 0,
          run: () => void this.send(),
        })}
      </div>`;
  }

  private entryButton(name: string, label: string, run: () => void, pressed?: boolean): TemplateResult {
    return button({ label, testid: `${this.name}-file-${name}`, ...(pressed === undefined ? {} : { pressed }), run });
  }
}
