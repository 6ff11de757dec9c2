// The cloud, in the parts in which it came. Every part is an even subsample of the whole.
import * as THREE from "three";
import type { Decoded } from "../engine/blob";
import type { Box } from "../engine/protocol";
import type { ViewSettings } from "../engine/store";
import { geometryOf, place, pointsMaterial, rgb, showValues } from "./layers";

const kModes = { plain: 0, colour: 1, normal: 3, added: 4 } as const;

export class PointLayer {
  readonly group = new THREE.Group();
  box: Box | null = null;
  private readonly material = pointsMaterial("#9fb4cc");
  private parts: { points: THREE.Points; decoded: Decoded; from: number }[] = [];
  private settings: ViewSettings | null = null;
  private alone = true;

  get shown(): number {
    return this.parts.reduce((sum, part) => sum + part.decoded.vertices, 0);
  }

  get hasColours(): boolean {
    return this.parts.some((part) => part.decoded.colors);
  }

  set(decoded: Decoded | null, from: number): void {
    if (from === 0) this.clear();
    if (!decoded || decoded.vertices === 0) return;
    const points = new THREE.Points(geometryOf(decoded), this.material);
    points.frustumCulled = false;
    place(points, decoded);
    this.parts.push({ points, decoded, from });
    this.group.add(points);
    this.box ??= decoded.box;
    this.material.uniforms["hasNormals"]!.value = !!decoded.normals;
    if (this.settings) this.apply(this.settings);
  }

  apply(settings: ViewSettings): void {
    this.settings = settings;
    this.group.visible = !settings.hidden && (settings.show !== "mesh" || this.alone);
    this.material.uniforms["mode"]!.value = this.modeOf(settings);
    for (const { points, decoded } of this.parts) {
      if (settings.pointColour === "added") showValues(points.geometry, decoded, "added");
    }
  }

  /// Without a mesh the points are shown in any case.
  setAlone(alone: boolean): void {
    this.alone = alone;
    if (this.settings) this.apply(this.settings);
  }

  /// @param distance  at which points have the size that is set, world units
  setReference(distance: number, pixelRatio: number): void {
    this.material.uniforms["reference"]!.value = distance;
    this.material.uniforms["size"]!.value = (this.settings?.pointSize ?? 2) * pixelRatio;
  }

  setTheme(plain: string): void {
    this.material.uniforms["plain"]!.value = rgb(plain);
  }

  setClipping(planes: THREE.Plane[]): void {
    this.material.clippingPlanes = planes;
  }

  pickable(): THREE.Object3D[] {
    return this.group.visible ? this.parts.map((part) => part.points) : [];
  }

  private modeOf(settings: ViewSettings): number {
    if (settings.pointColour === "colour" && !this.hasColours) return 0;
    if (settings.pointColour === "added" && !this.parts.some((part) => part.decoded.values["added"])) return 0;
    return kModes[settings.pointColour];
  }

  private clear(): void {
    for (const { points } of this.parts) points.geometry.dispose();
    this.parts = [];
    this.box = null;
    this.group.clear();
  }
}
