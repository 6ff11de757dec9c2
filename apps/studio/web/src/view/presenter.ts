// Frames of the canvas. Where a GPU draws they are drawn into it. Where the CPU does, which takes some hundred
// milliseconds, they are drawn aside and copied when they are done: a page that drew into the canvas would stand still
// until the browser has the picture. While things move, frames that take long have fewer pixels.
import * as THREE from "three";

const kCopyVertex = `varying vec2 place;
void main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }`;
const kCopyFragment = `uniform sampler2D picture; varying vec2 place;
void main() { gl_FragColor = texture2D(picture, place); }`;

const kSlow = 120; // milliseconds

export class Presenter {
  /// A frame is in the making; draw() must wait for it.
  busy = false;
  /// The last frame of all pixels took so long that one of fewer should come first.
  slow = false;
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    minFilter: THREE.LinearFilter,
    magFilter: THREE.LinearFilter,
  });
  private readonly copy = new THREE.Scene();
  private readonly camera = new THREE.Camera();
  private readonly size = new THREE.Vector2();

  /// @param aside  whether frames take long
  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly aside: boolean,
  ) {
    const material = new THREE.ShaderMaterial({
      vertexShader: kCopyVertex,
      fragmentShader: kCopyFragment,
      uniforms: { picture: { value: this.target.texture } },
      blending: THREE.NoBlending,
      depthTest: false,
      depthWrite: false,
    });
    const whole = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    whole.frustumCulled = false;
    this.copy.add(whole);
  }

  /// @param share  of the pixels of each side that are drawn; 1 wherever a GPU draws
  /// @param shown  called when the frame is in the canvas, within this call or later
  draw(scene: THREE.Scene, camera: THREE.Camera, share: number, shown: () => void): void {
    if (!this.aside) {
      this.renderer.render(scene, camera);
      return shown();
    }
    const begun = performance.now();
    const ratio = share * window.devicePixelRatio;
    this.renderer.getSize(this.size);
    this.target.setSize(Math.floor(ratio * this.size.x), Math.floor(ratio * this.size.y));
    this.renderer.setRenderTarget(this.target);
    this.renderer.render(scene, camera);
    this.renderer.setRenderTarget(null);
    this.busy = true;
    this.whenDone(() => {
      this.busy = false;
      if (share === 1) this.slow = performance.now() - begun > kSlow;
      if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
      this.renderer.render(this.copy, this.camera);
      shown();
    });
  }

  /// Looks once a frame of the page whether all commands so far are done.
  private whenDone(then: () => void): void {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (fence && gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED) return void requestAnimationFrame(look);
      if (fence) gl.deleteSync(fence);
      then();
    };
    requestAnimationFrame(look);
  }
}
