// Where memory ends: WebAssembly has 4 GB of it at most.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bvh, init, RayBatch } from '../dist/index.js';

await init();

test('what does not fit is told, and the module goes on', () => {
  assert.throws(() => new RayBatch(2 ** 27), { code: 'out_of_memory' });
  assert.equal(Bvh.build({ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0] }).intersect([0.2, 0.2, 1], [0, 0, -1]).t, 1);
});

test('a build whose references would not fit into the memory fails as one without memory', () => {
  // 120 million triangles of one vertex each: 1.4 GB of index, and of references more than 32 bits of bytes.
  const mesh = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], index: new Uint32Array(3 * 120e6).fill(1) };
  mesh.index.set([0, 1, 2]);
  assert.throws(() => Bvh.build(mesh), { code: 'out_of_memory' });
});
