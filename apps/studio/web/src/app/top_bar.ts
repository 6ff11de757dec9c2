// The bar at the top: the scene's name, files, undo, what is shown, theme, palette.
import { css, html, nothing } from "lit";
import { customElement } from "lit/decorators.js";
import { iconButton, segments } from "../ui/controls";
import { glyph, icons } from "../ui/icons";
import { base } from "../ui/styles";
import { Part } from "./context";
import { currentTheme } from "./theme";

@customElement("psk-top-bar")
export class TopBar extends Part {
  static override styles = [
    base,
    css`
      :host {
        display: flex;
        align-items: center;
        gap: 4px;
        padding: 0 8px;
        background: var(--bar);
        border-bottom: 1px solid var(--line);
      }
      .mark {
        width: 28px;
        height: 28px;
        padding: 4px;
        flex: none;
      }
      .name {
        margin: 0;
        font: inherit;
        min-width: 0;
        overflow: hidden;
        text-overflow: ellipsis;
        white-space: nowrap;
        padding: 0 8px;
        max-width: 28ch;
      }
      .name small {
        color: var(--text-3);
        font-size: 12px;
        padding-left: 8px;
      }
      .gap {
        flex: 1 1 auto;
      }
      .line {
        width: 1px;
        height: 20px;
        background: var(--line);
        margin: 0 4px;
        flex: none;
      }
      .segments {
        min-width: 176px;
      }
      .find {
        color: var(--text-2);
        padding: 0 8px;
        background: var(--field);
      }
      svg.glyph {
        flex: none;
      }
      @media (max-width: 1000px) {
        .find span {
          display: none;
        }
      }
    `,
  ];

  override render() {
    return html`
      <img class="mark" src="assets/icon.svg" alt="" />
      ${this.command("open", icons.open)} ${this.command("save", icons.save)} ${this.command("picture", icons.camera)}
      <span class="line"></span>
      ${this.command("undo", icons.undo)} ${this.command("redo", icons.redo)}
      <span class="line"></span>
      ${this.name()}
      <span class="gap"></span>
      ${this.views()}
      <span class="line"></span>
      ${this.find()} ${this.theme()}
    `;
  }

  private command(id: string, icon: string) {
    const command = this.context.commands.get(id);
    if (!command) return nothing;
    return iconButton({
      label: command.title.replace("…", ""),
      testid: id,
      icon,
      title: command.key ? `${command.title} (${command.key})` : command.title,
      disabled: command.enabled?.() === false,
      run: () => this.context.run(id),
    });
  }

  private name() {
    const clouds = this.store.scene?.clouds ?? [];
    const first = clouds[0]?.name ?? "No scene";
    const more = clouds.length > 1 ? html`<small>+ ${clouds.length - 1}</small>` : nothing;
    return html`<h1 class="name" data-testid="scene-name" title=${clouds.map((c) => c.name).join(", ") || first}>${first}${more}</h1>`;
  }

  private views() {
    const { view } = this.store;
    return html`
      ${segments({
        label: "What is shown",
        testid: "show",
        value: view.show,
        choices: [
          { value: "points", label: "Points", title: "Points alone (Shift+1)" },
          { value: "mesh", label: "Surface", title: "The surface alone (Shift+2)" },
          { value: "both", label: "Both", title: "Points and surface (Shift+3)" },
        ],
        change: (show) => this.store.setView({ show }),
      })}
      ${this.toggle("wireframe", "Wireframe (Shift+W)", icons.wire, view.wireframe)}
      ${this.toggle("grid", "Ground grid (Shift+G)", icons.grid, view.grid)} ${this.command("frame", icons.frame)}
    `;
  }

  private toggle(id: string, title: string, icon: string, pressed: boolean) {
    return iconButton({ label: title, testid: `toggle-${id}`, title, icon, pressed, run: () => this.context.run(id) });
  }

  private find() {
    return html`<button
      class="button find"
      data-testid="open-palette"
      title="All commands (Ctrl+K)"
      @click=${() => this.context.openPalette()}
    >
      ${glyph(icons.search)}<span>Commands</span><kbd>Ctrl K</kbd>
    </button>`;
  }

  private theme() {
    const dark = currentTheme() === "dark";
    return iconButton({
      label: dark ? "Light theme" : "Dark theme",
      testid: "theme",
      title: `${dark ? "Light" : "Dark"} theme (Ctrl+Alt+T)`,
      icon: dark ? icons.sun : icons.moon,
      run: () => this.context.run("theme"),
    });
  }
}
