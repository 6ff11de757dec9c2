// The drawing context that suits the machine.
import type { WebGLRendererParameters } from "three";

/// Whether the CPU draws, by the name of the renderer; `failIfMajorPerformanceCaveat` does not tell everywhere.
export function isSoftware(renderer: string): boolean {
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

function rendererName(): string {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return "";
  const unmasked = context.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER;
  const name = String(context.getParameter(unmasked));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

/// What suits a canvas on this machine. Smooth edges take four fifths of the time where the CPU draws, and are left
/// away there.
export function contextOptions(): { software: boolean; options: WebGLRendererParameters } {
  const software = isSoftware(rendererName());
  return { software, options: { antialias: !software, alpha: true, powerPreference: "high-performance" } };
}
