// Builds in a worker.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bvh, buildInWorker, init } from '../dist/index.js';
import { raysAround, torus } from './support/meshes.mjs';

await init();
const mesh = torus(300, 200);

test('a build in a worker tells its progress and answers as one that is not', async () => {
  const told = [], rays = raysAround(mesh, 1000);
  const bvh = await buildInWorker(mesh, { onProgress: (fraction) => void told.push(fraction) });
  assert.deepEqual(bvh.intersectMany(rays), Bvh.build(mesh).intersectMany(rays));
  assert.ok(told.length > 5);
});

test('a build in a worker stops when it is told to', async () => {
  const controller = new AbortController();
  const stop = buildInWorker(mesh, { signal: controller.signal, onProgress: () => controller.abort(new RangeError('enough')) });
  await assert.rejects(stop, RangeError);
  await assert.rejects(buildInWorker(mesh, { onProgress: (fraction) => fraction < 0.3 }), { code: 'cancelled' });
  await assert.rejects(buildInWorker(mesh, { signal: AbortSignal.abort(new RangeError('before')) }), RangeError);
});

test('errors of a build in a worker are those of one that is not', async () => {
  await assert.rejects(buildInWorker({ positions: [0, 0, 0, 1, 0, NaN, 1, 1, 0] }), { name: 'KerfError', code: 'non_finite_vertex' });
});
