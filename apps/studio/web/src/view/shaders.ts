// Shaders of the surface and of the points. Colours are worked out in sRGB and written as they are: the clay has no
// physical light, so that there is nothing to be linear about.
import { kMapShader } from "./colours";

const kOctahedral = /* glsl */ `
vec3 octahedral(vec2 e) {
  vec2 f = (e * 255.0 - 127.0) / 127.0; // 255 steps around 127, so that axes are exact
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float t = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
  return normalize(n);
}`;

// A key light from the upper left of the viewer, a fill from the sky, and a darker rim that draws silhouettes.
const kClay = /* glsl */ `
vec3 clay(vec3 base, vec3 n, vec3 toEye) {
  float key = max(dot(n, normalize(vec3(-0.45, 0.65, 0.75))), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  float facing = clamp(dot(n, toEye), 0.0, 1.0);
  float rim = smoothstep(0.0, 0.55, facing);
  float gloss = pow(max(dot(reflect(-toEye, n), normalize(vec3(-0.35, 0.55, 0.76))), 0.0), 28.0);
  return base * (0.30 + 0.22 * sky + 0.56 * key) * mix(0.58, 1.0, rim) + 0.055 * gloss;
}`;

export const surfaceVertex = /* glsl */ `
attribute vec2 oct;
attribute vec4 tone;
attribute float value;
attribute float density;
attribute float tint;
varying vec3 vEye;
varying vec3 vNormal;
varying vec3 vTone;
varying float vValue;
varying float vDensity;
flat varying int vTint;
#include <clipping_planes_pars_vertex>
${kOctahedral}
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  vEye = mvPosition.xyz;
  vNormal = mat3(viewMatrix) * octahedral(oct);
  vTone = tone.rgb;
  vValue = value;
  vDensity = density;
  vTint = int(tint + 0.5);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
}`;

export const surfaceFragment = /* glsl */ `
uniform vec3 front;
uniform vec3 back;
uniform vec3 cut;
uniform vec3 tints[8];
uniform int mode;
uniform vec2 range;
uniform float trimDensity;
uniform bool hasNormals;
uniform bool hasTint;
uniform bool sectioned;
uniform float opacity;
varying vec3 vEye;
varying vec3 vNormal;
varying vec3 vTone;
varying float vValue;
varying float vDensity;
flat varying int vTint;
#include <clipping_planes_pars_fragment>
${kMapShader}
${kClay}
void main() {
  #include <clipping_planes_fragment>
  vec3 flatNormal = normalize(cross(dFdx(vEye), dFdy(vEye)));
  vec3 toEye = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-vEye);
  vec3 n = hasNormals ? normalize(vNormal) : flatNormal;
  bool outside = gl_FrontFacing;
  if (!hasNormals) n = dot(n, toEye) < 0.0 ? -n : n;
  else if (!outside) n = -n;
  if (!outside && sectioned) {
    float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 14.0));
    gl_FragColor = vec4(cut * mix(0.86, 1.0, stripe), opacity);
    return;
  }
  vec3 base = outside ? front : back;
  if (outside && mode == 1) base = vTone;
  if (outside && mode == 2) base = mapColour((vValue - range.x) / max(range.y - range.x, 1e-30));
  if (hasTint && vTint > 0) base = mix(base, tints[min(vTint, 7)], 0.72);
  if (vDensity < trimDensity) base = mix(base, tints[1], 0.8);
  float turn = length(fwidth(n)); // near 1 it is no crease, but a pixel of an outline that belongs to two triangles
  float crease = clamp(turn * 0.9 - 0.12, 0.0, 0.38) * (1.0 - smoothstep(0.5, 1.0, turn));
  gl_FragColor = vec4(clay(base, n, toEye) * (1.0 - crease), opacity);
}`;

export const pointsVertex = /* glsl */ `
attribute vec2 oct;
attribute vec4 tone;
attribute float value;
attribute float tint;
uniform vec3 plain;
uniform vec3 tints[8];
uniform int mode;
uniform vec2 range;
uniform float size;
uniform float reference;
uniform bool hasNormals;
uniform float opacity;
varying vec4 vColour;
#include <clipping_planes_pars_vertex>
${kOctahedral}
${kMapShader}
${kClay}
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  vec3 base = plain;
  vec3 world = octahedral(oct);
  if (mode == 1) base = tone.rgb;
  if (mode == 2) base = mapColour((value - range.x) / max(range.y - range.x, 1e-30));
  if (mode == 3) base = 0.5 + 0.5 * world;
  int kind = int((mode == 4 ? value : tint) + 0.5);
  if (kind > 0) base = tints[min(kind, 7)];
  if (hasNormals) {
    vec3 toEye = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-mvPosition.xyz);
    vec3 n = mat3(viewMatrix) * world;
    bool outside = dot(n, toEye) >= 0.0;
    base = clay(outside ? base : mix(base, vec3(0.33, 0.42, 0.58), 0.65), outside ? n : -n, toEye);
  }
  vColour = vec4(base, opacity);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  float scale = isOrthographic ? 1.0 : reference / max(-mvPosition.z, 1e-30);
  gl_PointSize = clamp(size * scale, 1.0, 48.0);
}`;

export const pointsFragment = /* glsl */ `
varying vec4 vColour;
#include <clipping_planes_pars_fragment>
void main() {
  #include <clipping_planes_fragment>
  vec2 p = gl_PointCoord * 2.0 - 1.0;
  float r = dot(p, p);
  if (r > 1.0) discard;
  gl_FragColor = vec4(vColour.rgb * (1.0 - 0.28 * r * r), vColour.a);
}`;

// Short lines along the normals of ghosts: both ends have the point's position, `end` says which one this is.
export const spikesVertex = /* glsl */ `
attribute vec2 oct;
attribute float end;
uniform float spike;
varying float vEnd;
${kOctahedral}
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  vec3 n = mat3(viewMatrix) * octahedral(oct);
  mvPosition.xyz += n * (spike * end);
  vEnd = end;
  gl_Position = projectionMatrix * mvPosition;
}`;

export const spikesFragment = /* glsl */ `
uniform vec3 plain;
varying float vEnd;
void main() { gl_FragColor = vec4(plain, 0.95 - 0.75 * vEnd); }`;

// What a click is on: distance along the view and the normal in the eye's frame.
export const pickFragment = /* glsl */ `
varying vec3 vEye;
varying vec3 vNormal;
uniform bool hasNormals;
#include <clipping_planes_pars_fragment>
void main() {
  #include <clipping_planes_fragment>
  vec3 n = hasNormals ? normalize(vNormal) : normalize(cross(dFdx(vEye), dFdy(vEye)));
  gl_FragColor = vec4(n, -vEye.z);
}`;

export const pickPointsVertex = /* glsl */ `
attribute vec2 oct;
uniform float size;
uniform float reference;
varying vec3 vEye;
varying vec3 vNormal;
#include <clipping_planes_pars_vertex>
${kOctahedral}
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  vEye = mvPosition.xyz;
  vNormal = mat3(viewMatrix) * octahedral(oct);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  float scale = isOrthographic ? 1.0 : reference / max(-mvPosition.z, 1e-30);
  gl_PointSize = clamp(size * scale + 4.0, 3.0, 48.0);
}`;

export const pickPointsFragment = /* glsl */ `
varying vec3 vEye;
varying vec3 vNormal;
uniform bool hasNormals;
#include <clipping_planes_pars_fragment>
void main() {
  #include <clipping_planes_fragment>
  gl_FragColor = vec4(hasNormals ? normalize(vNormal) : vec3(0.0, 0.0, 1.0), -vEye.z);
}`;
