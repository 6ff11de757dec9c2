// The section plane: clips what it points at and shows its frame, so that one sees where it cuts.
import * as THREE from "three";
import type { Box, Vec3 } from "../engine/protocol";
import { centreOf, radiusOf } from "./camera";

function frameGeometry(): THREE.BufferGeometry {
  const corners = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]);
  return new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(corners, 3));
}

export class Section {
  readonly group = new THREE.Group();
  plane: { point: Vec3; normal: Vec3 } | null = null;
  private readonly outline = new THREE.LineLoop(frameGeometry(), new THREE.LineBasicMaterial({ color: 0xe8833a }));

  constructor() {
    this.outline.frustumCulled = false;
    this.group.add(this.outline);
    this.group.visible = false;
  }

  get planes(): THREE.Plane[] {
    if (!this.plane) return [];
    const normal = new THREE.Vector3(...this.plane.normal).normalize().negate();
    return [new THREE.Plane().setFromNormalAndCoplanarPoint(normal, new THREE.Vector3(...this.plane.point))];
  }

  /// @param box  of the scene: the frame is as large, and centred on it
  set(plane: { point: Vec3; normal: Vec3 } | null, box: Box): void {
    this.plane = plane;
    this.group.visible = !!plane;
    if (!plane) return;
    const normal = new THREE.Vector3(...plane.normal).normalize();
    const centre = new THREE.Vector3(...centreOf(box));
    const away = new THREE.Vector3(...plane.point).sub(centre).dot(normal);
    this.outline.position.copy(centre).addScaledVector(normal, away);
    this.outline.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
    const turn = this.outline.quaternion.clone().invert();
    const half = new THREE.Vector3();
    for (let corner = 0; corner < 8; ++corner) {
      const at = [0, 1, 2].map((i) => ((corner >> i) & 1 ? box.upper[i]! : box.lower[i]!)) as Vec3;
      const local = new THREE.Vector3(...at).sub(centre).applyQuaternion(turn);
      half.max(new THREE.Vector3(Math.abs(local.x), Math.abs(local.y), 0));
    }
    const margin = 0.04 * radiusOf(box);
    this.outline.scale.set(half.x + margin, half.y + margin, 1);
    this.outline.updateMatrixWorld(true);
  }
}
