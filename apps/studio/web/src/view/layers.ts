// Decoded arrays as objects of three.js, without copying: 16-bit positions are normalised attributes, and the box is
// the object's matrix. three.js multiplies matrices in double precision before the GPU gets them, so that world
// coordinates of any size are drawn without jitter.
import * as THREE from "three";
import type { Decoded } from "../engine/blob";
import { kTints } from "./colours";
import { pointsFragment, pointsVertex, surfaceFragment, surfaceVertex } from "./shaders";

export function rgb(hex: string): THREE.Vector3 {
  const n = parseInt(hex.slice(1), 16);
  return new THREE.Vector3((n >> 16) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255);
}

function tintUniform(): THREE.Vector3[] {
  return Array.from({ length: 8 }, (_, i) => rgb(kTints[i] ?? "#8a8f98"));
}

function attribute(array: THREE.TypedArray, items: number, normalised: boolean): THREE.BufferAttribute {
  return new THREE.BufferAttribute(array, items, normalised);
}

/// Around the unit cube in which positions are.
export const kUnitSphere = new THREE.Sphere(new THREE.Vector3(0.5, 0.5, 0.5), Math.sqrt(0.75));

/// Geometry of a decoded blob. Its bounding sphere is the box's, in the box's own unit cube.
export function geometryOf(decoded: Decoded): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", attribute(decoded.positions, 4, true));
  if (decoded.normals) geometry.setAttribute("oct", attribute(decoded.normals, decoded.normalStride, true));
  if (decoded.colors) geometry.setAttribute("tone", attribute(decoded.colors, 4, true));
  if (decoded.tint) geometry.setAttribute("tint", attribute(decoded.tint, decoded.tintStride, false));
  const density = decoded.values["density"];
  if (density) geometry.setAttribute("density", attribute(density, 1, false));
  if (decoded.index) geometry.setIndex(attribute(decoded.index, 1, false));
  geometry.boundingSphere = kUnitSphere;
  geometry.boundingBox = new THREE.Box3(new THREE.Vector3(0, 0, 0), new THREE.Vector3(1, 1, 1));
  return geometry;
}

/// Lays the unit cube of the geometry over the box.
export function place(object: THREE.Object3D, decoded: Decoded): void {
  const { lower, upper } = decoded.box;
  const size = lower.map((value, i) => Math.max(upper[i]! - value, 1e-30)) as [number, number, number];
  object.position.set(...lower);
  object.scale.set(...size);
  object.updateMatrix();
  object.updateMatrixWorld(true);
}

export function surfaceMaterial(): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexShader: surfaceVertex,
    fragmentShader: surfaceFragment,
    side: THREE.DoubleSide,
    clipping: true,
    toneMapped: false,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    uniforms: {
      front: { value: rgb("#cfccc6") },
      back: { value: rgb("#6d86b8") },
      cut: { value: rgb("#4d6ea6") },
      tints: { value: tintUniform() },
      mode: { value: 0 },
      range: { value: new THREE.Vector2(0, 1) },
      trimDensity: { value: -1 },
      hasNormals: { value: true },
      hasTint: { value: false },
      sectioned: { value: false },
      opacity: { value: 1 },
    },
  });
}

export function pointsMaterial(colour: string): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexShader: pointsVertex,
    fragmentShader: pointsFragment,
    clipping: true,
    toneMapped: false,
    uniforms: {
      plain: { value: rgb(colour) },
      tints: { value: tintUniform() },
      mode: { value: 0 },
      range: { value: new THREE.Vector2(0, 1) },
      size: { value: 2 },
      reference: { value: 1 },
      hasNormals: { value: true },
      opacity: { value: 1 },
    },
  });
}

/// Puts the named values under `value`; "" takes them away.
export function showValues(geometry: THREE.BufferGeometry, decoded: Decoded, name: string): void {
  const values = decoded.values[name];
  if (values) geometry.setAttribute("value", attribute(values, 1, false));
  else geometry.deleteAttribute("value");
}
