// The module answers as the library on this machine does, bit for bit. scripts/web builds the program that says how.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';
import { Bvh, init } from '../dist/index.js';
import { beams, pointsAround, raysAround, torus } from './support/meshes.mjs';

const program = fileURLToPath(new URL('../../../build/release/bin/kerf_web_answers', import.meta.url));
const skip = existsSync(program) || process.env.KERF_REQUIRE_NATIVE ? false : 'scripts/web builds the native program';

await init();

function answersOf(mesh, rays, points) {
  const bvh = Bvh.build(mesh);
  const hits = bvh.intersectMany(rays), counts = bvh.countHitsMany(rays);
  const closest = bvh.closestPointMany(points), distances = bvh.signedDistance(points);
  const answers = new Float32Array((5 * rays.length) / 6 + (8 * points.length) / 3 + 1);
  const integers = new Uint32Array(answers.buffer);
  let at = 0;
  for (let i = 0; i < counts.length; ++i) {
    answers.set([hits.t[i], hits.u[i], hits.v[i]], at);
    integers.set([hits.triangle[i], counts[i]], at + 3);
    at += 5;
  }
  for (let i = 0; i < distances.length; ++i) {
    answers.set([...closest.position.subarray(3 * i, 3 * i + 3), closest.distance[i], closest.u[i], closest.v[i]], at);
    integers[at + 6] = closest.triangle[i];
    answers[at + 7] = distances[i];
    at += 8;
  }
  integers[at] = bvh.statistics.references;
  return Buffer.from(answers.buffer);
}

for (const [name, mesh] of [['beams', beams(2000)], ['torus', torus(300, 150)]]) {
  test(`hits, counts, closest points and signed distances of ${name} are those of the native library`, { skip }, () => {
    const rays = raysAround(mesh, 50000), points = pointsAround(mesh, 5000);
    const folder = mkdtempSync(join(tmpdir(), 'kerf-web-'));
    try {
      const [from, to] = [join(folder, 'in'), join(folder, 'out')];
      const counts = [mesh.positions.length / 3, mesh.index.length / 3, rays.length / 6, points.length / 3];
      writeFileSync(from, Buffer.concat([new Uint32Array(counts), mesh.positions, mesh.index, rays, points]
        .map((array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength))));
      execFileSync(program, [from, to]);
      assert.ok(readFileSync(to).equals(answersOf(mesh, rays, points)));
    } finally {
      rmSync(folder, { recursive: true });
    }
  });
}
