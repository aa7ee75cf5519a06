// What a hierarchy answers, against every triangle one by one in double precision.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bvh, init, KerfError, none, RayBatch } from '../dist/index.js';
import { beams, corners, cross, dot, pointsAround, raysAround, sub, torus } from './support/meshes.mjs';

await init();

// The library decides edges watertight, in the rounding of floats; doubles need not agree closer to an edge than this.
const margin = 1e-4;

/** Where a ray crosses the plane of a triangle, and whether that is inside, or too near an edge to tell. */
function crossing(mesh, triangle, origin, direction) {
  const [a, b, c] = corners(mesh, triangle).map((p) => sub(p, origin));
  const volumes = [dot(direction, cross(b, c)), dot(direction, cross(c, a)), dot(direction, cross(a, b))];
  const sum = volumes[0] + volumes[1] + volumes[2];
  const t = dot(cross(sub(b, a), sub(c, a)), a) / sum;
  const least = Math.min(...volumes.map((v) => v / sum));
  return { t, inside: least > margin, open: Math.abs(least) <= margin || !Number.isFinite(t) };
}

function closestOfAll(mesh, origin, direction) {
  let best = { t: Infinity, triangle: none }, open = false;
  for (let i = 0; i < mesh.index.length / 3; ++i) {
    const at = crossing(mesh, i, origin, direction);
    if (at.open) open = true;
    if (at.inside && at.t >= 0 && at.t < best.t) best = { t: at.t, triangle: i };
  }
  return { ...best, open };
}

test('a better tree over beams takes fewer steps to the same hits', () => {
  const mesh = beams(400), rays = raysAround(mesh, 2000);
  const traced = (quality) => {
    const bvh = Bvh.build(mesh, { quality }), { t, triangle } = bvh.intersectMany(rays);
    const steps = bvh.countSteps(rays).steps.reduce((sum, count) => sum + count, 0);
    bvh.dispose();
    return { hits: { t, triangle }, steps };
  };
  const fast = traced('fast'), high = traced('high'), best = traced('best');
  assert.deepEqual(high.hits, fast.hits);
  assert.deepEqual(best.hits, fast.hits);
  assert.ok(best.steps < fast.steps, `${best.steps} steps of ${fast.steps}`);
});

for (const [name, mesh] of [['beams', beams(60)], ['torus', torus(40, 20)]]) {
  test(`the closest hits among ${name} are those of all triangles one by one`, () => {
    const bvh = Bvh.build(mesh), rays = raysAround(mesh, 1000);
    const hits = bvh.intersectMany(rays), occluded = bvh.occludedMany(rays);
    let compared = 0;
    for (let i = 0; i < rays.length / 6; ++i) {
      const origin = [...rays.subarray(6 * i, 6 * i + 3)], direction = [...rays.subarray(6 * i + 3, 6 * i + 6)];
      const one = bvh.intersect(origin, direction);
      assert.equal(one?.t ?? Infinity, hits.t[i]);
      assert.equal(one?.triangle ?? none, hits.triangle[i]);
      assert.equal(occluded[i], one ? 1 : 0);
      assert.equal(bvh.occluded(origin, direction), one !== null);
      const expected = closestOfAll(mesh, origin, direction);
      if (expected.open) continue; // through an edge, which doubles do not decide
      ++compared;
      assert.equal(hits.triangle[i], expected.triangle);
      if (one) assert.ok(Math.abs(one.t - expected.t) <= 1e-6 * expected.t);
    }
    assert.ok(compared > 400);
    bvh.dispose();
  });

  test(`all hits among ${name} are in order, once each, and as many as counted`, () => {
    const bvh = Bvh.build(mesh), rays = raysAround(mesh, 400);
    const lists = bvh.allHitsMany(rays), counts = bvh.countHitsMany(rays);
    for (let i = 0; i < counts.length; ++i) {
      const hits = lists.items.slice(lists.offsets[i], lists.offsets[i + 1]);
      assert.equal(hits.length, counts[i]);
      assert.deepEqual(hits, bvh.allHits(rays.subarray(6 * i, 6 * i + 3), rays.subarray(6 * i + 3, 6 * i + 6)));
      assert.equal(new Set(hits.map((hit) => hit.triangle)).size, hits.length);
      for (let k = 1; k < hits.length; ++k) assert.ok(hits[k - 1].t <= hits[k].t);
    }
    bvh.dispose();
  });

  test(`no vertex of ${name} is nearer than the closest point, which lies on its triangle`, () => {
    const bvh = Bvh.build(mesh), points = pointsAround(mesh, 200);
    const found = bvh.closestPointMany(points), near = bvh.nearest(points, 3);
    for (let i = 0; i < points.length / 3; ++i) {
      const point = points.subarray(3 * i, 3 * i + 3), position = found.position.subarray(3 * i, 3 * i + 3);
      assert.ok(Math.abs(Math.hypot(...sub(point, position)) - found.distance[i]) < 1e-5);
      const [a, b, c] = corners(mesh, found.triangle[i]), u = found.u[i], v = found.v[i];
      for (let k = 0; k < 3; ++k)
        assert.ok(Math.abs((1 - u - v) * a[k] + u * b[k] + v * c[k] - position[k]) < 1e-5);
      for (let k = 0; k < mesh.positions.length; k += 3)
        assert.ok(Math.hypot(...sub(point, mesh.positions.subarray(k, k + 3))) >= found.distance[i] - 1e-6);
      const one = bvh.closestPoint(point);
      assert.equal(one.triangle, found.triangle[i]);
      assert.equal(near.items[near.offsets[i]].triangle, one.triangle);
      assert.ok(bvh.within(point, one.distance * 1.001).items.some((at) => at.triangle === one.triangle));
    }
    bvh.dispose();
  });
}

test('points are inside the torus exactly where its signed distance is negative', () => {
  const mesh = torus(64, 32), bvh = Bvh.build(mesh), points = pointsAround(mesh, 500);
  const inside = bvh.contains(points), distances = bvh.signedDistance(points), side = bvh.side(points);
  assert.ok(inside.includes(1) && inside.includes(0));
  for (let i = 0; i < inside.length; ++i) {
    assert.equal(inside[i] === 1, distances[i] < 0);
    assert.equal(inside[i] === 1, side[i] === 2);
    const [x, y, z] = points.subarray(3 * i, 3 * i + 3), r = Math.hypot(Math.hypot(x, y) - 3, z);
    if (r < 0.85) assert.equal(inside[i], 1);
    if (r > 1.11) assert.equal(inside[i], 0);
  }
});

test('a box holds the triangles that have a vertex in it', () => {
  const mesh = beams(50), bvh = Bvh.build(mesh), box = new Float32Array([2, 2, 2, 6, 7, 5]);
  const found = new Set(bvh.trianglesIn(box).items);
  for (let i = 0; i < mesh.index.length / 3; ++i) {
    if (corners(mesh, i).some((p) => p.every((x, axis) => x >= box[axis] && x <= box[3 + axis]))) assert.ok(found.has(i));
  }
});

test('a mesh touches itself moved aside, and not itself far away', () => {
  const bvh = Bvh.build(torus(24, 12));
  const moved = (x) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
  assert.equal(bvh.touches(bvh, moved(1)), true);
  assert.equal(bvh.touches(bvh, moved(100)), false);
  assert.ok(bvh.touchingPairs(bvh, moved(1)).length > 0);
  assert.equal(bvh.touchingPairs(bvh, moved(100)).length, 0);
});

test('rays see the parts of a mesh that they are told to, from the side that they are told', () => {
  const mesh = torus(32, 16), bvh = Bvh.build(mesh), triangles = mesh.index.length / 3, rays = raysAround(mesh, 300);
  for (const side of ['front', 'back', 'both']) {
    const parts = [{ first: 0, last: triangles / 2, side }], hits = bvh.intersectMany(rays, { parts });
    for (let i = 0; i < rays.length / 6; ++i) {
      const origin = rays.subarray(6 * i, 6 * i + 3), direction = rays.subarray(6 * i + 3, 6 * i + 6);
      const expected = bvh.allHits(origin, direction).find((hit) => hit.triangle < triangles / 2 &&
        (side === 'both' || bvh.isFront(origin, direction, hit.triangle) === (side === 'front')));
      const one = bvh.intersect(origin, direction, 0, Infinity, { parts });
      assert.equal(one?.triangle ?? none, hits.triangle[i]);
      if (i % 2 === 0) assert.equal(one?.triangle, expected?.triangle); // those through vertices meet several at once
      assert.equal(bvh.occluded(origin, direction, 0, Infinity, { parts }), one !== null);
    }
  }
  assert.equal(bvh.intersect([0, 0, 9], [0.3, 0, -1], 0, Infinity, { parts: [] }), null);
});

test('rays and hits in the memory of the module are the same as copies', () => {
  const mesh = torus(32, 16), bvh = Bvh.build(mesh), rays = raysAround(mesh, 500);
  const batch = new RayBatch(500);
  batch.rays.set(rays);
  const copies = bvh.intersectMany(rays);
  bvh.intersectMany(batch);
  for (const field of ['t', 'u', 'v', 'triangle']) assert.deepEqual(batch[field], copies[field]);
  batch.dispose();
  assert.throws(() => batch.rays, /disposed/);
});

test('origins and directions may stand apart, with one origin for all and limits for each', () => {
  const mesh = torus(32, 16), bvh = Bvh.build(mesh);
  const origins = new Float32Array([0, 0, 9]), directions = new Float32Array([0.3, 0, -1, 0, 0.3, -1]);
  const free = bvh.intersectMany({ origins, directions });
  const cut = bvh.intersectMany({ origins, directions, tMin: 0, tMax: new Float32Array([Infinity, 1]) });
  assert.equal(cut.t[0], free.t[0]);
  assert.equal(cut.triangle[1], none);
  assert.throws(() => bvh.intersectMany({ origins, directions, tMin: new Float32Array(3) }), /3 limits tMin for 2 rays/);
});

test('a mesh without an index is that of vertices in order', () => {
  const mesh = beams(10);
  const soup = new Float32Array([...mesh.index].flatMap((at) => [...mesh.positions.subarray(3 * at, 3 * at + 3)]));
  const rays = raysAround(mesh, 200);
  assert.deepEqual(Bvh.build({ positions: soup }).intersectMany(rays), Bvh.build(mesh).intersectMany(rays));
});

test('a saved hierarchy answers as before, and a damaged one is refused', () => {
  const mesh = beams(30), bvh = Bvh.build(mesh), rays = raysAround(mesh, 200), file = bvh.save();
  assert.deepEqual(Bvh.load(file).intersectMany(rays), bvh.intersectMany(rays));
  for (let at = 0; at < file.length; at += 1 + (file.length >> 6)) {
    const damaged = file.slice();
    damaged[at] ^= 0x10;
    assert.throws(() => Bvh.load(damaged), { name: 'KerfError', code: 'bad_format' });
  }
  assert.throws(() => Bvh.load(file.subarray(0, 100)), { code: 'bad_format' });
});

test('a file comes by fetch, in parts', async () => {
  const mesh = beams(30), bvh = Bvh.build(mesh), rays = raysAround(mesh, 200), file = bvh.save();
  const answer = (length) => new Response(new Blob([file]).stream(), { headers: length ? { 'content-length': `${length}` } : {} });
  for (const length of [file.length, 0]) {
    const loaded = await Bvh.fetch(answer(length));
    assert.deepEqual(loaded.intersectMany(rays), bvh.intersectMany(rays));
  }
  await assert.rejects(Bvh.fetch(answer(10)), { code: 'io' });
  await assert.rejects(Bvh.fetch(new Response('', { status: 404 })), { code: 'io', message: /404/ });
});

test('errors are exceptions with a code and the sentence of the library', () => {
  const positions = [0, 0, 0, 1, 0, NaN, 1, 1, 0];
  assert.throws(() => Bvh.build({ positions }), { code: 'non_finite_vertex', message: /vertex 1 of mesh 0/ });
  assert.equal(Bvh.build({ positions }, { nonFinite: 'skip' }).statistics.nonFiniteTriangles, 1);
  assert.throws(() => Bvh.build({ positions: [0, 0, 0], index: [0, 0, 7] }), { code: 'index_out_of_range' });
  assert.throws(() => Bvh.build({ positions }, { alpha: 2 }), KerfError);
  assert.throws(() => Bvh.build({ positions: [1, 2] }), { code: 'invalid_argument' });
  assert.throws(() => Bvh.build({ positions }, { builder: 'fast' }), /"fast": sbvh, bvh, esc, evh/);
  assert.throws(() => Bvh.build({ positions }, { quality: 'sbvh' }), /"sbvh": fast, high, best/);
  const bvh = Bvh.build({ positions: [0, 0, 0, 1, 0, 0, 1, 1, 0] });
  bvh.dispose();
  bvh.dispose();
  assert.throws(() => bvh.intersect([0, 0, 1], [0, 0, -1]), /disposed/);
});

test('progress rises, and stops the build where it answers false or throws', () => {
  const mesh = torus(300, 100), told = [];
  Bvh.build(mesh, { onProgress: (fraction) => void told.push(fraction) });
  assert.ok(told.length > 5);
  assert.deepEqual(told, told.toSorted((a, b) => a - b));
  assert.throws(() => Bvh.build(mesh, { onProgress: (fraction) => fraction < 0.5 }), { code: 'cancelled' });
  assert.throws(() => Bvh.build(mesh, { onProgress: () => { throw new RangeError('mine'); } }), RangeError);
});

test('memory that builds and answers take is given back', () => {
  const mesh = torus(100, 50), rays = raysAround(mesh, 2000);
  const once = () => {
    const bvh = Bvh.build(mesh);
    bvh.intersectMany(rays);
    bvh.allHitsMany(rays);
    assert.throws(() => Bvh.build(mesh, { onProgress: () => false }), { code: 'cancelled' });
    const size = bvh.boxes(0).buffer.byteLength;
    bvh.dispose();
    return size;
  };
  for (let i = 0; i < 5; ++i) once();
  const before = new RayBatch(1).rays.buffer.byteLength;
  for (let i = 0; i < 100; ++i) once();
  assert.equal(new RayBatch(1).rays.buffer.byteLength, before);
});

test('the boxes of a level lie in those of the root', () => {
  const bvh = Bvh.build(beams(100)), { lower, upper } = bvh.statistics.bounds;
  assert.deepEqual([...bvh.boxes(0)], [...lower, ...upper]);
  for (const level of [1, 2, 5]) {
    const boxes = bvh.boxes(level);
    assert.ok(boxes.length > 6);
    for (let i = 0; i < boxes.length; ++i) assert.ok(boxes[i] >= lower[i % 3] && boxes[i] <= upper[i % 3]);
  }
});

test('counted steps are those of rays that go through nodes', () => {
  const bvh = Bvh.build(beams(100)), rays = raysAround(beams(100), 100);
  const { steps, triangleTests } = bvh.countSteps(rays);
  assert.ok(Math.max(...steps) > 3 && Math.max(...triangleTests) > 3);
});
