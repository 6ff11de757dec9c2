// Rows of controls as templates; components that use them have the style sheet of styles.ts.
import { html, nothing } from "lit";
import { live } from "lit/directives/live.js";
import type { TemplateResult } from "lit";
import { glyph } from "./icons";
import { styled } from "./styled";
import "./number_field";

interface Named {
  label: string;
  testid: string;
  title?: string; // says what it does, with the key
}

export interface ButtonSpec extends Named {
  icon?: string;
  primary?: boolean;
  pressed?: boolean;
  disabled?: boolean;
  run(): void;
}

export function button(spec: ButtonSpec): TemplateResult {
  return html`<button
    class="button ${spec.primary ? "primary" : ""}"
    data-testid=${spec.testid}
    title=${spec.title ?? spec.label}
    aria-pressed=${spec.pressed === undefined ? nothing : String(spec.pressed)}
    ?disabled=${spec.disabled}
    @click=${spec.run}
  >
    ${spec.icon ? glyph(spec.icon) : nothing}${spec.label}
  </button>`;
}

export function iconButton(spec: ButtonSpec & { icon: string }): TemplateResult {
  return html`<button
    class="icon"
    data-testid=${spec.testid}
    title=${spec.title ?? spec.label}
    aria-label=${spec.label}
    aria-pressed=${spec.pressed === undefined ? nothing : String(spec.pressed)}
    ?disabled=${spec.disabled}
    @click=${spec.run}
  >
    ${glyph(spec.icon)}
  </button>`;
}

export function switchRow(spec: Named & { value: boolean; change(value: boolean): void }): TemplateResult {
  return html`<div class="row wide" title=${spec.title ?? ""}>
    <span class="label" aria-hidden="true">${spec.label}</span>
    <button
      class="switch"
      role="switch"
      aria-label=${spec.label}
      aria-checked=${String(spec.value)}
      data-testid=${spec.testid}
      @click=${() => spec.change(!spec.value)}
    ></button>
  </div>`;
}

export interface Choice<T extends string> {
  value: T;
  label: string;
  title?: string;
  disabled?: boolean;
}

/// The arrow keys go from one to the next; only the chosen one is in the order of Tab.
function segmentKey<T extends string>(event: KeyboardEvent, choices: Choice<T>[], value: T, change: (value: T) => void): void {
  const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  event.stopPropagation();
  const open = choices.filter((choice) => !choice.disabled);
  const at = open.findIndex((choice) => choice.value === value);
  const next = open[(at + step + open.length) % open.length];
  if (!next) return;
  change(next.value);
  const group = event.currentTarget as HTMLElement;
  group.querySelector<HTMLElement>(`[data-value="${next.value}"]`)?.focus();
}

export function segments<T extends string>(spec: Named & { choices: Choice<T>[]; value: T; change(value: T): void }): TemplateResult {
  const key = (event: KeyboardEvent) => segmentKey(event, spec.choices, spec.value, spec.change);
  return html`<div class="segments" role="radiogroup" aria-label=${spec.label} data-testid=${spec.testid} @keydown=${key}>
    ${spec.choices.map(
      (choice) =>
        html`<button
          role="radio"
          aria-checked=${String(choice.value === spec.value)}
          tabindex=${choice.value === spec.value ? 0 : -1}
          data-value=${choice.value}
          data-testid="${spec.testid}-${choice.value}"
          title=${choice.title ?? choice.label}
          ?disabled=${choice.disabled}
          @click=${() => spec.change(choice.value)}
        >
          ${choice.label}
        </button>`,
    )}
  </div>`;
}

export function segmentsRow<T extends string>(spec: Parameters<typeof segments<T>>[0]): TemplateResult {
  return html`<div class="row" title=${spec.title ?? ""}><span class="label" aria-hidden="true">${spec.label}</span>${segments(spec)}</div>`;
}

export function selectRow<T extends string>(spec: Named & { choices: Choice<T>[]; value: T; change(value: T): void }): TemplateResult {
  const changed = (event: Event) => spec.change((event.target as HTMLSelectElement).value as T);
  return html`<label class="row" title=${spec.title ?? ""}>
    <span class="label">${spec.label}</span>
    <select aria-label=${spec.label} data-testid=${spec.testid} @change=${changed}>
      ${spec.choices.map(
        (choice) =>
          html`<option value=${choice.value} .selected=${live(choice.value === spec.value)} ?disabled=${choice.disabled}>${choice.label}</option>`,
      )}
    </select>
  </label>`;
}

export interface NumberSpec extends Named {
  value: number;
  min?: number;
  max?: number;
  step?: number;
  unit?: string;
  disabled?: boolean;
  input?(value: number): void; // while it moves
  change(value: number): void; // when it is settled
}

export function numberField(spec: NumberSpec): TemplateResult {
  return html`<psk-number
    .label=${spec.label}
    .value=${spec.value}
    .min=${spec.min ?? -Infinity}
    .max=${spec.max ?? Infinity}
    .step=${spec.step ?? 0}
    .unit=${spec.unit ?? ""}
    .testid=${spec.testid}
    .disabled=${spec.disabled ?? false}
    title=${spec.title ?? spec.label}
    @input=${(event: Event) => event instanceof CustomEvent && spec.input?.(event.detail as number)}
    @change=${(event: Event) => event instanceof CustomEvent && spec.change(event.detail as number)}
  ></psk-number>`;
}

export function numberRow(spec: NumberSpec): TemplateResult {
  return html`<div class="row" title=${spec.title ?? ""}><span class="label" aria-hidden="true">${spec.label}</span>${numberField(spec)}</div>`;
}

/// A slider alone, from min to max, which must be given.
export function slider(spec: NumberSpec & { text?: string }): TemplateResult {
  const [min, max] = [spec.min ?? 0, spec.max ?? 1];
  const share = max > min ? (Math.min(Math.max(spec.value, min), max) - min) / (max - min) : 0;
  const read = (event: Event) => Number((event.target as HTMLInputElement).value);
  return html`<input
    type="range"
    aria-label=${spec.label}
    aria-valuetext=${spec.text ?? nothing}
    data-testid=${spec.testid}
    title=${spec.title ?? spec.label}
    min=${min}
    max=${max}
    step=${spec.step || "any"}
    ?disabled=${spec.disabled}
    .value=${String(spec.value)}
    ${styled({ "--fill": `${(100 * share).toFixed(2)}%` })}
    @input=${(event: Event) => spec.input?.(read(event))}
    @change=${(event: Event) => spec.change(read(event))}
  />`;
}

/// A slider with the number beside it, which also takes numbers beyond the slider's ends up to hardMax.
export function sliderRow(spec: NumberSpec & { hardMax?: number }): TemplateResult {
  const number = { ...spec, max: spec.hardMax ?? spec.max, label: `${spec.label}, number`, testid: `${spec.testid}-number` };
  return html`<div class="row" title=${spec.title ?? ""}>
    <span class="label" aria-hidden="true">${spec.label}</span>
    <div class="slide">${slider(spec)}${numberField(number as NumberSpec)}</div>
  </div>`;
}

export function facts(rows: [string, unknown, string?][]): TemplateResult {
  return html`<dl class="facts">
    ${rows.map(([name, value, testid]) => html`<dt>${name}</dt><dd data-testid=${testid ?? nothing}>${value}</dd>`)}
  </dl>`;
}
