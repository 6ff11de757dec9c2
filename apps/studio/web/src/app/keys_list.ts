// All keys by group, and what the mouse and fingers do.
import { css, html } from "lit";
import { customElement } from "lit/decorators.js";
import { base } from "../ui/styles";
import { Part } from "./context";

const kHands: [string, string][] = [
  ["Drag", "turn about the point under the cursor"],
  ["Shift+drag, middle or right drag", "move"],
  ["Wheel, pinch", "nearer to the cursor, or farther"],
  ["Double click", "set the centre"],
  ["Space held", "move the view in any tool"],
];

@customElement("psk-keys-list")
export class KeysList extends Part {
  static override styles = [
    base,
    css`
      :host {
        display: block;
        padding: 8px 16px 16px;
        overflow-y: auto;
        columns: 2;
        column-gap: 24px;
      }
      section {
        break-inside: avoid;
        margin-bottom: 12px;
      }
      h3 {
        font-weight: 600;
        line-height: 28px;
      }
      div {
        display: flex;
        justify-content: space-between;
        gap: 12px;
        line-height: 24px;
      }
      kbd {
        align-self: center;
        white-space: nowrap;
      }
      .hands div {
        display: block;
        line-height: 16px;
        padding: 4px 0;
      }
    `,
  ];

  override render() {
    const commands = this.context.commands.search("").filter((command) => command.key);
    const groups = [...new Set(commands.map((command) => command.group ?? ""))];
    return html`<section class="hands">
        <h3>Mouse and fingers</h3>
        ${kHands.map(([hand, what]) => html`<div>${hand}: <span class="hint">${what}</span></div>`)}
      </section>
      ${groups.map(
        (group) =>
          html`<section>
            <h3>${group}</h3>
            ${commands.filter((c) => (c.group ?? "") === group).map((c) => html`<div>${c.title.replace("…", "")}<kbd>${c.key}</kbd></div>`)}
          </section>`,
      )}`;
  }
}
