// kerf's trees in three-mesh-bvh's buffers: each call of that library on them, beside the same call on its own tree.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as THREE from 'three';
import { ADDITION, Brush, computeMeshVolume, Evaluator, INTERSECTION, SUBTRACTION } from 'three-bvh-csg';
import { CONTAINED, INTERSECTED, MeshBVH, MeshBVHUniformStruct, NOT_INTERSECTED, SAH } from 'three-mesh-bvh';
import { init } from '../dist/index.js';
import { acceleratedRaycast } from '../dist/three.js';
import { buildExpandedMeshBVH, buildMeshBVH, serializedTree } from '../dist/three-mesh-bvh.js';
import { beams, boundsOf, pointsAround, raysAtTriangles, torus } from './support/meshes.mjs';

await init();

function geometryOf(mesh) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(mesh.index.slice(), 1));
  return geometry;
}

// Splits everywhere: many triangles stand in several leaves.
const splits = { alpha: 0, maxReferenceRatio: 3 };
const mesh = beams(100);
const geometry = geometryOf(mesh);
const kerf = buildMeshBVH(geometry, splits);
const own = new MeshBVH(geometryOf(mesh), { strategy: SAH, indirect: true });
const triangles = mesh.index.length / 3;

function* rays(count) {
  const numbers = raysAtTriangles(mesh, count);
  for (let i = 0; i < count; ++i) {
    const direction = new THREE.Vector3(...numbers.subarray(6 * i + 3, 6 * i + 6)).normalize();
    yield new THREE.Ray(new THREE.Vector3(...numbers.subarray(6 * i, 6 * i + 3)), direction);
  }
}
const sorted = (numbers) => [...numbers].sort((a, b) => a - b);

test('the tree repeats triangles, leaves none out, and is as deep as shaders can go', () => {
  const { indirectBuffer, roots } = serializedTree(geometry, splits);
  assert.equal(new Set(indirectBuffer).size, triangles);
  assert.ok(indirectBuffer.length > 1.2 * triangles);
  const words = new Uint32Array(roots[0]), halves = new Uint16Array(roots[0]), floats = new Float32Array(roots[0]);
  let next = 0, deepest = 0;
  const walk = (node, depth) => {
    deepest = Math.max(deepest, depth);
    const at = 8 * node;
    for (let axis = 0; axis < 3; ++axis) assert.ok(floats[at + axis] <= floats[at + 3 + axis]);
    if (halves[2 * at + 15] === 0xffff) {
      assert.equal(words[at + 6], next); // the triangles of a subtree stand side by side, as CONTAINED needs
      next += halves[2 * at + 14];
      return node + 1;
    }
    const right = node + words[at + 6], axis = words[at + 7];
    const middle = (child) => floats[8 * child + axis] + floats[8 * child + 3 + axis];
    assert.ok(middle(node + 1) <= middle(right) + 1e-5);
    for (const child of [node + 1, right]) {
      for (let k = 0; k < 3; ++k) {
        assert.ok(floats[8 * child + k] >= floats[at + k]);
        assert.ok(floats[8 * child + 3 + k] <= floats[at + 3 + k]);
      }
    }
    assert.equal(walk(node + 1, depth + 1), right);
    return walk(right, depth + 1);
  };
  assert.equal(walk(0, 0), roots[0].byteLength / 32);
  assert.equal(next, indirectBuffer.length);
  assert.ok(deepest < 60);
});

test('raycastFirst: the same hits', () => {
  for (const side of [THREE.FrontSide, THREE.BackSide, THREE.DoubleSide]) {
    let hits = 0;
    for (const ray of rays(300)) {
      const a = kerf.raycastFirst(ray, side), b = own.raycastFirst(ray, side);
      assert.equal(a?.faceIndex, b?.faceIndex);
      assert.equal(a?.distance, b?.distance);
      if (a) ++hits;
    }
    assert.ok(hits > 200);
  }
});

test('raycast: the same hits, some of them several times', () => {
  let repeated = 0;
  for (const ray of rays(300)) {
    const a = kerf.raycast(ray, THREE.DoubleSide).map((hit) => hit.faceIndex);
    const b = own.raycast(ray, THREE.DoubleSide).map((hit) => hit.faceIndex);
    assert.deepEqual(sorted(new Set(a)), sorted(b));
    repeated += a.length - b.length;
  }
  assert.ok(repeated > 0);
});

test('acceleratedRaycast of kerf takes such a tree, and firstHitOnly repeats nothing', () => {
  const object = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
  geometry.boundsTree = kerf;
  for (const ray of rays(100)) {
    const caster = new THREE.Raycaster(ray.origin, ray.direction), found = [];
    caster.firstHitOnly = true;
    acceleratedRaycast.call(object, caster, found);
    assert.deepEqual(found.map((hit) => hit.faceIndex), [own.raycastFirst(ray, THREE.DoubleSide)].filter(Boolean).map((hit) => hit.faceIndex));
  }
});

test('closestPointToPoint: the same distances', () => {
  const points = pointsAround(mesh, 200);
  for (let i = 0; i < points.length; i += 3) {
    const point = new THREE.Vector3(...points.subarray(i, i + 3));
    const a = kerf.closestPointToPoint(point, {}), b = own.closestPointToPoint(point, {});
    assert.ok(Math.abs(a.distance - b.distance) < 1e-9);
  }
});

test('intersectsSphere, intersectsBox and intersectsGeometry: the same answers', () => {
  const points = pointsAround(mesh, 100), answers = new Set();
  const small = geometryOf(torus(12, 6));
  for (let i = 0; i < points.length; i += 3) {
    const point = new THREE.Vector3(...points.subarray(i, i + 3));
    const matrix = new THREE.Matrix4().makeRotationX(i).setPosition(point);
    const sphere = new THREE.Sphere(point, 0.8), box = new THREE.Box3(new THREE.Vector3(-0.3, -0.2, -0.4), new THREE.Vector3(0.3, 0.2, 0.4));
    assert.equal(kerf.intersectsSphere(sphere), own.intersectsSphere(sphere));
    assert.equal(kerf.intersectsBox(box, matrix), own.intersectsBox(box, matrix));
    matrix.scale(new THREE.Vector3(0.1, 0.1, 0.1));
    assert.equal(kerf.intersectsGeometry(small, matrix), own.intersectsGeometry(small, matrix));
    answers.add(kerf.intersectsSphere(sphere));
  }
  assert.equal(answers.size, 2);
});

test('shapecast: the same triangles, once for each leaf that they stand in, also where boxes are contained', () => {
  const points = pointsAround(mesh, 40);
  let repeated = 0, contained = 0;
  for (let i = 0; i < points.length; i += 3) {
    const box = new THREE.Box3().setFromCenterAndSize(new THREE.Vector3(...points.subarray(i, i + 3)), new THREE.Vector3(4, 4, 4));
    const found = [kerf, own].map((tree) => {
      const list = [];
      tree.shapecast({
        intersectsBounds: (bounds) => (box.containsBox(bounds) ? CONTAINED : box.intersectsBox(bounds) ? INTERSECTED : NOT_INTERSECTED),
        intersectsTriangle(triangle, index, inside) {
          if (inside) ++contained;
          if (box.intersectsTriangle(triangle)) list.push(index);
          return false;
        },
      });
      return list;
    });
    assert.deepEqual(sorted(new Set(found[0])), sorted(found[1]));
    repeated += found[0].length - found[1].length;
  }
  assert.ok(repeated > 0 && contained > 0);
});

test('bvhcast: the same pairs, once for each pair of leaves', () => {
  const other = geometryOf(torus(20, 10)), matrix = new THREE.Matrix4().makeTranslation(5, 5, 5);
  const trees = [[kerf, buildMeshBVH(other, splits)], [own, new MeshBVH(geometryOf(torus(20, 10)), { indirect: true })]];
  const [a, b] = trees.map(([first, second]) => {
    const pairs = new Set();
    first.bvhcast(second, matrix, {
      intersectsTriangles(one, two, i, j) {
        if (one.intersectsTriangle(two)) pairs.add(first.resolveTriangleIndex(i) * 1000 + second.resolveTriangleIndex(j));
        return false;
      },
    });
    return pairs;
  });
  assert.ok(a.size > 10);
  assert.deepEqual(sorted(a), sorted(b));
});

test('closestPointToGeometry: the same distance', () => {
  const other = geometryOf(torus(12, 6)), matrix = new THREE.Matrix4().makeScale(0.1, 0.1, 0.1).setPosition(5, 5.5, 5);
  const distances = [kerf, own].map((tree) => tree.closestPointToGeometry(other, matrix).distance);
  assert.ok(Math.abs(distances[0] - distances[1]) < 1e-9);
});

test('refit: boxes hold whole triangles again, and hits are the same as after a refit of its own', () => {
  const moved = { ...mesh, positions: mesh.positions.map((x, i) => x + 0.1 * Math.sin(i)) };
  const [a, b] = [buildMeshBVH(geometryOf(mesh), splits), new MeshBVH(geometryOf(mesh), { indirect: true })];
  for (const tree of [a, b]) {
    tree.geometry.attributes.position.array = moved.positions;
    tree.refit();
  }
  for (const ray of rays(200)) assert.equal(a.raycastFirst(ray, THREE.DoubleSide)?.distance, b.raycastFirst(ray, THREE.DoubleSide)?.distance);
});

test('getBoundingBox, serialize and deserialize', () => {
  const box = kerf.getBoundingBox(new THREE.Box3()), { lower, upper } = boundsOf(mesh);
  assert.deepEqual([...box.min.toArray(), ...box.max.toArray()], [...lower, ...upper]);
  const again = MeshBVH.deserialize(MeshBVH.serialize(kerf), geometryOf(mesh));
  for (const ray of rays(100)) assert.deepEqual(again.raycastFirst(ray)?.faceIndex, kerf.raycastFirst(ray)?.faceIndex);
});

test('the draw range, a range and groups leave out what three-mesh-bvh leaves out', () => {
  const ranged = geometryOf(mesh), hits = (tree) => [...rays(200)].map((ray) => tree.raycastFirst(ray, THREE.DoubleSide)?.faceIndex);
  ranged.setDrawRange(300, 900);
  assert.deepEqual(hits(buildMeshBVH(ranged, splits)), hits(new MeshBVH(ranged, { indirect: true })));
  const range = { start: 600, count: 1200 };
  assert.deepEqual(hits(buildMeshBVH(ranged, { ...splits, range })), hits(new MeshBVH(ranged, { indirect: true, range })));
  ranged.setDrawRange(0, Infinity);
  ranged.addGroup(0, 300, 0);
  ranged.addGroup(900, 900, 1);
  assert.deepEqual(hits(buildMeshBVH(ranged, splits)), hits(new MeshBVH(ranged, { indirect: true })));
});

test('three-bvh-csg: solids of the same volume', () => {
  const solids = (split) => [new THREE.TorusKnotGeometry(1, 0.35, 120, 24), new THREE.SphereGeometry(1, 48, 32)].map((shape, i) => {
    const brush = new Brush(shape);
    brush.position.set(0.4 * i, 0.2 * i, 0.1 * i);
    brush.updateMatrixWorld();
    brush.prepareGeometry(); // makes a tree of its own, in whose place another one may stand
    if (split) brush.geometry.boundsTree = buildMeshBVH(brush.geometry, splits);
    return brush;
  });
  for (const operation of [ADDITION, SUBTRACTION, INTERSECTION]) {
    const [a, b] = [false, true].map((split) => computeMeshVolume(new Evaluator().evaluate(...solids(split), operation)));
    assert.ok(Math.abs(a - b) < 1e-6 * a, `${a} and ${b}`);
  }
});

test('shaders: the texture of an expanded tree has the triangles of every leaf, and its calls find the same hits', () => {
  const uniforms = new MeshBVHUniformStruct(), expanded = buildExpandedMeshBVH(geometry, splits);
  uniforms.updateFrom(expanded);
  const leaves = MeshBVH.serialize(kerf).indirectBuffer, { data } = uniforms.index.image;
  leaves.forEach((triangle, i) => {
    assert.deepEqual([...data.subarray(4 * i, 4 * i + 3)], [...mesh.index.subarray(3 * triangle, 3 * triangle + 3)]);
  });
  for (const ray of rays(200)) assert.equal(expanded.raycastFirst(ray, THREE.DoubleSide)?.distance, own.raycastFirst(ray, THREE.DoubleSide)?.distance);
});

test('a mesh without triangles is a tree that nothing meets', () => {
  const empty = new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(new Float32Array(0), 3));
  const tree = buildMeshBVH(empty);
  assert.equal(tree.raycastFirst(new THREE.Ray(new THREE.Vector3(), new THREE.Vector3(1, 0, 0))), null);
  assert.equal(tree.raycast(new THREE.Ray(new THREE.Vector3(), new THREE.Vector3(1, 0, 0))).length, 0);
});
