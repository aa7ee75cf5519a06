// three-gpu-pathtracer on kerf's trees: the picture is the one that it makes of its own tree.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';
import * as THREE from 'three/webgpu';
import { MeshBVH } from 'three-mesh-bvh';
import { PathtracerBVHComputeData } from 'three-gpu-pathtracer/src/webgpu/nodes/PathtracerBVHComputeData.js';
import { init } from '../dist/index.js';
import { buildExpandedMeshBVH, buildMeshBVH } from '../dist/three-mesh-bvh.js';
import { complaintsOf, launch, serve, skipWithout } from './support/browser.mjs';
import { beams } from './support/meshes.mjs';

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const pictures = here('../../../build/web-pictures/');
const skip = skipWithout(here('../dist/index.js'), 'no package: scripts/web build');

/** The program of the README that has a path tracer. */
const [, program] = readFileSync(here('../README.md'), 'utf8').match(/```javascript\n([\s\S]*?)```/);

test('WebGLPathTracer, by the program of the README, draws the picture of its own tree, also after a mesh has moved', { skip }, async () => {
  const { server, root } = await serve({ '/modules/': here('../node_modules/'), '/package/': here('../dist/'), '/tests/': here('./') });
  const browser = await launch();
  try {
    const page = await browser.newPage(), complaints = complaintsOf(page);
    await page.goto(`${root}/tests/pathtracing/index.html`);
    const whole = `import { camera, renderer, scene } from 'scene';\n${program}\nrenderer.setAnimationLoop(null);\nexport { pathTracer };`;
    const seen = await page.evaluate(async (program) => {
      const { camera, differing, picture, scene, shown, sticks } = await import('scene');
      const { Scene } = await import('three');
      const { pathTracer } = await import(URL.createObjectURL(new Blob([program], { type: 'text/javascript' })));
      const { bvh, geometry } = pathTracer.setScene(scene, camera); // nothing has changed: the tree that it has
      const other = await picture(pathTracer); // its random numbers are the only ones of their kind
      const first = await picture(pathTracer);
      sticks.rotation.y = 0.3;
      pathTracer.setScene(scene, camera); // refits
      const moved = await picture(pathTracer);
      pathTracer.setScene(new Scene(), camera); // forgets the tree
      const own = pathTracer.setScene(scene, camera).bvh;
      const ownMoved = await picture(pathTracer);
      sticks.rotation.y = 0;
      pathTracer.setScene(scene, camera);
      const ownFirst = await picture(pathTracer);
      return {
        png: shown(first),
        triangles: geometry.index.count / 3,
        references: bvh.geometry.index.count / 3,
        another: own !== bvh,
        kept: pathTracer.setScene(scene, camera).bvh === own,
        pixels: first.length / 4,
        first: differing(first, ownFirst),
        moved: differing(moved, ownMoved),
        noise: differing(first, other),
        motion: differing(first, moved),
      };
    }, whole);
    mkdirSync(pictures, { recursive: true });
    writeFileSync(join(pictures, 'path-traced.png'), Buffer.from(seen.png.split(',')[1], 'base64'));
    assert.deepEqual(complaints, []);
    assert.ok(seen.references > 1.2 * seen.triangles, `${seen.references} of ${seen.triangles}`);
    assert.ok(seen.another && seen.kept);
    // Rays through an edge meet the triangle that comes first in the tree: at most one pixel in a hundred may differ.
    assert.ok(seen.first <= seen.pixels / 100, `${seen.first} pixels`);
    assert.ok(seen.moved <= seen.pixels / 100, `${seen.moved} pixels`);
    // Other paths would be seen in most of the picture.
    assert.ok(seen.noise > seen.pixels / 4 && seen.motion > seen.pixels / 4, `${seen.noise} and ${seen.motion} pixels`);
  } finally {
    await browser.close();
    server.close();
  }
});

await init();
const splits = { alpha: 0, maxReferenceRatio: 3 };
const mesh = beams(100), half = 3 * Math.floor(mesh.index.length / 6);
const materials = [new THREE.MeshStandardMaterial(), new THREE.MeshStandardMaterial()];

function geometryOfTwoMaterials() {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(mesh.index.slice(), 1));
  geometry.addGroup(0, half, 1);
  geometry.addGroup(half, 0, 1); // no triangles
  geometry.addGroup(half, mesh.index.length - half, 0);
  return geometry;
}
/** What WebGPUPathTracer gives to its shaders: it has to be asked for no picture, which needs a GPU. */
function packed(geometry, tree) {
  geometry.boundsTree = tree;
  const data = new PathtracerBVHComputeData(new THREE.Mesh(geometry, materials));
  data.update();
  return data;
}
/** Triangles by material, each as its three corners. */
function trianglesByMaterial({ groups, index }) {
  const found = [new Set(), new Set()];
  for (const { start, count, materialIndex } of groups)
    for (let i = start; i < start + count; i += 3) found[materialIndex].add([0, 1, 2].map((k) => index.getX(i + k)).join());
  return found;
}

test('WebGPUPathTracer gives its shaders an expanded tree as it is, one root for each material', () => {
  const geometry = geometryOfTwoMaterials(), tree = buildExpandedMeshBVH(geometry, { ...splits, groups: true });
  assert.equal(tree._roots.length, 2);
  assert.deepEqual(trianglesByMaterial(tree.geometry), trianglesByMaterial(geometry));
  assert.ok(tree.geometry.index.count > 1.2 * mesh.index.length);
  const { bvh, storage } = packed(tree.geometry, tree);
  assert.deepEqual(storage.index.proxyNode.value.array, tree.geometry.index.array);
  const nodes = (trees) => trees.flatMap(({ _roots }) => _roots).reduce((sum, root) => sum + root.byteLength / 32, 0);
  assert.equal(storage.nodes.proxyNode.value.array.length / 16, nodes([tree, bvh]));
});

test('WebGPUPathTracer builds its own tree in place of an indirect one', () => {
  const geometry = geometryOfTwoMaterials(), { storage } = packed(geometry, buildMeshBVH(geometry, splits));
  assert.equal(storage.index.proxyNode.value.array.length, mesh.index.length);
});

test('the roots of an expanded tree find the hits of a tree of three-mesh-bvh, with the material of each', () => {
  const geometry = geometryOfTwoMaterials(), own = new MeshBVH(geometryOfTwoMaterials());
  const sided = [new THREE.MeshBasicMaterial({ side: THREE.FrontSide }), new THREE.MeshBasicMaterial({ side: THREE.BackSide })];
  own.geometry.groups.splice(1, 1); // it makes no root for it
  const tree = buildExpandedMeshBVH(geometry, { ...splits, groups: true });
  let hits = 0;
  for (let i = 0; i < 300; ++i) {
    const at = (k) => new THREE.Vector3().fromArray(mesh.positions, 3 * ((k * 37) % (mesh.positions.length / 3)));
    const target = at(i).lerp(at(i + 1), 0.4), ray = new THREE.Ray(new THREE.Vector3(20, 15, 12 + i / 100));
    ray.direction.copy(target).sub(ray.origin).normalize();
    const a = tree.raycastFirst(ray, sided), b = own.raycastFirst(ray, sided);
    assert.equal(a?.distance, b?.distance);
    if (a) ++hits;
  }
  assert.ok(hits > 50, `${hits}`);
});
