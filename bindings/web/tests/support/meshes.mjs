// Meshes, rays and points that are the same in every run.

/** Numbers in [0, 1) from a seed (Mulberry32). */
export function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Slender boxes in all directions: what spatial splits are for. Twelve triangles a beam; closed, but they overlap. */
export function beams(count, seed = 1) {
  const next = random(seed);
  const positions = [], index = [];
  for (let beam = 0; beam < count; ++beam) {
    const center = [next() * 10, next() * 10, next() * 10];
    const axis = [next() - 0.5, next() - 0.5, next() - 0.5];
    const length = Math.hypot(...axis), w = axis.map((a) => a / length);
    const other = Math.abs(w[0]) < 0.5 ? [1, 0, 0] : [0, 1, 0];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const p = cross(w, other), u = p.map((a) => a / Math.hypot(...p)), v = cross(w, u);
    const half = [0.02 + 0.05 * next(), 0.02 + 0.05 * next(), 0.5 + 3 * next()];
    const first = positions.length / 3;
    for (let corner = 0; corner < 8; ++corner) {
      const s = [corner & 1, corner & 2, corner & 4].map((bit, i) => (bit ? half[i] : -half[i]));
      for (let axis = 0; axis < 3; ++axis) positions.push(center[axis] + s[0] * u[axis] + s[1] * v[axis] + s[2] * w[axis]);
    }
    for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
      index.push(first + a, first + b, first + c, first + a, first + c, first + d);
  }
  return { positions: new Float32Array(positions), index: new Uint32Array(index) };
}

/** A closed torus with bumps, `around` x `across` quadrangles. */
export function torus(around, across) {
  const positions = new Float32Array(3 * around * across), index = new Uint32Array(6 * around * across);
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < across; ++j) {
      const a = (2 * Math.PI * i) / around, b = (2 * Math.PI * j) / across;
      const r = 1 + 0.1 * Math.sin(11 * a) * Math.cos(7 * b);
      const at = i * across + j, wide = 3 + r * Math.cos(b);
      positions.set([wide * Math.cos(a), wide * Math.sin(a), r * Math.sin(b)], 3 * at);
      const right = ((i + 1) % around) * across + j, up = i * across + ((j + 1) % across);
      const both = ((i + 1) % around) * across + ((j + 1) % across);
      index.set([at, right, both, at, both, up], 6 * at);
    }
  }
  return { positions, index };
}

export function boundsOf({ positions }) {
  const lower = [Infinity, Infinity, Infinity], upper = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    lower[i % 3] = Math.min(lower[i % 3], positions[i]);
    upper[i % 3] = Math.max(upper[i % 3], positions[i]);
  }
  return { lower, upper };
}

/** Points in the box of a mesh, half as large again. */
export function pointsAround(mesh, count, seed = 2) {
  const { lower, upper } = boundsOf(mesh), next = random(seed);
  return new Float32Array(3 * count).map((_, i) => {
    const size = upper[i % 3] - lower[i % 3];
    return lower[i % 3] - 0.25 * size + 1.5 * size * next();
  });
}

/** Rays of unit length from such points, half of them towards a vertex: through edges and corners exactly. */
export function raysAround(mesh, count, seed = 3) {
  const points = pointsAround(mesh, count, seed), next = random(seed + 1);
  const rays = new Float32Array(6 * count);
  for (let i = 0; i < count; ++i) {
    const origin = points.subarray(3 * i, 3 * i + 3);
    const vertex = 3 * Math.floor((next() * mesh.positions.length) / 3);
    const target = i % 2 ? mesh.positions.subarray(vertex, vertex + 3) : origin.map((o) => o + next() - 0.5);
    rays.set(origin, 6 * i);
    rays.set(target.map((t, axis) => t - origin[axis]), 6 * i + 3);
  }
  return rays;
}

/** Rays from such points, each towards the inside of a triangle. */
export function raysAtTriangles(mesh, count, seed = 5) {
  const points = pointsAround(mesh, count, seed), next = random(seed + 1), rays = new Float32Array(6 * count);
  for (let i = 0; i < count; ++i) {
    const origin = points.subarray(3 * i, 3 * i + 3);
    const [a, b, c] = corners(mesh, Math.floor((next() * mesh.index.length) / 3));
    const u = 0.1 + 0.4 * next(), v = 0.1 + 0.4 * next();
    rays.set(origin, 6 * i);
    rays.set(origin.map((o, k) => (1 - u - v) * a[k] + u * b[k] + v * c[k] - o), 6 * i + 3);
  }
  return rays;
}

export function corners({ positions, index }, triangle) {
  return [0, 1, 2].map((k) => {
    const at = 3 * index[3 * triangle + k];
    return [positions[at], positions[at + 1], positions[at + 2]];
  });
}

export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
