// An independent judge: is the mesh of a PLY file a solid in the eyes of the Manifold library?
//
//   node check.mjs MESH.ply      exit 0 only if the index mesh, as it is, is manifold and encloses a positive volume
//   node check.mjs --self-test   judges a cube, a cube with a hole and a cube inside out
//   node check.mjs --installed   exit 0 if the Manifold library can be loaded
//
// Reads binary little-endian PLY with float or double x, y, z and `list uchar int vertex_indices`.
import {readFileSync} from 'node:fs';

const SIZES = {
  char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2,
  int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8,
};

function parseHeader(bytes) {
  const end = bytes.indexOf('end_header\n');
  if (end < 0) throw new Error('no PLY header');
  const lines = bytes.toString('latin1', 0, end).split('\n').map((line) => line.trim());
  if (lines[0] !== 'ply' || lines[1] !== 'format binary_little_endian 1.0') throw new Error('not a binary little-endian PLY');
  const elements = [];
  for (const line of lines) {
    const words = line.split(/\s+/);
    if (words[0] === 'element') elements.push({name: words[1], count: Number(words[2]), properties: []});
    if (words[0] === 'property') elements.at(-1).properties.push(words.slice(1));
  }
  return {elements, body: end + 'end_header\n'.length};
}

function readVertices(bytes, at, element) {
  let stride = 0;
  const fields = {};
  for (const [type, name] of element.properties) {
    if (!(type in SIZES)) throw new Error(`vertex property ${name} has the type ${type}`);
    fields[name] = {offset: stride, wide: SIZES[type] === 8};
    stride += SIZES[type];
  }
  const positions = new Float32Array(3 * element.count);
  for (let i = 0; i < element.count; ++i) {
    ['x', 'y', 'z'].forEach((axis, k) => {
      const {offset, wide} = fields[axis];
      const place = at + i * stride + offset;
      positions[3 * i + k] = wide ? bytes.readDoubleLE(place) : bytes.readFloatLE(place);
    });
  }
  return {positions, end: at + element.count * stride};
}

function readTriangles(bytes, at, element) {
  const [list, countType, indexType] = element.properties[0];
  if (element.properties.length !== 1 || list !== 'list' || SIZES[countType] !== 1 || SIZES[indexType] !== 4)
    throw new Error('faces are not `list uchar int vertex_indices`');
  const triangles = new Uint32Array(3 * element.count);
  for (let i = 0; i < element.count; ++i, at += 13) {
    if (bytes[at] !== 3) throw new Error(`face ${i} has ${bytes[at]} corners`);
    for (let k = 0; k < 3; ++k) triangles[3 * i + k] = bytes.readUInt32LE(at + 1 + 4 * k);
  }
  return triangles;
}

function readPly(path) {
  const bytes = readFileSync(path);
  const {elements, body} = parseHeader(bytes);
  const [vertex, face] = elements;
  if (vertex?.name !== 'vertex' || face?.name !== 'face') throw new Error('expected the elements vertex and face');
  const {positions, end} = readVertices(bytes, body, vertex);
  return {vertProperties: positions, triVerts: readTriangles(bytes, end, face)};
}

async function loadManifold() {
  const {default: load} = await import('manifold-3d');
  const library = await load();
  library.setup();
  return library;
}

/** Judges the index mesh as it is: no vertices are merged. */
function judge({Manifold, Mesh}, {vertProperties, triVerts}) {
  const verdict = {status: 'NoError', vertices: vertProperties.length / 3, triangles: triVerts.length / 3};
  try {
    const solid = new Manifold(new Mesh({numProp: 3, vertProperties, triVerts}));
    verdict.status = String(solid.status());
    verdict.genus = solid.genus();
    verdict.volume = solid.volume();
    solid.delete();
  } catch (error) {
    verdict.status = error.code ?? error.message ?? String(error);
  }
  verdict.ok = verdict.status === 'NoError' && verdict.triangles > 0 && verdict.volume > 0;
  return verdict;
}

function selfTest(library) {
  const vertProperties = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1]);
  const cube = [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
  const insideOut = cube.map((_, i) => cube[i - (i % 3) + (2 - (i % 3))]);
  const cases = [
    ['a cube', cube, true],
    ['a cube with a hole', cube.slice(3), false],
    ['a cube inside out', insideOut, false],
  ];
  const wrong = cases.filter(([name, triangles, good]) => {
    const verdict = judge(library, {vertProperties, triVerts: new Uint32Array(triangles)});
    console.log(name, JSON.stringify(verdict));
    return verdict.ok !== good;
  });
  return wrong.length === 0;
}

const [argument] = process.argv.slice(2);
if (!argument) {
  console.error('usage: node check.mjs MESH.ply | --self-test | --installed');
  process.exit(2);
}
const library = await loadManifold();
let ok = true;
if (argument === '--self-test') {
  ok = selfTest(library);
} else if (argument !== '--installed') {
  const verdict = judge(library, readPly(argument));
  console.log(JSON.stringify(verdict));
  ok = verdict.ok;
}
process.exit(ok ? 0 : 1);
