// The worker: builds hierarchies, traces pictures, and compares.
import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three';
import { MeshBVH, SAH } from 'three-mesh-bvh';
import { Bvh, init, none, packTree, RayBatch } from '../dist/index.js';

let mesh, bvh, batch, asked = 0;
const ready = init();

const options = ({ builder, alpha }) => ({ builder, alpha, nonFinite: 'skip' });

function rayOf(camera, width, height, px, py, out, at) {
  const { eye, right, up, forward, tangent } = camera;
  const x = (2 * ((px + 0.5) / width) - 1) * tangent * (width / height), y = (1 - 2 * ((py + 0.5) / height)) * tangent;
  const d = [0, 1, 2].map((k) => forward[k] + x * right[k] + y * up[k]), length = Math.hypot(...d);
  for (let k = 0; k < 3; ++k) {
    out[at + k] = eye[k];
    out[at + 3 + k] = d[k] / length;
  }
}

/** Rays of a picture in tiles of eight by eight pixels, which are near one another. */
function fillRays(camera, width, height, rays, pixels) {
  let i = 0;
  for (let ty = 0; ty < height; ty += 8)
    for (let tx = 0; tx < width; tx += 8)
      for (let y = ty; y < Math.min(ty + 8, height); ++y)
        for (let x = tx; x < Math.min(tx + 8, width); ++x, ++i) {
          pixels[i] = y * width + x;
          rayOf(camera, width, height, x, y, rays, 6 * i);
        }
}

function batchOf(count) {
  if (batch?.count === count) return batch;
  batch?.dispose();
  return (batch = new RayBatch(count));
}

function normalOf(triangle) {
  const { positions: p, index } = mesh, [a, b, c] = [0, 1, 2].map((k) => 3 * index[3 * triangle + k]);
  const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
  const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], length = Math.hypot(...n) || 1;
  return n.map((x) => x / length);
}

const sun = [0.36, -0.48, 0.8];
const ground = [42, 45, 49];

// From few steps to many: dark, red, yellow, white.
function heat(x) {
  const at = Math.min(1, x);
  return [255 * Math.min(1, 2.6 * at), 255 * Math.min(1, Math.max(0, 2.2 * at - 0.6)), 255 * Math.min(1, Math.max(0, 4 * at - 3)) + 25 * (1 - at)];
}

function shade(camera, width, height, mode) {
  const count = width * height, pixels = new Uint32Array(count), image = new Uint8ClampedArray(4 * count).fill(255);
  const rays = batchOf(count);
  fillRays(camera, width, height, rays.rays, pixels);
  const begin = performance.now();
  bvh.intersectMany(rays);
  const seconds = (performance.now() - begin) / 1000;
  const t = rays.t.slice(), triangle = rays.triangle.slice(), directions = rays.rays.slice();
  if (mode === 'steps') {
    const { steps, triangleTests } = bvh.countSteps(rays);
    for (let i = 0; i < count; ++i) image.set(heat((steps[i] + triangleTests[i]) / 150), 4 * pixels[i]);
    return { image, seconds, count };
  }
  const hits = [];
  const normals = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    image.set(ground, 4 * pixels[i]);
    if (triangle[i] === none) continue;
    const d = directions.subarray(6 * i + 3, 6 * i + 6);
    let n = normalOf(triangle[i]);
    if (n[0] * d[0] + n[1] * d[1] + n[2] * d[2] > 0) n = n.map((x) => -x);
    normals.set(n, 3 * i);
    hits.push(i);
  }
  const samples = mode === 'ao' ? 16 : 1, chunk = new Float32Array(6 * samples * hits.length), size = camera.size;
  let seed = 9;
  const next = () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) | 0;
    return (seed >>> 8) / 16777216;
  };
  hits.forEach((i, h) => {
    const n = normals.subarray(3 * i, 3 * i + 3), o = directions.subarray(6 * i, 6 * i + 6);
    const from = [0, 1, 2].map((k) => o[k] + t[i] * o[k + 3] + 1e-4 * size * n[k]);
    for (let s = 0; s < samples; ++s) {
      let d = sun;
      if (mode === 'ao') {
        const z = 2 * next() - 1, a = 2 * Math.PI * next(), r = Math.sqrt(1 - z * z);
        d = [n[0] + r * Math.cos(a), n[1] + r * Math.sin(a), n[2] + z].map((x) => 0.25 * size * x);
      }
      chunk.set([...from, ...d], 6 * (h * samples + s));
    }
  });
  const tMax = mode === 'ao' ? 1 : Infinity;
  const occluded = bvh.occludedMany({ origins: plane(chunk, 0), directions: plane(chunk, 3), tMax });
  hits.forEach((i, h) => {
    const n = normals.subarray(3 * i, 3 * i + 3);
    let light;
    if (mode === 'ao') {
      let open = 0;
      for (let s = 0; s < samples; ++s) open += 1 - occluded[h * samples + s];
      light = open / samples;
    } else {
      const facing = Math.max(0, n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2]);
      light = 0.25 + 0.15 * n[2] + (occluded[h] ? 0 : 0.6 * facing);
    }
    const shown = 255 * Math.sqrt(Math.max(0, light));
    image.set([shown, 0.97 * shown, 0.92 * shown], 4 * pixels[i]);
  });
  return { image, seconds, count };
}

function plane(rays, from) {
  const out = new Float32Array(rays.length / 2);
  for (let i = 0; i < out.length; ++i) out[i] = rays[6 * Math.floor(i / 3) + from + (i % 3)];
  return out;
}

const best = (run, repeats = 3) => {
  let least = Infinity;
  for (let i = 0; i < repeats; ++i) {
    const begin = performance.now();
    run();
    least = Math.min(least, performance.now() - begin);
  }
  return least;
};
const mean = (numbers) => numbers.reduce((a, b) => a + b, 0) / numbers.length;

function compare(camera, alpha) {
  const side = 192, count = side * side, rays = new Float32Array(6 * count), rows = [];
  fillRays(camera, side, side, rays, new Uint32Array(count));
  for (const builder of ['sbvh', 'bvh', 'esc', 'evh']) {
    let other;
    const build = best(() => {
      other?.dispose();
      other = Bvh.build(mesh, options({ builder, alpha }));
    }, 2);
    const { cost } = packTree(mesh, options({ builder, alpha }));
    const { steps, triangleTests } = other.countSteps(rays);
    const trace = best(() => other.intersectMany(rays));
    rows.push({ builder: `kerf, ${builder}`, cost, references: other.statistics.references, build, steps: mean(steps), tests: mean(triangleTests), rate: count / trace / 1000 });
    other.dispose();
    postMessage({ rows });
  }
  const geometry = () => new BufferGeometry().setAttribute('position', new BufferAttribute(mesh.positions, 3)).setIndex(new BufferAttribute(mesh.index.slice(), 1));
  let theirs;
  const build = best(() => { theirs = new MeshBVH(geometry(), { strategy: SAH }); }, 2);
  const list = Array.from({ length: count }, (_, i) => new Ray(new Vector3(...rays.subarray(6 * i, 6 * i + 3)), new Vector3(...rays.subarray(6 * i + 3, 6 * i + 6))));
  const trace = best(() => { for (const ray of list) theirs.raycastFirst(ray, DoubleSide); }, 2);
  rows.push({ builder: 'three-mesh-bvh, SAH', references: mesh.index.length / 3, build, rate: count / trace / 1000 });
  postMessage({ rows, done: true });
}

onmessage = async ({ data }) => {
  try {
    await ready;
    if (data.mesh) mesh = data.mesh;
    if (data.build) {
      const begin = performance.now();
      const made = Bvh.build(mesh, { ...options(data.build), onProgress: (progress) => postMessage({ progress }) });
      const build = performance.now() - begin;
      bvh?.dispose();
      bvh = made;
      postMessage({ statistics: bvh.statistics, build });
    }
    if (data.level !== undefined) postMessage({ level: data.level, boxes: bvh && data.level >= 0 ? bvh.boxes(data.level) : new Float32Array(0) });
    if (data.picture && bvh) {
      const own = ++asked, { camera, width, height, mode, number } = data.picture;
      // A rough picture first, so that turning the model feels immediate.
      for (const part of [4, 1]) {
        await new Promise((resolve) => setTimeout(resolve));
        if (own !== asked) return;
        const w = Math.ceil(width / part), h = Math.ceil(height / part);
        const { image, seconds, count } = shade(camera, w, h, mode);
        postMessage({ image, width: w, height: h, seconds, count, final: part === 1, number, mode }, [image.buffer]);
      }
    }
    if (data.compare) compare(data.compare.camera, data.compare.alpha);
  } catch (error) {
    postMessage({ error: error.message });
  }
};
