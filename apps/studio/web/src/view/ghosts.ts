// Points that an operation would add, orange with their normals, and those it would take away, blue and larger. Where
// every point has a class, that of a set operation: kept ones are light, those turned round orange, dropped ones blue.
import * as THREE from "three";
import type { Decoded } from "../engine/blob";
import { geometryOf, kUnitSphere, place, pointsMaterial, rgb } from "./layers";
import { spikesFragment, spikesVertex } from "./shaders";

const kAdded = "#f0954e";
const kRemoved = "#4aa3ea";
const kKept = "#d3d8df";
const kMostSpikes = 20000;

/// Every point twice, so that a line goes from it along its normal; a subsample where there are many.
function spikesOf(decoded: Decoded, material: THREE.ShaderMaterial): THREE.LineSegments {
  const step = Math.ceil(decoded.vertices / kMostSpikes);
  const count = Math.floor(decoded.vertices / step);
  const positions = new Uint16Array(count * 8);
  const oct = new Uint8Array(count * 4);
  const end = new Float32Array(count * 2);
  for (let k = 0; k < count; ++k) {
    const i = k * step;
    const p = decoded.positions.subarray(4 * i, 4 * i + 4);
    positions.set(p, 8 * k);
    positions.set(p, 8 * k + 4);
    const n = decoded.normals!.subarray(decoded.normalStride * i, decoded.normalStride * i + 2);
    oct.set(n, 4 * k);
    oct.set(n, 4 * k + 2);
    end[2 * k + 1] = 1;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 4, true));
  geometry.setAttribute("oct", new THREE.BufferAttribute(oct, 2, true));
  geometry.setAttribute("end", new THREE.BufferAttribute(end, 1));
  geometry.boundingSphere = kUnitSphere;
  return new THREE.LineSegments(geometry, material);
}

/// The same points seen through the surface, faintly: most of what guides a surface lies inside of it.
function throughSurface(material: THREE.ShaderMaterial): THREE.ShaderMaterial {
  const veiled = material.clone();
  veiled.uniforms = { ...material.uniforms, opacity: { value: 0.4 } };
  veiled.transparent = true;
  veiled.depthTest = false;
  veiled.depthWrite = false;
  return veiled;
}

export class GhostLayer {
  readonly group = new THREE.Group();
  private readonly added = pointsMaterial(kAdded);
  private readonly removed = pointsMaterial(kRemoved);
  private readonly kept = pointsMaterial(kKept);
  private readonly dropped = pointsMaterial(kRemoved); // fainter: what is left is behind them
  private readonly spikes = new THREE.ShaderMaterial({
    vertexShader: spikesVertex,
    fragmentShader: spikesFragment,
    transparent: true,
    depthWrite: false,
    uniforms: { plain: { value: rgb(kAdded) }, spike: { value: 0 } },
  });

  private readonly veiled = new Map([this.added, this.removed].map((material) => [material, throughSurface(material)]));

  constructor() {
    for (const material of [this.added, this.removed, this.kept, this.dropped]) {
      material.polygonOffset = true;
      material.polygonOffsetUnits = -4;
    }
    this.dropped.transparent = true;
    this.dropped.depthWrite = false;
    this.dropped.uniforms["opacity"]!.value = 0.25;
  }

  /// @returns whether this changes the picture
  set(added: Decoded | null, removed: Decoded | null): boolean {
    const before = this.group.children.length;
    for (const child of this.group.children) (child as THREE.Points).geometry.dispose();
    this.group.clear();
    if (added?.tint) this.showClasses(added, added.tint);
    else if (added) this.show(added, this.added);
    if (removed) this.show(removed, this.removed);
    return before > 0 || this.group.children.length > 0;
  }

  /// Sizes: points in pixels at the centre, normals as a share of the scene.
  setReference(distance: number, pixelRatio: number, radius: number): void {
    for (const material of [this.added, this.removed, this.kept, this.dropped]) {
      material.uniforms["reference"]!.value = distance;
      material.uniforms["size"]!.value = (material === this.kept || material === this.dropped ? 2.5 : 4.5) * pixelRatio;
    }
    this.spikes.uniforms["spike"]!.value = Math.min(0.02 * radius, 0.02 * distance);
  }

  private show(decoded: Decoded, material: THREE.ShaderMaterial): void {
    if (decoded.vertices === 0) return;
    material.uniforms["hasNormals"]!.value = false; // plain colours are told apart more easily than shaded ones
    const points = new THREE.Points(geometryOf(decoded), material);
    const objects: THREE.Object3D[] = [points];
    const veiled = this.veiled.get(material);
    if (veiled) objects.push(new THREE.Points(points.geometry, veiled));
    if (decoded.normals && material === this.added) objects.push(spikesOf(decoded, this.spikes));
    for (const object of objects) {
      object.frustumCulled = false;
      object.renderOrder = 3;
      place(object, decoded);
      this.group.add(object);
    }
  }

  /// Classes as the engine counts them: 0 kept, 1 turned round, 2 dropped.
  private showClasses(decoded: Decoded, classes: Uint8Array): void {
    const whole = geometryOf(decoded);
    [this.kept, this.added, this.dropped].forEach((material, wanted) => {
      const indices: number[] = [];
      for (let i = 0; i < decoded.vertices; ++i) if (classes[decoded.tintStride * i] === wanted) indices.push(i);
      if (indices.length === 0) return;
      material.uniforms["hasNormals"]!.value = false;
      const geometry = new THREE.BufferGeometry();
      for (const [name, values] of Object.entries(whole.attributes)) geometry.setAttribute(name, values);
      geometry.setIndex(indices);
      const points = new THREE.Points(geometry, material);
      points.frustumCulled = false;
      points.renderOrder = 3;
      place(points, decoded);
      this.group.add(points);
    });
  }
}
