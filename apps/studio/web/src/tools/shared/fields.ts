// Rows that the settings of several tools have.
import { type TemplateResult, html, nothing } from "lit";
import type { Vec3 } from "../../engine/protocol";
import { button, numberField } from "../../ui/controls";

/// A sentence below the controls. Warnings are read out as they come.
export function note(text: string, testid: string, warning = false): TemplateResult {
  return html`<p class=${warning ? "card" : "hint"} role=${warning ? "alert" : "status"} data-testid=${testid}>${text}</p>`;
}

/// Enter and Esc as buttons.
export function applyBar(spec: {
  ready: boolean;
  busy: boolean;
  label?: string;
  apply(): void;
  drop(): void;
}): TemplateResult {
  return html`<div class="actions">
    ${button({
      label: spec.busy ? "Working…" : (spec.label ?? "Apply"),
      testid: "tool-apply",
      title: "Apply (Enter)",
      primary: true,
      disabled: !spec.ready || spec.busy,
      run: spec.apply,
    })}
    ${button({ label: "Drop", testid: "tool-drop", title: "Drop (Esc)", disabled: !spec.ready || spec.busy, run: spec.drop })}
  </div>`;
}

export interface VectorSpec {
  label: string;
  testid: string;
  title?: string;
  value: Vec3;
  step?: number;
  min?: number;
  unit?: string;
  disabled?: boolean;
  input?(value: Vec3): void; // while it moves
  change(value: Vec3): void;
}

/// Three numbers in a row, x, y and z.
export function vectorRow(spec: VectorSpec): TemplateResult {
  const with_ = (axis: number, value: number) => spec.value.map((v, a) => (a === axis ? value : v)) as Vec3;
  const { input } = spec;
  return html`<div class="row" title=${spec.title ?? ""}>
    <span class="label" aria-hidden="true">${spec.label}</span>
    <div class="segments vector">
      ${["x", "y", "z"].map((letter, axis) =>
        numberField({
          label: `${spec.label} ${letter}`,
          testid: `${spec.testid}-${letter}`,
          value: spec.value[axis]!,
          ...(spec.step === undefined ? {} : { step: spec.step }),
          ...(spec.min === undefined ? {} : { min: spec.min }),
          disabled: spec.disabled ?? false,
          ...(input ? { input: (value: number) => input(with_(axis, value)) } : {}),
          change: (value) => spec.change(with_(axis, value)),
        }),
      )}
    </div>
  </div>`;
}

/// A row of buttons.
export function actions(...buttons: (TemplateResult | typeof nothing)[]): TemplateResult {
  return html`<div class="actions">${buttons}</div>`;
}

/// 1204 -> "1,204 points", 1 -> "1 point".
export function countOf(n: number, thing: string): string {
  return `${String(n).replace(/\B(?=(\d{3})+(?!\d))/g, ",")} ${thing}${n === 1 ? "" : "s"}`;
}
