import assert from "node:assert/strict";
import { test } from "node:test";
import { MeshoptEncoder } from "meshoptimizer/encoder";
import { buffersOf, decodeBlob, isClosed, linesOf, rangeOf, readHeader, signedVolume } from "../src/engine/blob";

interface Part {
  name: string;
  data: Uint8Array;
  count: number;
  stride: number;
  codec?: string;
  type: string;
}

const bytesOf = (array: { buffer: ArrayBufferLike; byteOffset: number; byteLength: number }) =>
  new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

/// A blob as the engine writes it: sections 8-aligned after a padded header.
function blobOf(kind: string, parts: Part[], counts: object): Uint8Array {
  let at = 0;
  const sections = parts.map(({ name, data, count, stride, codec = "raw", type }) => {
    const section = { name, offset: at, bytes: data.byteLength, count, stride, codec, type };
    at += Math.ceil(data.byteLength / 8) * 8;
    return section;
  });
  const box = { lower: [0, 0, 0], upper: [1, 2, 3] };
  let text = JSON.stringify({ kind, ...counts, box, sections });
  text += " ".repeat((8 - (text.length % 8)) % 8);
  const header = new TextEncoder().encode(text);
  const blob = new Uint8Array(16 + header.length + at);
  const view = new DataView(blob.buffer);
  blob.set(new TextEncoder().encode("PSKB"));
  view.setUint32(4, 1, true);
  view.setUint32(8, header.length, true);
  blob.set(header, 16);
  parts.forEach((part, i) => blob.set(part.data, 16 + header.length + sections[i]!.offset));
  return blob;
}

const kPositions = new Uint16Array([0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0]);
const kTetrahedron = new Uint32Array([0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]);

function tetrahedron(): Uint8Array {
  return blobOf(
    "mesh",
    [
      { name: "positions", data: bytesOf(kPositions), count: 4, stride: 8, type: "u16x4" },
      { name: "normals", data: new Uint8Array(16), count: 4, stride: 4, type: "u8x4" },
      { name: "triangles", data: bytesOf(kTetrahedron), count: 4, stride: 12, type: "u32x3" },
      { name: "values:density", data: bytesOf(new Float32Array([1, 2, 3, 4])), count: 4, stride: 4, type: "f32" },
    ],
    { vertices: 4, triangles: 4 },
  );
}

test("a raw blob decodes into views on its own bytes", async () => {
  const decoded = await decodeBlob(tetrahedron());
  assert.deepEqual([...decoded.positions], [...kPositions]);
  assert.deepEqual([...decoded.index!], [...kTetrahedron]);
  assert.deepEqual([...decoded.values["density"]!], [1, 2, 3, 4]);
  assert.deepEqual(decoded.box, { lower: [0, 0, 0], upper: [1, 2, 3] });
  assert.equal(decoded.normalStride, 4);
  assert.equal(decoded.closed, true);
  assert.equal(buffersOf(decoded).length, 1, "nothing was copied");
});

test("coded vertices and indices decode to what was coded", async () => {
  await MeshoptEncoder.ready;
  const coded = blobOf(
    "mesh",
    [
      { name: "positions", data: MeshoptEncoder.encodeVertexBuffer(bytesOf(kPositions), 4, 8), count: 4, stride: 8, codec: "vertex", type: "u16x4" },
      { name: "triangles", data: MeshoptEncoder.encodeIndexBuffer(bytesOf(kTetrahedron), 12, 4), count: 4, stride: 12, codec: "index", type: "u32x3" },
    ],
    { vertices: 4, triangles: 4 },
  );
  const decoded = await decodeBlob(coded);
  assert.deepEqual([...decoded.positions], [...kPositions]);
  // The order of triangles is kept, the corner each begins with is not.
  for (let i = 0; i < 12; i += 3) {
    const [a, b, c] = [...decoded.index!.subarray(i, i + 3)];
    const turns = [[a, b, c], [b, c, a], [c, a, b]].map(String);
    assert.ok(turns.includes(String([...kTetrahedron.subarray(i, i + 3)])), `triangle ${i / 3}`);
  }
});

test("what is no blob, of another version, or cut short is refused", async () => {
  assert.throws(() => readHeader(new Uint8Array(8)), /not a blob/);
  const wrong = tetrahedron();
  wrong[4] = 2;
  assert.throws(() => readHeader(wrong), /version 2/);
  await assert.rejects(decodeBlob(tetrahedron().subarray(0, -16)), /cut short/);
});

test("a surface is closed until one triangle is missing or turned", () => {
  assert.equal(isClosed(kTetrahedron), true);
  assert.equal(isClosed(kTetrahedron.subarray(3)), false);
  assert.equal(isClosed(new Uint32Array([1, 2, 0, ...kTetrahedron.subarray(3)])), false);
  assert.equal(isClosed(new Uint32Array()), false);
});

test("the volume of a tetrahedron, and of one that is inside out", () => {
  const corners = Uint16Array.from([9, 9, 9, 0, 15, 9, 9, 0, 9, 15, 9, 0, 9, 9, 15, 0]);
  const outward = Uint32Array.from([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
  assert.equal(signedVolume(corners, outward), 36);
  assert.equal(signedVolume(corners, outward.slice().reverse()), -36);
});

test("the range of colours leaves single outliers and NaN out", () => {
  const values = Float32Array.from({ length: 1000 }, (_, i) => i / 1000);
  values[0] = 1e9;
  values[1] = NaN;
  const [low, high] = rangeOf(values);
  assert.ok(low >= 0 && low < 0.05 && high > 0.95 && high <= 1, `${low} ${high}`);
  assert.deepEqual(rangeOf(new Float32Array([NaN])), [0, 1]);
});

test("the wireframe has the three edges of each triangle", () => {
  assert.deepEqual([...linesOf(new Uint32Array([7, 8, 9]))], [7, 8, 8, 9, 9, 7]);
});
