// The colour map of all measured values: lightness rises evenly (OKLab 0.36 to 0.88) while the hue goes from blue over
// magenta to orange, so that order is seen without hue and no red stands against green. A polynomial of degree 5 fitted
// to that path in sRGB, largest error 0.007.
export const kMapCoefficients: readonly [number, number, number][] = [
  [0.1361, 0.2125, 0.4758],
  [1.4115, 0.1931, 1.1528],
  [-0.3802, -0.5007, -1.912],
  [2.0708, 1.2344, -1.2056],
  [-4.2876, 0.2391, 2.6811],
  [2.0462, -0.5783, -0.695],
];

/// sRGB in [0, 1] of t in [0, 1].
export function mapColour(t: number): [number, number, number] {
  const x = Math.min(Math.max(Number.isFinite(t) ? t : 0, 0), 1);
  const channel = (k: 0 | 1 | 2) => {
    const value = kMapCoefficients.reduceRight((sum, c) => sum * x + c[k], 0);
    return Math.min(Math.max(value, 0), 1);
  };
  return [channel(0), channel(1), channel(2)];
}

/// The same as a function of GLSL, `vec3 mapColour(float)`.
export const kMapShader = /* glsl */ `
vec3 mapColour(float t) {
  float x = clamp(t, 0.0, 1.0);
  return clamp(${kMapCoefficients.map((c) => `vec3(${c.map((v) => v.toFixed(4)).join(",")})`).reduceRight((inner, c) => `(${c} + x * ${inner})`)}, 0.0, 1.0);
}`;

/// Colours of classes of points and of parts of the surface, sRGB; 0 is none. Orange and blue for the two sides.
export const kTints: readonly string[] = ["#000000", "#e8833a", "#3f8fd2", "#9a6fd0", "#8a8f98"];
