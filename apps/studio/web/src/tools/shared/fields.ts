// Rows that the settings of several tools have.
import { type TemplateResult, html, nothing } from "lit";
import type { Vec3 } from "../../engine/protocol";
import { button } from "../../ui/controls";
import { count } from "../../ui/format";
import "./vector_field";

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
  input?(value: Vec3): void; // while it moves
  change(value: Vec3): void;
}

/// Three numbers in a row, x, y and z.
export function vectorRow(spec: VectorSpec): TemplateResult {
  return html`<div class="row" title=${spec.title ?? ""}>
    <span class="label" aria-hidden="true">${spec.label}</span>
    <psk-vector
      .label=${spec.label}
      .testid=${spec.testid}
      .value=${spec.value}
      .step=${spec.step ?? 0}
      .min=${spec.min ?? -Infinity}
      @input=${(event: Event) => event instanceof CustomEvent && spec.input?.(event.detail as Vec3)}
      @change=${(event: Event) => event instanceof CustomEvent && spec.change(event.detail as Vec3)}
    ></psk-vector>
  </div>`;
}

/// A row of buttons.
export function actions(...buttons: (TemplateResult | typeof nothing)[]): TemplateResult {
  return html`<div class="actions">${buttons}</div>`;
}

/// 1204 -> "1,204 points", 1 -> "1 point".
export function countOf(n: number, thing: string): string {
  return `${count(n)} ${thing}${n === 1 ? "" : "s"}`;
}
