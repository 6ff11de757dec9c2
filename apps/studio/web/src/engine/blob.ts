// Decodes what /blob/ID answers: "PSKB", a JSON header, and sections of typed arrays. Used by the worker and by tests.
import { MeshoptDecoder } from "meshoptimizer/decoder";
import type { Box } from "./protocol";

type Codec = "raw" | "vertex" | "index";
type SectionType = "u16x4" | "u8x4" | "u32x3" | "f32" | "u8";
export interface Section {
  name: string;
  offset: number;
  bytes: number;
  count: number;
  stride: number;
  codec: Codec;
  type: SectionType;
}
export interface BlobHeader {
  kind: "mesh" | "points";
  vertices: number;
  triangles?: number;
  total?: number;
  box: Box;
  sections: Section[];
}

/// Arrays as the GPU takes them. Normals are octahedral in two bytes of `normalStride`.
export interface Decoded {
  kind: "mesh" | "points";
  box: Box;
  vertices: number;
  triangles: number;
  positions: Uint16Array; // 4 a vertex, in the box / 65535
  normals: Uint8Array | null;
  normalStride: number;
  index: Uint32Array | null;
  colors: Uint8Array | null; // 4 a vertex
  tint: Uint8Array | null;
  tintStride: number;
  values: Record<string, Float32Array>;
  ranges: Record<string, [number, number]>; // 2nd to 98th percentile of each of values
  closed: boolean; // no edge without a neighbour
  outward: boolean; // closed, and its triangles face outside
  bytes: number;
  transferMs: number;
  decodeMs: number;
}

const kMagic = 0x424b5350; // "PSKB", little endian

export function readHeader(bytes: Uint8Array): { header: BlobHeader; start: number } {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.byteLength < 16 || view.getUint32(0, true) !== kMagic) throw new Error("not a blob of the engine");
  if (view.getUint32(4, true) !== 1) throw new Error(`blob of version ${view.getUint32(4, true)}, not 1`);
  const length = view.getUint32(8, true);
  const text = new TextDecoder().decode(bytes.subarray(16, 16 + length));
  return { header: JSON.parse(text) as BlobHeader, start: 16 + length };
}

function sectionBytes(bytes: Uint8Array, start: number, section: Section): Uint8Array {
  const from = start + section.offset;
  const coded = bytes.subarray(from, from + section.bytes);
  if (coded.byteLength !== section.bytes) throw new Error(`section ${section.name} is cut short`);
  if (section.codec === "raw") return coded;
  const target = new Uint8Array(section.count * section.stride);
  if (section.codec === "vertex") MeshoptDecoder.decodeVertexBuffer(target, section.count, section.stride, coded);
  else MeshoptDecoder.decodeIndexBuffer(target, target.byteLength / 4, 4, coded); // an element is a triangle
  return target;
}

type ArrayType<T> = { new (b: ArrayBuffer, o: number, n: number): T; BYTES_PER_ELEMENT: number };

/// A view on the bytes, without copying where they are aligned.
function viewAs<T>(type: ArrayType<T>, bytes: Uint8Array): T {
  const whole = bytes.byteOffset % type.BYTES_PER_ELEMENT === 0 ? bytes : bytes.slice();
  return new type(whole.buffer as ArrayBuffer, whole.byteOffset, whole.byteLength / type.BYTES_PER_ELEMENT);
}

/// Where most values lie: 2nd to 98th percentile of a sample, so that single outliers do not flatten the colours.
export function rangeOf(values: Float32Array): [number, number] {
  const step = Math.max(1, Math.floor(values.length / 20000));
  const sample: number[] = [];
  for (let i = 0; i < values.length; i += step) {
    const value = values[i]!;
    if (Number.isFinite(value)) sample.push(value);
  }
  if (sample.length === 0) return [0, 1];
  sample.sort((a, b) => a - b);
  const at = (q: number) => sample[Math.min(sample.length - 1, Math.floor(q * sample.length))]!;
  return [at(0.02), at(0.98)];
}

function emptyOf(header: BlobHeader, bytes: number): Decoded {
  return {
    kind: header.kind,
    box: header.box,
    vertices: header.vertices,
    triangles: header.triangles ?? 0,
    positions: new Uint16Array(),
    normals: null,
    normalStride: 2,
    index: null,
    colors: null,
    tint: null,
    tintStride: 1,
    values: {},
    ranges: {},
    closed: false,
    outward: false,
    bytes,
    transferMs: 0,
    decodeMs: 0,
  };
}

export async function decodeBlob(bytes: Uint8Array): Promise<Decoded> {
  const { header, start } = readHeader(bytes);
  if (header.sections.some((section) => section.codec !== "raw")) await MeshoptDecoder.ready;
  const decoded = emptyOf(header, bytes.byteLength);
  for (const section of header.sections) {
    const data = sectionBytes(bytes, start, section);
    if (section.name === "positions") decoded.positions = viewAs(Uint16Array, data);
    else if (section.name === "normals") [decoded.normals, decoded.normalStride] = [data, section.stride];
    else if (section.name === "triangles") decoded.index = viewAs(Uint32Array, data);
    else if (section.name === "colors") decoded.colors = data;
    else if (section.name === "tint") [decoded.tint, decoded.tintStride] = [data, section.stride];
    else if (section.name.startsWith("values:")) {
      const name = section.name.slice("values:".length);
      const values = viewAs(Float32Array, data);
      decoded.values[name] = values;
      decoded.ranges[name] = rangeOf(values);
    }
  }
  if (decoded.index) {
    decoded.closed = isClosed(decoded.index);
    decoded.outward = decoded.closed && signedVolume(decoded.positions, decoded.index) > 0;
  }
  return decoded;
}

/// Whether every edge is passed as often in one direction as in the other. Each direction of an edge gets a number that
/// is the negative of the other's, and a closed surface sums to 0; an open one does so once in 2^32. Needs no memory.
export function isClosed(index: Uint32Array): boolean {
  let sum = 0;
  for (let i = 0; i < index.length; i += 3) {
    const [a, b, c] = [index[i]!, index[i + 1]!, index[i + 2]!];
    sum = (sum + edgeNumber(a, b) + edgeNumber(b, c) + edgeNumber(c, a)) | 0;
  }
  return index.length > 0 && sum === 0;
}

function edgeNumber(a: number, b: number): number {
  const [low, high] = a < b ? [a, b] : [b, a];
  let h = Math.imul(low, 0x9e3779b1) ^ Math.imul(high + 0x7f4a7c15, 0x85ebca77);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  h = Math.imul(h ^ (h >>> 13), 0x297a2d39);
  h ^= h >>> 16;
  return a < b ? h : -h;
}

/// The volume that a closed surface encloses, in the units of its positions; negative where it is inside out.
export function signedVolume(positions: Uint16Array, index: Uint32Array): number {
  let six = 0;
  for (let i = 0; i < index.length; i += 3) {
    // No arrays: the loop runs for every surface that is drawn.
    const a = index[i]! * 4;
    const b = index[i + 1]! * 4;
    const c = index[i + 2]! * 4;
    const ax = positions[a]!;
    const ay = positions[a + 1]!;
    const az = positions[a + 2]!;
    const bx = positions[b]! - ax;
    const by = positions[b + 1]! - ay;
    const bz = positions[b + 2]! - az;
    const cx = positions[c]! - ax;
    const cy = positions[c + 1]! - ay;
    const cz = positions[c + 2]! - az;
    six += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  }
  return six / 6;
}

/// The buffers that go to the page with the message, each once.
export function buffersOf(decoded: Decoded): ArrayBuffer[] {
  const views = [decoded.positions, decoded.normals, decoded.index, decoded.colors, decoded.tint];
  const all = [...views, ...Object.values(decoded.values)];
  return [...new Set(all.flatMap((view) => (view ? [view.buffer as ArrayBuffer] : [])))];
}

/// Corners of each triangle as pairs of ends of lines, for the wireframe.
export function linesOf(index: Uint32Array): Uint32Array {
  const lines = new Uint32Array(index.length * 2);
  for (let i = 0, k = 0; i < index.length; i += 3) {
    const [a, b, c] = [index[i]!, index[i + 1]!, index[i + 2]!];
    lines[k++] = a;
    lines[k++] = b;
    lines[k++] = b;
    lines[k++] = c;
    lines[k++] = c;
    lines[k++] = a;
  }
  return lines;
}
