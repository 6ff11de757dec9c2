// Three numbers in a row, x, y and z.
import { LitElement, css } from "lit";
import { customElement, property } from "lit/decorators.js";
import type { Vec3 } from "../../engine/protocol";
import { numberField } from "../../ui/controls";
import { base } from "../../ui/styles";

@customElement("psk-vector")
export class VectorField extends LitElement {
  static override styles = [
    base,
    css`
      :host {
        display: grid;
        grid-template-columns: repeat(3, minmax(0, 1fr));
        gap: 4px;
      }
    `,
  ];
  @property({ attribute: false }) value: Vec3 = [0, 0, 0];
  @property() label = "";
  @property() testid = "";
  @property({ type: Number }) step = 0;
  @property({ type: Number }) min = -Infinity;
  @property({ type: Boolean }) disabled = false;

  override render() {
    return ["x", "y", "z"].map((letter, axis) =>
      numberField({
        label: `${this.label} ${letter}`,
        testid: `${this.testid}-${letter}`,
        value: this.value[axis]!,
        step: this.step,
        min: this.min,
        disabled: this.disabled,
        input: (value) => this.tell("input", axis, value),
        change: (value) => this.tell("change", axis, value),
      }),
    );
  }

  private tell(kind: "input" | "change", axis: number, value: number): void {
    const detail = this.value.map((v, a) => (a === axis ? value : v)) as Vec3;
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }
}
