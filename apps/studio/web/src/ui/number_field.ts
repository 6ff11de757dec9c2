// A number that is typed, dragged sideways, or stepped by the arrow keys (Shift: ten steps, Alt: a tenth).
import { LitElement, css, html } from "lit";
import { customElement, property, query, state } from "lit/decorators.js";
import { live } from "lit/directives/live.js";
import { base } from "./styles";

export interface NumberRange {
  min: number;
  max: number;
  step: number; // 0: any
}

/// The nearest allowed number. Without the noise of sums: 0.1 + 0.2 with step 0.1 is 0.3.
export function clampNumber(value: number, { min, max, step }: NumberRange): number {
  const limited = Math.min(Math.max(value, min), max);
  if (step <= 0) return limited;
  const origin = Number.isFinite(min) ? min : 0;
  const snapped = origin + Math.round((limited - origin) / step) * step;
  return Math.min(Math.max(Number(snapped.toPrecision(12)), min), max);
}

/// What was typed, or null: a decimal comma, spaces and simple products as "2*3" or "1/4" are understood.
export function parseNumber(text: string): number | null {
  const clean = text.trim().replace(/\s/g, "").replace(",", ".").replace("−", "-");
  const match = /^([-+]?[\d.]+(?:e[-+]?\d+)?)(?:([*/])([-+]?[\d.]+(?:e[-+]?\d+)?))?/i.exec(clean);
  if (!match || !match[1]) return null;
  const first = Number(match[1]);
  const second = match[3] === undefined ? 1 : Number(match[3]);
  const value = match[2] === "/" ? first / second : first * second;
  return Number.isFinite(value) ? value : null;
}

/// The number after dragging so many pixels: a step for four pixels; without a step one percent for two.
export function dragNumber(start: number, pixels: number, range: NumberRange, fine: boolean): number {
  const slow = fine ? 0.1 : 1;
  const unit = range.step > 0 ? range.step / 4 : Math.max(Math.abs(start), 1e-6) / 200;
  return clampNumber(start + pixels * unit * slow, range);
}

export function showNumber(value: number): string {
  if (!Number.isFinite(value)) return "";
  return String(Number(value.toPrecision(6)));
}

const kDigitWidth = 8; // CSS pixels of a figure at 13 px

/// As many digits as fit in so many characters; more are seen once the field has the focus.
export function fitNumber(value: number, characters: number): string {
  for (let digits = 6; digits > 1; digits--) {
    const text = String(Number(value.toPrecision(digits)));
    if (text.length <= characters || digits === 2) return Number.isFinite(value) ? text : "";
  }
  return "";
}

@customElement("psk-number")
export class NumberField extends LitElement {
  static override styles = [
    base,
    css`
      :host {
        display: block;
        min-width: 0;
      }
      .field {
        display: flex;
        align-items: center;
        height: 28px;
        border: 1px solid var(--line);
        border-radius: 5px;
        background: var(--field);
        padding: 0 6px;
      }
      .field:hover {
        border-color: var(--line-strong);
      }
      .field:focus-within {
        outline: 2px solid var(--focus);
        outline-offset: 1px;
      }
      input {
        flex: 1 1 0;
        width: 0;
        min-width: 0;
        border: 0;
        padding: 0;
        background: none;
        outline: none;
        text-align: right;
        cursor: ew-resize;
      }
      input:focus {
        cursor: text;
      }
      .unit {
        color: var(--text-3);
        padding-left: 4px;
      }
    `,
  ];
  @property({ type: Number }) value = 0;
  @property({ type: Number }) min = -Infinity;
  @property({ type: Number }) max = Infinity;
  @property({ type: Number }) step = 0;
  @property() label = "";
  @property() unit = "";
  @property({ type: Boolean }) disabled = false;
  @property() testid = "";
  @state() private typed: string | null = null;
  @query("input") private input!: HTMLInputElement;
  private drag: { x: number; value: number; moved: boolean } | null = null;

  override render() {
    return html`<div class="field" title=${this.label}>
      <input
        type="text"
        inputmode="decimal"
        role="spinbutton"
        autocomplete="off"
        aria-label=${this.label}
        aria-valuenow=${this.value}
        data-testid=${this.testid}
        ?disabled=${this.disabled}
        .value=${live(this.typed ?? this.shown())}
        @focus=${() => this.requestUpdate()}
        @input=${() => (this.typed = this.input.value)}
        @change=${() => this.take()}
        @blur=${() => {
          this.take();
          this.requestUpdate();
        }}
        @keydown=${(event: KeyboardEvent) => this.key(event)}
        @pointerdown=${(event: PointerEvent) => this.down(event)}
        @pointermove=${(event: PointerEvent) => this.move(event)}
        @pointerup=${() => this.up()}
        @pointercancel=${() => this.up()}
      />${this.unit ? html`<span class="unit" aria-hidden="true">${this.unit}</span>` : null}
    </div>`;
  }

  protected override firstUpdated(): void {
    this.requestUpdate(); // only now there is a width
  }

  /// All digits while one types, else as many as fit.
  private shown(): string {
    const width = this.input?.clientWidth ?? 0;
    const focused = this.shadowRoot?.activeElement === this.input;
    return focused || width === 0 ? showNumber(this.value) : fitNumber(this.value, Math.floor(width / kDigitWidth));
  }

  private get range(): NumberRange {
    return { min: this.min, max: this.max, step: this.step };
  }

  /// "input" while it moves, "change" when it is settled; detail is the number.
  private set(value: number, settled: boolean): void {
    const before = this.value;
    this.value = value;
    if (before !== value || settled) {
      this.dispatchEvent(new CustomEvent(settled ? "change" : "input", { detail: value }));
    }
  }

  private take(): void {
    if (this.typed === null) return;
    const value = parseNumber(this.typed);
    this.typed = null;
    this.input.value = this.shown();
    if (value !== null) this.set(clampNumber(value, { ...this.range, step: 0 }), true);
  }

  private key(event: KeyboardEvent): void {
    event.stopPropagation(); // typing is no shortcut
    if (event.key === "Enter") {
      this.take();
      this.input.select();
    } else if (event.key === "Escape") {
      this.typed = null;
      this.input.value = showNumber(this.value);
      this.input.blur();
    } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      event.preventDefault();
      this.take();
      const unit = this.step || Math.max(Math.abs(this.value), 1e-6) / 100;
      const size = unit * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
      const range = event.altKey ? { ...this.range, step: 0 } : this.range;
      this.set(clampNumber(this.value + (event.key === "ArrowUp" ? size : -size), range), true);
    }
  }

  private down(event: PointerEvent): void {
    if (this.disabled || event.button !== 0 || this.shadowRoot?.activeElement === this.input) return;
    event.preventDefault(); // a click without moving gives the focus, in up()
    this.input.setPointerCapture(event.pointerId);
    this.drag = { x: event.clientX, value: this.value, moved: false };
  }

  private move(event: PointerEvent): void {
    if (!this.drag) return;
    const pixels = event.clientX - this.drag.x;
    if (Math.abs(pixels) > 2) this.drag.moved = true;
    if (this.drag.moved) this.set(dragNumber(this.drag.value, pixels, this.range, event.shiftKey), false);
  }

  private up(): void {
    const drag = this.drag;
    this.drag = null;
    if (!drag) return;
    if (drag.moved) return this.set(this.value, true);
    this.input.focus();
    this.input.select();
  }
}
