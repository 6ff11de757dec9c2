// The 3D view: a canvas, the camera, and the layers drawn in it. Draws when asked to, never on a timer.
import * as THREE from "three";
import type { Decoded } from "../engine/blob";
import type { Box, CameraJson, Vec3 } from "../engine/protocol";
import type { ViewSettings } from "../engine/store";
import type { Pick } from "../tools/tool";
import { ViewCamera, add, radiusOf } from "./camera";
import { GhostLayer } from "./ghosts";
import { contextOptions } from "./gl_context";
import { GridLayer } from "./grid";
import { Picker } from "./picker";
import { PointLayer } from "./point_layer";
import { Presenter } from "./presenter";
import { Section } from "./section";
import { Stager } from "./stager";
import { SurfaceLayer } from "./surface_layer";

// Colours are sRGB from the style sheet to the canvas; nothing is converted on the way.
THREE.ColorManagement.enabled = false;

const kCoarse = 0.5; // share of the pixels of each side while something moves, where frames take long
const kRest = 150; // milliseconds without a frame until one of all pixels is drawn
const kEmptyBox: Box = { lower: [-1, -1, -1], upper: [1, 1, 1] };

export class Viewport {
  readonly scene = new THREE.Scene(); // world coordinates; tools add their objects here
  readonly view = new ViewCamera();
  readonly surface = new SurfaceLayer();
  readonly points = new PointLayer();
  readonly ghosts = new GhostLayer();
  readonly section = new Section();
  readonly still: boolean; // no animations
  private readonly renderer: THREE.WebGLRenderer;
  private readonly presenter: Presenter;
  private readonly picker: Picker;
  private readonly stager = new Stager(() => {
    this.requestRender();
    return new Promise((done) => this.afterNextFrame(done));
  });
  private readonly grid = new GridLayer();
  private readonly perspective = new THREE.PerspectiveCamera();
  private readonly orthographic = new THREE.OrthographicCamera();
  private readonly listeners = new Set<() => void>();
  private readonly drawnListeners: (() => void)[] = [];
  private settings: ViewSettings | null = null;
  private asked = false; // a frame of the page is asked for
  private stale = false; // the canvas is to be drawn in it
  private flight = 0;
  private refining = 0; // timer
  private pixelRatio = 0; // of the screen, when the canvas got its size

  constructor(readonly canvas: HTMLCanvasElement) {
    const { software, options } = contextOptions();
    this.renderer = new THREE.WebGLRenderer({ canvas, ...options });
    this.presenter = new Presenter(this.renderer, software);
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // shaders write sRGB themselves
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.localClippingEnabled = true;
    this.picker = new Picker(this.renderer);
    this.still = new URLSearchParams(location.search).has("test") || matchMedia("(prefers-reduced-motion: reduce)").matches;
    for (const layer of [this.grid, this.surface, this.points, this.ghosts, this.section, this.stager]) this.scene.add(layer.group);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x667080, 2.4)); // for what tools draw with lit materials
    for (const camera of [this.perspective, this.orthographic]) camera.matrixAutoUpdate = false;
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("webglcontextrestored", () => this.requestRender());
    this.resize();
  }

  /// The camera of three.js that is in use; the one to change is `view`, followed by requestRender().
  get camera(): THREE.PerspectiveCamera | THREE.OrthographicCamera {
    return this.view.orthographic ? this.orthographic : this.perspective;
  }

  /// Box of what is shown, world coordinates.
  get box(): Box {
    const { decoded } = this.surface;
    return (decoded && decoded.triangles > 0 ? decoded.box : this.points.box) ?? kEmptyBox;
  }

  // ---- content ----

  /// Brings a mesh to the GPU over some frames, if it is large, so that setMesh() shows it at once.
  async stageMesh(decoded: Decoded): Promise<void> {
    await this.stager.upload(this.surface.prepare(decoded));
  }

  setMesh(decoded: Decoded | null): void {
    this.surface.set(decoded);
    this.points.setAlone(!decoded || decoded.triangles === 0);
    this.contentChanged();
  }

  /// Part of the points; `from` = 0 replaces all that there were.
  setPoints(decoded: Decoded | null, from = 0): void {
    const before = this.points.group.visible;
    this.points.set(decoded, from);
    if (before || this.points.group.visible) this.contentChanged();
  }

  /// Points that an operation would add and take away; null: none.
  setGhosts(added: Decoded | null, removed: Decoded | null = null): void {
    if (this.ghosts.set(added, removed)) this.requestRender();
  }

  /// Vertices sparser than this are shown as going away; -1: none.
  setTrim(density: number): void {
    if (this.surface.setTrim(density)) this.requestRender();
  }

  /// Class of each vertex of the mesh on the screen (colours kTints); null: that of the blob.
  setTint(classes: Uint8Array | null): void {
    this.surface.setTint(classes);
    this.requestRender();
  }

  /// What is cut away: the half space that `normal` points into; null: nothing.
  setSection(plane: { point: Vec3; normal: Vec3 } | null): void {
    this.section.set(plane, this.box);
    this.applySection();
  }

  apply(settings: ViewSettings): void {
    this.settings = settings;
    this.surface.apply(settings);
    this.points.apply(settings);
    this.grid.group.visible = settings.grid;
    this.contentChanged();
  }

  setTheme(theme: { clay: string; back: string; points: string; grid: string }): void {
    this.surface.setTheme(theme.clay, theme.back);
    this.points.setTheme(theme.points);
    this.grid.setTheme(theme.grid);
    this.requestRender();
  }

  // ---- camera ----

  /// For operations: as include/pointskin/camera.hpp has it; pixels are CSS pixels of the canvas.
  cameraDocument(): CameraJson {
    return this.view.document(this.box);
  }

  /// Shows a box whole, by default all that there is.
  frame(box: Box = this.box): void {
    const goal = this.view.clone();
    goal.fit(box);
    this.flyTo(goal);
  }

  /// Moves the camera there in a fifth of a second, or at once where motion is not wanted.
  flyTo(goal: ViewCamera): void {
    const start = this.view.clone();
    const flight = ++this.flight;
    const begun = performance.now();
    const step = () => {
      if (flight !== this.flight) return;
      const t = this.still ? 1 : Math.min((performance.now() - begun) / 220, 1);
      const s = t * t * (3 - 2 * t);
      const turn = Math.atan2(Math.sin(goal.azimuth - start.azimuth), Math.cos(goal.azimuth - start.azimuth));
      this.view.azimuth = start.azimuth + s * turn;
      this.view.elevation = start.elevation + s * (goal.elevation - start.elevation);
      this.view.distance = start.distance * (goal.distance / start.distance) ** s;
      this.view.target = add(start.target, add(goal.target, start.target, -1), s);
      this.view.orthographic = goal.orthographic;
      this.view.up = goal.up;
      this.requestRender();
      if (t < 1) requestAnimationFrame(step);
    };
    step();
  }

  /// Ends a flight: the hand is on the camera.
  land(): void {
    this.flight++;
  }

  /// The surface or point under a pixel.
  pick(x: number, y: number): Pick | null {
    this.updateCamera();
    const drawn = () => [...this.surface.pickable(), ...this.points.pickable()];
    const hit = this.picker.at(x, y, { width: this.view.width, height: this.view.height }, drawn, this.camera);
    if (!hit) return null;
    const point = this.view.pointAt(x, y, hit.depth);
    const axes = this.view.frame();
    let normal: Vec3 = [0, 0, 0];
    hit.normal.forEach((value, i) => (normal = add(normal, axes[i]!, value)));
    return { point, normal };
  }

  /// Where a world point is on the canvas, CSS pixels; `depth` < 0: behind the eye.
  project(point: Vec3): { x: number; y: number; depth: number } {
    return this.view.project(point);
  }

  // ---- drawing ----

  requestRender(): void {
    this.stale = true;
    this.canvas.dataset["frame"] = "asked";
    this.askFrame();
  }

  private askFrame(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      if (!this.presenter.busy) this.nextFrame(); // else when that one is shown
    });
  }

  private nextFrame(): void {
    const waiting = this.drawnListeners.splice(0);
    const shown = () => {
      for (const listener of waiting) listener();
      if (this.stale || this.drawnListeners.length > 0) this.askFrame();
    };
    if (this.stale) this.render(this.presenter.slow ? kCoarse : 1, shown);
    else shown();
  }

  /// All pixels, once nothing has moved for a moment.
  private refineSoon(): void {
    clearTimeout(this.refining);
    this.refining = window.setTimeout(() => {
      if (this.presenter.busy || this.asked) this.refineSoon();
      else this.render(1, () => (this.stale || this.drawnListeners.length > 0) && this.askFrame());
    }, kRest);
  }

  /// Calls after each frame, for overlays. @returns a function that ends it
  onFrame(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /// Calls once, when all that was asked for so far is drawn. Asks for no drawing itself.
  afterNextFrame(listener: () => void): void {
    this.drawnListeners.push(listener);
    this.askFrame();
  }

  /// The present view as PNG, over the given colours from top to bottom.
  async picture(top: string, bottom: string): Promise<Blob> {
    this.prepareFrame(1);
    if (this.renderer.getPixelRatio() !== this.pixelRatio) this.renderer.setPixelRatio(this.pixelRatio);
    this.renderer.render(this.scene, this.camera);
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [this.canvas.width, this.canvas.height];
    const context = copy.getContext("2d")!;
    const gradient = context.createLinearGradient(0, 0, 0, copy.height);
    gradient.addColorStop(0, top);
    gradient.addColorStop(1, bottom);
    context.fillStyle = gradient;
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(this.canvas, 0, 0);
    return new Promise((done, fail) => copy.toBlob((blob) => (blob ? done(blob) : fail(new Error("no picture"))), "image/png"));
  }

  private contentChanged(): void {
    this.grid.place(this.box, this.view.up);
    this.picker.invalidate();
    if (this.settings) this.applySection();
    this.requestRender();
  }

  private applySection(): void {
    const planes = this.section.planes;
    this.surface.setClipping(planes);
    this.points.setClipping(planes);
    this.picker.invalidate();
    this.requestRender();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return;
    [this.view.width, this.view.height] = [clientWidth, clientHeight];
    this.pixelRatio = window.devicePixelRatio;
    this.renderer.setPixelRatio(this.pixelRatio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.picker.invalidate();
    this.requestRender();
  }

  private updateCamera(): void {
    const { view, projection } = this.view.matrices(this.box);
    const camera = this.camera;
    camera.projectionMatrix.copy(projection);
    camera.projectionMatrixInverse.copy(projection).invert();
    camera.matrixWorldInverse.copy(view);
    camera.matrix.copy(view).invert();
    camera.matrix.decompose(camera.position, camera.quaternion, camera.scale);
    camera.matrixWorld.copy(camera.matrix);
  }

  private prepareFrame(share: number): void {
    this.stale = false;
    if (this.pixelRatio !== window.devicePixelRatio) this.resize();
    this.updateCamera();
    this.picker.invalidate();
    this.surface.hideBacks(this.camera, share < 1);
    this.points.setReference(this.view.distance, share * window.devicePixelRatio);
    this.ghosts.setReference(this.view.distance, share * window.devicePixelRatio, radiusOf(this.box));
  }

  /// @param share  of the pixels of each side; under 1 a frame of all of them follows
  private render(share: number, shown: () => void): void {
    this.prepareFrame(share);
    this.presenter.draw(this.scene, this.camera, share, () => {
      for (const listener of this.listeners) listener();
      if (!this.stale) this.canvas.dataset["frame"] = share < 1 ? "coarse" : "whole";
      shown();
      if (share < 1) this.refineSoon();
    });
  }
}
