// The ground: lines a round number of world units apart, fading out from below the scene.
import * as THREE from "three";
import type { Box } from "../engine/protocol";
import { centreOf, radiusOf } from "./camera";
import type { UpAxis } from "./camera";

const kHalf = 12; // lines on each side

/// 1, 2 or 5 times a power of ten, at least `value`.
export function roundUp(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const factor = [1, 2, 5, 10].find((f) => f * power >= value * (1 - 1e-12)) ?? 10;
  return factor * power;
}

function lineGeometry(): THREE.BufferGeometry {
  const positions: number[] = [];
  for (let i = -kHalf; i <= kHalf; ++i) {
    // In pieces, so that the fading by distance has vertices to work with.
    for (let j = -kHalf; j < kHalf; ++j) positions.push(i, j, i, j + 1, j, i, j + 1, i);
  }
  const flat = new Float32Array((positions.length / 2) * 3);
  for (let k = 0; k < positions.length / 2; ++k) {
    flat[3 * k] = positions[2 * k]!;
    flat[3 * k + 1] = positions[2 * k + 1]!;
  }
  return new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(flat, 3));
}

export class GridLayer {
  readonly group = new THREE.Group();
  private readonly material = new THREE.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: { colour: { value: new THREE.Vector3(0.5, 0.5, 0.5) } },
    vertexShader: `varying float fade;
      void main() { fade = 1.0 - smoothstep(0.12, 0.85, length(position.xy) / ${kHalf}.0);
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `uniform vec3 colour; varying float fade;
      void main() { gl_FragColor = vec4(colour, 0.26 * fade); }`,
  });
  private readonly lines = new THREE.LineSegments(lineGeometry(), this.material);

  constructor() {
    this.lines.frustumCulled = false;
    this.lines.renderOrder = -1;
    this.group.add(this.lines);
  }

  place(box: Box, up: UpAxis): void {
    const step = roundUp(radiusOf(box) / 5);
    const centre = centreOf(box);
    const snap = (value: number) => Math.round(value / step) * step;
    const gap = 0.004 * radiusOf(box); // so that a flat base does not flicker with it
    if (up === "y") {
      this.lines.position.set(snap(centre[0]), box.lower[1] - gap, snap(centre[2]));
      this.lines.rotation.set(Math.PI / 2, 0, 0);
    } else {
      this.lines.position.set(snap(centre[0]), snap(centre[1]), box.lower[2] - gap);
      this.lines.rotation.set(0, 0, 0);
    }
    this.lines.scale.setScalar(step);
    this.lines.updateMatrixWorld(true);
  }

  setTheme(colour: string): void {
    const n = parseInt(colour.slice(1), 16);
    (this.material.uniforms["colour"]!.value as THREE.Vector3).set((n >> 16) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255);
  }
}
