// Compressed GLB files beside other programs: ours as three.js reads it, and one that meshoptimizer's own encoder made here.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { require } from './packages.mjs';
import { generator, runProgram, temporaryFolder } from './program.mjs';

const load = name => import(pathToFileURL(require.resolve(name)));
const folder = temporaryFolder();
const plain = join(folder, 'plain.glb');
const small = join(folder, 'small.glb');
const ply = join(folder, 'points.ply');

function run(...args) {
  const ended = runProgram(...args);
  assert.equal(ended.status, 0, ended.stderr);
  return ended.stdout;
}

/** The first mesh of a file. */
async function meshOf(file) {
  globalThis.self ??= globalThis;  // as a page has it
  const { GLTFLoader } = await load('three/examples/jsm/loaders/GLTFLoader.js');
  const { MeshoptDecoder } = await load('meshoptimizer/decoder');
  await MeshoptDecoder.ready;
  const bytes = readFileSync(file);
  const whole = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const { scene } = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(whole, '');
  scene.updateMatrixWorld(true);
  let mesh;
  scene.traverse(object => { if (object.isMesh) mesh = object; });
  return mesh;
}

const values = attribute => Array.from({ length: attribute.count }, (_, i) => [attribute.getX(i), attribute.getY(i), attribute.getZ(i)]);

/** Positions in world coordinates. */
function placesOf({ geometry, matrixWorld: { elements: m } }) {
  return values(geometry.getAttribute('position'))
    .map(([x, y, z]) => [0, 1, 2].map(row => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]));
}

test('three.js reads a compressed file as the plain one', async () => {
  assert.equal(spawnSync(generator, ['torus', '-o', ply, '--points', '20000']).status, 0);
  run('reconstruct', ply, '-o', plain, '--depth', '6', '-q');
  run('convert', plain, small, '--compress', '-q');
  assert.ok(3.5 * readFileSync(small).length < readFileSync(plain).length, 'a quarter as large');
  const [before, after] = [await meshOf(plain), await meshOf(small)];
  const [expected, found] = [placesOf(before), placesOf(after)];
  const sides = [0, 1, 2].map(axis => Math.max(...expected.map(p => p[axis])) - Math.min(...expected.map(p => p[axis])));
  const step = Math.max(...sides) / 65535;
  assert.equal(found.length, expected.length);
  expected.forEach((place, i) => place.forEach((v, axis) =>
    assert.ok(Math.abs(v - found[i][axis]) <= 0.51 * step, `vertex ${i}`)));
  const normals = values(after.geometry.getAttribute('normal'));
  values(before.geometry.getAttribute('normal')).forEach((n, i) => {
    const cosine = n.reduce((sum, v, axis) => sum + v * normals[i][axis], 0) / Math.hypot(...normals[i]);
    assert.ok(cosine > Math.cos(0.0015), `normal ${i}`);
  });
  const around = index => Array.from({ length: index.count / 3 }, (_, t) => {
    const corners = [0, 1, 2].map(c => index.getX(3 * t + c));
    const first = corners.indexOf(Math.min(...corners));
    return [...corners.slice(first), ...corners.slice(0, first)].join();
  });
  assert.deepEqual(around(after.geometry.index), around(before.geometry.index));
});

test('what the encoder of meshoptimizer makes is read', async () => {
  const { MeshoptEncoder } = await load('meshoptimizer/encoder');
  await MeshoptEncoder.ready;
  const positions = new Float32Array([0, 0, 0, 1.5, 0, 0, 0, 2.25, 0, 0, 0, 3]);
  const indices = new Uint16Array([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]);
  const bytesOf = array => new Uint8Array(array.buffer);
  const parts = [
    { data: MeshoptEncoder.encodeGltfBuffer(MeshoptEncoder.encodeFilterExp(positions, 4, 12, 20), 4, 12, 'ATTRIBUTES', 0),
      count: 4, byteStride: 12, mode: 'ATTRIBUTES', filter: 'EXPONENTIAL' },
    { data: MeshoptEncoder.encodeGltfBuffer(bytesOf(indices), 12, 2, 'INDICES', 0), count: 12, byteStride: 2, mode: 'INDICES' },
    { data: MeshoptEncoder.encodeGltfBuffer(bytesOf(indices), 12, 2, 'TRIANGLES', 0), count: 12, byteStride: 2, mode: 'TRIANGLES' },
  ];
  for (const faces of [1, 2]) {
    let at = 0;
    const bufferViews = parts.map(({ data, ...packing }) => {
      const byteOffset = at;
      at += data.length;
      return { buffer: 1, byteLength: packing.count * packing.byteStride,
        extensions: { EXT_meshopt_compression: { buffer: 0, byteOffset, byteLength: data.length, ...packing } } };
    });
    const uri = `data:application/octet-stream;base64,${Buffer.concat(parts.map(part => part.data)).toString('base64')}`;
    const extension = 'EXT_meshopt_compression';
    const document = {
      asset: { version: '2.0' }, extensionsUsed: [extension], extensionsRequired: [extension], bufferViews,
      buffers: [{ byteLength: at, uri }, { byteLength: 1000, extensions: { [extension]: { fallback: true } } }],
      accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 4 },
        { bufferView: faces, componentType: 5123, type: 'SCALAR', count: 12 }],
      meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    };
    const file = join(folder, 'theirs.gltf');
    writeFileSync(file, JSON.stringify(document));
    const report = JSON.parse(run('check', file, '--json'));
    assert.equal(report.triangles, 4);
    assert.equal(report.watertight ?? report.closed, true);
    assert.ok(Math.abs(report.volume - 1.5 * 2.25 * 3 / 6) < 1e-4, `volume ${report.volume}`);
  }
});
