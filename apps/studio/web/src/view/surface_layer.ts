// The mesh: clay or measured values, tint, wireframe, and the trim's threshold.
import * as THREE from "three";
import type { Decoded } from "../engine/blob";
import type { ViewSettings } from "../engine/store";
import { geometryOf, place, rgb, showValues, surfaceMaterial } from "./layers";

export class SurfaceLayer {
  readonly group = new THREE.Group();
  decoded: Decoded | null = null;
  private readonly material = surfaceMaterial();
  private readonly lineMaterial = new THREE.LineBasicMaterial({ color: 0x1b2430, transparent: true, opacity: 0.35 });
  private readonly prepared = new WeakMap<Decoded, THREE.BufferGeometry>();
  private mesh: THREE.Mesh | null = null;
  private lines: THREE.LineSegments | null = null;
  private settings: ViewSettings | null = null;

  /// The geometry that set() will show for this blob.
  prepare(decoded: Decoded): THREE.BufferGeometry {
    const known = this.prepared.get(decoded) ?? geometryOf(decoded);
    this.prepared.set(decoded, known);
    return known;
  }

  set(decoded: Decoded | null): void {
    const old = this.mesh;
    this.dropLines();
    this.decoded = decoded;
    this.mesh = null;
    this.group.clear();
    if (decoded && decoded.triangles > 0) {
      this.mesh = new THREE.Mesh(this.prepare(decoded), this.material);
      this.mesh.frustumCulled = false;
      place(this.mesh, decoded);
      this.group.add(this.mesh);
    }
    this.material.uniforms["hasNormals"]!.value = !!decoded?.normals;
    this.material.uniforms["hasTint"]!.value = !!decoded?.tint;
    if (this.settings) this.apply(this.settings);
    old?.geometry.dispose();
  }

  setTint(classes: Uint8Array | null): void {
    const tint = classes ?? this.decoded?.tint ?? null;
    const stride = classes ? 1 : (this.decoded?.tintStride ?? 1);
    this.material.uniforms["hasTint"]!.value = !!tint;
    if (this.mesh && tint) this.mesh.geometry.setAttribute("tint", new THREE.BufferAttribute(tint, stride, false));
  }

  /// Everything sparser than this is shown as going away; -1: nothing is. @returns whether this changes the picture
  setTrim(density: number): boolean {
    const uniform = this.material.uniforms["trimDensity"]!;
    const before = uniform.value;
    uniform.value = this.decoded?.values["density"] ? density : -1;
    return uniform.value !== before;
  }

  apply(settings: ViewSettings): void {
    this.settings = settings;
    this.group.visible = !settings.hidden && settings.show !== "points";
    if (this.lines) this.lines.visible = settings.wireframe;
    if (!this.mesh || !this.decoded) return;
    const range = this.decoded.ranges[settings.colour];
    const uniforms = this.material.uniforms;
    uniforms["mode"]!.value = settings.colour === "colour" && this.decoded.colors ? 1 : range ? 2 : 0;
    if (range) {
      showValues(this.mesh.geometry, this.decoded, settings.colour);
      (uniforms["range"]!.value as THREE.Vector2).set(...range);
    }
  }

  /// The wireframe waits for its index, which the worker makes.
  get needsLines(): boolean {
    return !!this.settings?.wireframe && !!this.mesh && !this.lines;
  }

  setLines(index: Uint32Array, of: Decoded): void {
    if (of !== this.decoded || !this.mesh || this.lines) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.mesh.geometry.getAttribute("position"));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    geometry.boundingSphere = this.mesh.geometry.boundingSphere;
    this.lines = new THREE.LineSegments(geometry, this.lineMaterial);
    this.lines.frustumCulled = false;
    this.lines.visible = !!this.settings?.wireframe;
    place(this.lines, of);
    this.group.add(this.lines);
  }

  /// Leaves out triangles that face away, which cannot be seen of a closed surface from outside, and flicker in its
  /// outline. @param quick  for a frame that must be quick: from within the surface, too
  hideBacks(eye: THREE.Camera, quick: boolean): void {
    const hidden = (quick || this.isOutside(eye)) && !!this.decoded?.outward && !this.material.clippingPlanes?.length;
    this.material.side = hidden ? THREE.FrontSide : THREE.DoubleSide;
  }

  private isOutside(eye: THREE.Camera): boolean {
    if (!this.decoded || eye instanceof THREE.OrthographicCamera) return true;
    const { lower, upper } = this.decoded.box;
    const at = eye.position.toArray();
    return at.some((value, i) => value < lower[i]! || value > upper[i]!);
  }

  setTheme(front: string, back: string): void {
    this.material.uniforms["front"]!.value = rgb(front);
    this.material.uniforms["back"]!.value = rgb(back);
  }

  setClipping(planes: THREE.Plane[]): void {
    this.material.clippingPlanes = planes;
    this.lineMaterial.clippingPlanes = planes;
    this.material.uniforms["sectioned"]!.value = planes.length > 0;
  }

  pickable(): THREE.Object3D[] {
    return this.mesh && this.group.visible ? [this.mesh] : [];
  }

  private dropLines(): void {
    if (!this.lines) return;
    this.group.remove(this.lines);
    this.lines.geometry.setIndex(null);
    this.lines.geometry.deleteAttribute("position"); // it is the mesh's
    this.lines.geometry.dispose();
    this.lines = null;
  }
}
