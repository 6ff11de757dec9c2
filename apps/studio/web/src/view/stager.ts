// Large meshes reach the GPU one array a frame, so that no frame of the page waits for all of them: three.js uploads
// an array when something that uses it is first drawn, and this draws nothing with it.
import * as THREE from "three";

const kAtOnce = 16 << 20; // bytes that fit into a frame

export function bytesOf(geometry: THREE.BufferGeometry): number {
  const arrays = [...Object.values(geometry.attributes), ...(geometry.index ? [geometry.index] : [])];
  return arrays.reduce((sum, attribute) => sum + (attribute as THREE.BufferAttribute).array.byteLength, 0);
}

export class Stager {
  readonly group = new THREE.Group();

  /// @param nextFrame  resolves after a frame was drawn
  constructor(private readonly nextFrame: () => Promise<void>) {}

  /// Resolves when all arrays of the geometry are on the GPU; at once for small ones.
  async upload(geometry: THREE.BufferGeometry): Promise<void> {
    if (bytesOf(geometry) <= kAtOnce) return;
    const part = new THREE.BufferGeometry();
    part.setDrawRange(0, 0);
    part.boundingSphere = geometry.boundingSphere; // else three.js works one out from all positions, to sort by it
    const nothing = new THREE.Mesh(part, new THREE.MeshBasicMaterial());
    nothing.frustumCulled = false;
    this.group.add(nothing);
    for (const [name, attribute] of Object.entries(geometry.attributes)) {
      part.setAttribute(name, attribute);
      await this.nextFrame();
    }
    part.setIndex(geometry.index);
    await this.nextFrame();
    this.group.remove(nothing);
    // Disposing of the part would delete the arrays, which are the geometry's.
    for (const name of Object.keys(part.attributes)) part.deleteAttribute(name);
    part.setIndex(null);
    part.dispose();
    nothing.material.dispose();
  }
}
