// Styles of all controls, shared by every component through one constructable style sheet.
import { css } from "lit";

export const base = css`
  :host {
    font: 13px/20px system-ui, sans-serif;
    font-variant-numeric: tabular-nums;
    color: var(--text);
  }
  * {
    box-sizing: border-box;
  }
  [hidden] {
    display: none !important;
  }
  :focus-visible {
    outline: 2px solid var(--focus);
    outline-offset: 1px;
  }
  h2,
  h3,
  p {
    margin: 0;
    font: inherit;
  }
  button,
  input,
  select {
    font: inherit;
    color: inherit;
    margin: 0;
  }
  .button {
    display: inline-flex;
    align-items: center;
    justify-content: center;
    gap: 6px;
    height: 28px;
    padding: 0 12px;
    border: 1px solid var(--line);
    border-radius: 5px;
    background: var(--raised);
    white-space: nowrap;
    cursor: default;
  }
  .button:hover:not(:disabled) {
    background: var(--hover);
  }
  .button:disabled,
  .icon:disabled {
    opacity: 0.42;
  }
  .button.primary {
    background: var(--blue-fill);
    border-color: var(--blue-fill);
    color: var(--on-fill);
  }
  .button.primary:hover:not(:disabled) {
    background: color-mix(in srgb, var(--blue-fill) 88%, white);
  }
  .button[aria-pressed="true"] {
    background: color-mix(in srgb, var(--blue) 26%, var(--panel));
    border-color: var(--blue);
  }
  .icon {
    display: inline-grid;
    place-items: center;
    width: 28px;
    height: 28px;
    padding: 0;
    border: 0;
    border-radius: 5px;
    background: none;
    color: var(--text-2);
    cursor: default;
  }
  .icon:hover:not(:disabled) {
    background: var(--hover);
    color: var(--text);
  }
  .icon[aria-pressed="true"],
  .icon[aria-checked="true"] {
    background: color-mix(in srgb, var(--blue) 30%, var(--bar));
    color: var(--text);
  }
  svg.glyph {
    width: 18px;
    height: 18px;
    fill: none;
    stroke: currentColor;
    stroke-width: 1.7;
    stroke-linecap: round;
    stroke-linejoin: round;
    display: block;
  }
  .row {
    display: grid;
    grid-template-columns: 96px minmax(0, 1fr);
    align-items: center;
    gap: 8px;
    min-height: 28px;
    margin: 4px 0;
  }
  .row > .label {
    color: var(--text-2);
    overflow: hidden;
    text-overflow: ellipsis;
    white-space: nowrap;
  }
  .row.wide {
    grid-template-columns: minmax(0, 1fr) auto;
  }
  .slide {
    display: grid;
    grid-template-columns: minmax(0, 1fr) 68px;
    gap: 8px;
    align-items: center;
  }
  .hint {
    color: var(--text-3);
    font-size: 12px;
    line-height: 16px;
  }
  .mono {
    font-variant-numeric: tabular-nums;
  }
  select,
  .text {
    width: 100%;
    height: 28px;
    padding: 0 8px;
    border: 1px solid var(--line);
    border-radius: 5px;
    background: var(--field);
    min-width: 0;
  }
  select {
    appearance: none;
    padding-right: 24px;
    background-image: linear-gradient(45deg, transparent 50%, var(--text-2) 50%), linear-gradient(-45deg, transparent 50%, var(--text-2) 50%);
    background-size: 5px 5px;
    background-position: right 13px center, right 8px center;
    background-repeat: no-repeat;
  }
  select option {
    background: var(--raised);
    color: var(--text);
  }
  select:hover,
  .text:hover {
    border-color: var(--line-strong);
  }
  input[type="range"] {
    appearance: none;
    width: 100%;
    height: 28px;
    margin: 0;
    background: none;
    border-radius: 4px;
  }
  input[type="range"]::-webkit-slider-runnable-track {
    height: 4px;
    border-radius: 2px;
    background: linear-gradient(to right, var(--blue) var(--fill, 0%), var(--line-strong) var(--fill, 0%));
  }
  input[type="range"]::-moz-range-track {
    height: 4px;
    border-radius: 2px;
    background: linear-gradient(to right, var(--blue) var(--fill, 0%), var(--line-strong) var(--fill, 0%));
  }
  input[type="range"]::-webkit-slider-thumb {
    appearance: none;
    width: 14px;
    height: 14px;
    margin-top: -5px;
    border-radius: 7px;
    border: 2px solid var(--panel);
    background: var(--text);
  }
  input[type="range"]::-moz-range-thumb {
    width: 10px;
    height: 10px;
    border-radius: 7px;
    border: 2px solid var(--panel);
    background: var(--text);
  }
  .switch {
    position: relative;
    width: 32px;
    height: 18px;
    padding: 0;
    border: 1px solid var(--line-strong);
    border-radius: 9px;
    background: var(--field);
    justify-self: end;
  }
  .switch::after {
    content: "";
    position: absolute;
    left: 2px;
    top: 2px;
    width: 12px;
    height: 12px;
    border-radius: 6px;
    background: var(--text-2);
  }
  .switch[aria-checked="true"] {
    background: var(--blue-fill);
    border-color: var(--blue-fill);
  }
  .switch[aria-checked="true"]::after {
    left: 16px;
    background: var(--on-fill);
  }
  .segments {
    display: flex;
    height: 28px;
    border: 1px solid var(--line);
    border-radius: 5px;
    background: var(--field);
    padding: 2px;
    gap: 2px;
    min-width: 0;
  }
  .segments button {
    flex: 1 1 auto;
    border: 0;
    border-radius: 3px;
    background: none;
    color: var(--text-2);
    padding: 0 8px;
    line-height: 20px;
    min-width: 0;
    white-space: nowrap;
    cursor: default;
  }
  .segments button:hover:not(:disabled) {
    color: var(--text);
  }
  .segments button:disabled {
    opacity: 0.42;
  }
  .segments button[aria-checked="true"] {
    background: color-mix(in srgb, var(--blue) 30%, var(--panel));
    color: var(--text);
  }
  .facts {
    display: grid;
    grid-template-columns: auto 1fr;
    gap: 2px 12px;
    margin: 4px 0;
  }
  .facts dt {
    color: var(--text-2);
  }
  .facts dd {
    margin: 0;
    text-align: right;
    overflow-wrap: anywhere;
  }
  .actions {
    display: flex;
    flex-wrap: wrap;
    gap: 8px;
    margin: 8px 0 4px;
  }
  .card {
    border: 1px solid var(--line);
    border-left: 3px solid var(--orange);
    border-radius: 5px;
    background: var(--raised);
    padding: 8px 12px;
    margin: 8px 0;
  }
  .unseen {
    position: absolute;
    width: 1px;
    height: 1px;
    overflow: hidden;
    clip-path: inset(50%);
    white-space: nowrap;
  }
  kbd {
    font: inherit;
    font-size: 11px;
    line-height: 16px;
    padding: 0 5px;
    border: 1px solid var(--line);
    border-radius: 4px;
    color: var(--text-2);
    background: var(--field);
  }
  ::-webkit-scrollbar {
    width: 10px;
    height: 10px;
  }
  ::-webkit-scrollbar-thumb {
    background: color-mix(in srgb, var(--line-strong) 55%, transparent);
    border-radius: 5px;
    border: 2px solid transparent;
    background-clip: padding-box;
  }
`;
