// What is under a pixel: the surface and the points are drawn once into a buffer of normals and depths, which answers
// until the view changes. Cheap for hovering, and needs no search structure over millions of triangles.
import * as THREE from "three";
import { pickFragment, pickPointsFragment, pickPointsVertex, surfaceVertex } from "./shaders";

export interface PickHit {
  normal: [number, number, number]; // in the eye's frame
  depth: number; // along the view, world units
}

function pickMaterial(points: boolean): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexShader: points ? pickPointsVertex : surfaceVertex,
    fragmentShader: points ? pickPointsFragment : pickFragment,
    side: THREE.DoubleSide,
    clipping: true,
    uniforms: { hasNormals: { value: true }, size: { value: 2 }, reference: { value: 1 } },
  });
}

export class Picker {
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    type: THREE.FloatType,
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
  });
  private readonly surface = pickMaterial(false);
  private readonly points = pickMaterial(true);
  private readonly pixel = new Float32Array(4);
  private readonly clear = new THREE.Color();
  private fresh = false;

  constructor(private readonly renderer: THREE.WebGLRenderer) {}

  invalidate(): void {
    this.fresh = false;
  }

  /// @param objects  meshes and points with ShaderMaterials of layers.ts; each is drawn with the picker's own
  at(x: number, y: number, size: { width: number; height: number }, draw: () => THREE.Object3D[], camera: THREE.Camera) {
    if (!this.fresh) this.render(size, draw(), camera);
    this.fresh = true;
    const [column, row] = [Math.floor(x), Math.floor(this.target.height - 1 - y)];
    this.renderer.readRenderTargetPixels(this.target, column, row, 1, 1, this.pixel);
    const [nx, ny, nz, depth] = this.pixel;
    if (!depth || !(Math.abs(depth) > 0)) return null;
    return { normal: [nx!, ny!, nz!], depth } as PickHit;
  }

  private render(size: { width: number; height: number }, objects: THREE.Object3D[], camera: THREE.Camera): void {
    this.target.setSize(Math.max(1, Math.round(size.width)), Math.max(1, Math.round(size.height)));
    const scene = new THREE.Scene();
    const swapped = objects.map((object) => this.swap(object));
    // Objects stay in the scene of the view: only its list is borrowed.
    scene.children = objects;
    scene.matrixWorldAutoUpdate = false;
    const alpha = this.renderer.getClearAlpha();
    this.renderer.getClearColor(this.clear);
    this.renderer.setRenderTarget(this.target);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.clear();
    this.renderer.render(scene, camera);
    this.renderer.setRenderTarget(null);
    this.renderer.setClearColor(this.clear, alpha);
    for (const restore of swapped) restore();
  }

  private swap(object: THREE.Object3D): () => void {
    const drawn = object as THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
    const own = drawn.material;
    const mine = (object as THREE.Points).isPoints ? this.points : this.surface;
    mine.clippingPlanes = own.clippingPlanes;
    mine.uniforms["hasNormals"]!.value = own.uniforms["hasNormals"]!.value;
    for (const name of ["size", "reference"]) {
      if (own.uniforms[name]) mine.uniforms[name]!.value = own.uniforms[name].value;
    }
    drawn.material = mine;
    return () => void (drawn.material = own);
  }
}
