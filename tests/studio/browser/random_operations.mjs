// Operations of all kinds at random, from a seed, for a scene around the origin of about the size 2.

/** Mulberry32: a small generator whose numbers are the same everywhere. */
export function randomFrom(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const size = 400;

/** Looks along -z from the outside, or along -x, orthographically. */
function camera(random) {
  const fromSide = random() < 0.5;
  const view = fromSide ? [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, -4, 0, 0, 0, 1] : [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -4, 0, 0, 0, 1];
  return { view, projection: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, -0.25, -1, 0, 0, 0, 1], width: size, height: size };
}

const between = (random, low, high) => low + (high - low) * random();
const place = random => [between(random, 0.3, 0.7) * size, between(random, 0.3, 0.7) * size];

function rectangle(random, extent) {
  const [x, y] = place(random);
  return [x, y, x + extent * size, y + extent * size];
}

const kinds = {
  stroke: random => ({ op: 'guide', camera: camera(random), stroke: [place(random), place(random)], interval: 0.1,
    normals: random() < 0.5 ? 'cloud' : 'stroke' }),
  area: random => ({ op: 'guide', camera: camera(random), rectangle: rectangle(random, 0.08), interval: 0.1 }),
  remove: random => ({ op: 'remove', camera: camera(random), rectangle: rectangle(random, 0.06),
    originals: random() < 0.3, layers: random() < 0.5 ? 'front' : 'through' }),
  flip: random => ({ op: 'flip', camera: camera(random), rectangle: rectangle(random, 0.02), layers: 'front' }),
  insert: random => ({ op: 'insert', shape: 'sphere', points: 500, scale: 0.2,
    translation: [between(random, -0.8, 0.8), between(random, -0.8, 0.8), between(random, -0.8, 0.8)] }),
  deform: random => ({ op: 'deform', handles: [
    { region: { half_space: { point: [0, -0.5, 0], normal: [0, -1, 0] } } },
    { region: { half_space: { point: [0, 0.5, 0], normal: [0, 1, 0] } },
      rigid: { axis: [0, 0, 1], point: [0, 0, 0], degrees: between(random, -8, 8) } }] }),
  boolean: random => ({ op: 'boolean', operation: ['union', 'difference'][Math.floor(2 * random())],
    with: { shape: 'sphere', points: 2000 }, scale: 0.15,
    translation: [between(random, -0.9, 0.9), between(random, -0.9, 0.9), 0] }),
  orient: random => ({ op: 'orient', method: random() < 0.5 ? 'turn' : 'estimate' }),
  options: random => ({ op: 'options', depth: 5 + Math.floor(2 * random()), screening: between(random, 0.5, 4) }),
};

/** How often each kind is drawn. Those that begin the field anew cost more. */
const shares = { stroke: 6, area: 4, remove: 5, flip: 2, insert: 2, deform: 1, boolean: 1, orient: 1, options: 2 };
const urn = Object.entries(shares).flatMap(([kind, share]) => Array(share).fill(kind));

/** The next operation. */
export function operationFrom(random) { return kinds[urn[Math.floor(urn.length * random())]](random); }
