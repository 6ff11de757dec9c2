// Where the bars and the view are.
import { css } from "lit";

export const frameStyles = css`
  :host {
    display: grid;
    height: 100%;
    grid-template:
      "top top top" 40px
      "tools view side" minmax(0, 1fr)
      "time time side" auto
      "status status status" 28px / 44px minmax(0, 1fr) 320px;
    user-select: none;
    -webkit-user-select: none;
  }
  psk-top-bar {
    grid-area: top;
  }
  psk-tool-bar {
    grid-area: tools;
  }
  psk-side {
    grid-area: side;
    min-height: 0;
  }
  psk-timeline {
    grid-area: time;
  }
  psk-status-bar {
    grid-area: status;
  }
  main {
    grid-area: view;
    position: relative;
    overflow: hidden;
    background: linear-gradient(var(--ground-top), var(--ground-bottom));
  }
  canvas,
  .overlay {
    position: absolute;
    inset: 0;
    width: 100%;
    height: 100%;
    display: block;
  }
  canvas {
    touch-action: none;
    outline: none;
  }
  canvas:focus-visible {
    outline: 1px solid var(--blue);
    outline-offset: -1px;
  }
  canvas:not([data-tool="navigate"]) {
    cursor: crosshair;
  }
  canvas[data-drag] {
    cursor: grabbing;
  }
  .overlay {
    pointer-events: none;
  }
  .banner {
    position: absolute;
    top: 12px;
    left: 50%;
    transform: translateX(-50%);
    max-width: 80%;
    padding: 6px 16px;
    border-radius: 5px;
    background: var(--orange-fill);
    color: var(--on-fill);
    box-shadow: var(--shadow);
  }
  @media (max-width: 900px) {
    :host {
      grid-template-columns: 44px minmax(0, 1fr) 264px;
    }
  }
`;
