// Under three.js: everything that THREE.Raycaster is told, against what three.js itself finds.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as THREE from 'three';
import { init } from '../dist/index.js';
import { acceleratedRaycast, computeBoundsTree, disposeBoundsTree, GeometryBvh } from '../dist/three.js';
import { beams, corners, pointsAround, random, raysAtTriangles, torus } from './support/meshes.mjs';

await init();

function geometryOf(mesh, { indexed = true } = {}) {
  let geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(mesh.index, 1));
  const next = random(7);
  geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array((mesh.positions.length / 3) * 2).map(next), 2));
  geometry.computeVertexNormals();
  if (!indexed) geometry = geometry.toNonIndexed();
  return geometry;
}

/** Rays in the world that meet a mesh. */
function* raycasters(object, count, limits = [0, Infinity]) {
  object.updateMatrixWorld();
  const rays = raysAtTriangles(object.userData.mesh, count);
  for (let i = 0; i < count; ++i) {
    const origin = new THREE.Vector3(...rays.subarray(6 * i, 6 * i + 3)).applyMatrix4(object.matrixWorld);
    const direction = new THREE.Vector3(...rays.subarray(6 * i + 3, 6 * i + 6)).transformDirection(object.matrixWorld);
    yield new THREE.Raycaster(origin, direction, ...limits);
  }
}

function objectOf(mesh, material, options) {
  const object = new THREE.Mesh(geometryOf(mesh, options), material);
  object.position.set(3, -2, 5);
  object.rotation.set(0.3, 1.1, -0.7);
  object.scale.set(1.5, 0.5, -2);
  object.userData.mesh = mesh;
  return object;
}

function close(actual, expected, what, tolerance = 2e-5) {
  const size = Math.max(1, ...expected.map(Math.abs));
  actual.forEach((x, i) => assert.ok(Math.abs(x - expected[i]) <= tolerance * size, `${what}: ${actual} is not ${expected}`));
}

function same(actual, expected) {
  assert.equal(actual.object, expected.object);
  assert.equal(actual.faceIndex, expected.faceIndex);
  close([actual.distance], [expected.distance], 'distance');
  close(actual.point.toArray(), expected.point.toArray(), 'point');
  const { a, b, c, materialIndex } = actual.face;
  assert.deepEqual({ a, b, c, materialIndex }, { a: expected.face.a, b: expected.face.b, c: expected.face.c, materialIndex: expected.face.materialIndex });
  close(actual.face.normal.toArray(), expected.face.normal.toArray(), 'normal of the face');
  close(actual.uv.toArray(), expected.uv.toArray(), 'uv', 2e-3); // triangles are as thin as 0.01
  assert.deepEqual(Object.keys(actual).sort(), Object.keys(expected).sort());
}

/** Compares with three.js; returns how many hits were. */
function compare(object, casters) {
  let count = 0;
  for (const caster of casters) {
    const expected = [], all = [], first = [];
    THREE.Mesh.prototype.raycast.call(object, caster, expected);
    acceleratedRaycast.call(object, caster, all);
    caster.firstHitOnly = true;
    acceleratedRaycast.call(object, caster, first);
    // Of a triangle in two groups, three.js computes two distances, which differ in the last place.
    const place = (hit) => Math.round(hit.distance * 1e6);
    const nearer = (a, b) => place(a) - place(b) || a.faceIndex - b.faceIndex || a.face.materialIndex - b.face.materialIndex;
    expected.sort(nearer);
    all.sort(nearer);
    assert.equal(all.length, expected.length);
    all.forEach((hit, i) => same(hit, expected[i]));
    assert.equal(first.length, Math.min(1, expected.length));
    if (first.length) same(first[0], expected[0]);
    count += expected.length;
  }
  assert.ok(count > 20, `${count} hits are too few to compare`);
}

for (const indexed of [true, false]) {
  for (const [name, side] of Object.entries({ FrontSide: THREE.FrontSide, BackSide: THREE.BackSide, DoubleSide: THREE.DoubleSide })) {
    test(`${name}, ${indexed ? 'with an index' : 'without one'}: the hits of three.js`, () => {
      const object = objectOf(beams(80), new THREE.MeshBasicMaterial({ side }), { indexed });
      object.geometry.boundsTree = GeometryBvh.build(object.geometry);
      compare(object, raycasters(object, 200));
    });
  }
}

test('near, far and the draw range hold', () => {
  const object = objectOf(beams(80), new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
  object.geometry.boundsTree = GeometryBvh.build(object.geometry);
  compare(object, raycasters(object, 300, [2, 9]));
  object.geometry.setDrawRange(300, 1200);
  compare(object, raycasters(object, 300, [1, 20]));
});

test('groups have the sides of their materials, also where they overlap', () => {
  const materials = [THREE.FrontSide, THREE.BackSide, THREE.DoubleSide].map((side) => new THREE.MeshBasicMaterial({ side }));
  const object = objectOf(beams(80), materials);
  object.geometry.addGroup(0, 900, 0);
  object.geometry.addGroup(900, 900, 1);
  object.geometry.addGroup(1500, 1200, 2);
  object.geometry.boundsTree = GeometryBvh.build(object.geometry);
  compare(object, raycasters(object, 300));
  object.geometry.setDrawRange(600, 1500);
  compare(object, raycasters(object, 300));
});

test('a hit at near or far itself counts, and one just before does not hide the next', () => {
  const positions = new Float32Array([-1, -1, 0, 1, -1, 0, 0, 1, 0, -1, -1, -3, 1, -1, -3, 0, 1, -3]);
  const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.boundsTree = GeometryBvh.build(geometry);
  const object = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial());
  const first = (near, far) => {
    const caster = new THREE.Raycaster(new THREE.Vector3(0, 0, 1), new THREE.Vector3(0, 0, -1), near, far), found = [];
    caster.firstHitOnly = true;
    acceleratedRaycast.call(object, caster, found);
    return found[0]?.distance;
  };
  assert.equal(first(1, 10), 1);
  assert.equal(first(1 + 1e-9, 10), 4);
  assert.equal(first(0, 1), 1);
  assert.equal(first(0, 1 - 1e-9), undefined);
});

test('THREE.Raycaster uses it through the prototypes, with instances and without a tree as before', () => {
  const before = THREE.Mesh.prototype.raycast;
  Object.assign(THREE.BufferGeometry.prototype, { computeBoundsTree, disposeBoundsTree });
  try {
    const geometry = geometryOf(torus(40, 20)), material = new THREE.MeshBasicMaterial();
    const instances = new THREE.InstancedMesh(geometry, material, 3);
    for (let i = 0; i < 3; ++i) instances.setMatrixAt(i, new THREE.Matrix4().makeTranslation(9 * i, 0, 0));
    instances.updateMatrixWorld();
    const caster = new THREE.Raycaster(new THREE.Vector3(-20, 0.1, 0.05), new THREE.Vector3(1, 0, 0));
    const expected = caster.intersectObject(instances);
    geometry.computeBoundsTree();
    THREE.Mesh.prototype.raycast = acceleratedRaycast;
    const found = caster.intersectObject(instances);
    assert.ok(expected.length >= 6);
    assert.deepEqual(found.map((hit) => [hit.instanceId, hit.faceIndex]), expected.map((hit) => [hit.instanceId, hit.faceIndex]));
    geometry.disposeBoundsTree();
    assert.equal(geometry.boundsTree, null);
    assert.equal(caster.intersectObject(instances).length, expected.length);
  } finally {
    THREE.Mesh.prototype.raycast = before;
  }
});

test('positions that are interleaved or normalized integers are read as three.js reads them', () => {
  const mesh = beams(20), count = mesh.positions.length / 3;
  const wide = new THREE.InterleavedBuffer(new Float32Array(5 * count), 5);
  for (let i = 0; i < count; ++i) wide.array.set(mesh.positions.subarray(3 * i, 3 * i + 3), 5 * i + 1);
  const short = new Int16Array(mesh.positions.map((x) => x * 1000));
  for (const attribute of [new THREE.InterleavedBufferAttribute(wide, 3, 1), new THREE.BufferAttribute(short, 3, true)]) {
    const object = objectOf(mesh, new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
    object.geometry.setAttribute('position', attribute);
    object.geometry.boundsTree = GeometryBvh.build(object.geometry);
    const positions = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) positions.set([attribute.getX(i), attribute.getY(i), attribute.getZ(i)], 3 * i);
    object.userData.mesh = { positions, index: mesh.index };
    compare(object, raycasters(object, 300));
  }
});

test('skinned meshes and parts that begin within a triangle are left to three.js', () => {
  const object = objectOf(beams(30), [new THREE.MeshBasicMaterial({ side: THREE.DoubleSide })]);
  object.geometry.addGroup(1, 600, 0);
  object.geometry.boundsTree = GeometryBvh.build(object.geometry);
  compare(object, raycasters(object, 100));
});

test('closest points and spheres are those of all triangles, and boxes too, turned or not', () => {
  const mesh = beams(40), geometry = geometryOf(mesh), tree = GeometryBvh.build(geometry);
  const triangles = Array.from({ length: mesh.index.length / 3 }, (_, i) =>
    new THREE.Triangle(...corners(mesh, i).map((p) => new THREE.Vector3(...p))));
  const points = pointsAround(mesh, 60), at = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) {
    const point = new THREE.Vector3(...points.subarray(i, i + 3));
    const distances = triangles.map((triangle) => triangle.closestPointToPoint(point, at).distanceTo(point));
    const least = Math.min(...distances), found = tree.closestPointToPoint(point);
    assert.ok(Math.abs(found.distance - least) < 1e-5);
    assert.ok(Math.abs(found.point.distanceTo(point) - least) < 1e-5);
    assert.equal(tree.intersectsSphere(new THREE.Sphere(point, least * 1.0001)), true);
    assert.equal(tree.intersectsSphere(new THREE.Sphere(point, least * 0.9999)), false);
    const radius = least + 1, near = tree.trianglesInSphere(new THREE.Sphere(point, radius));
    assert.equal(near.length, distances.filter((d) => d <= radius).length);
    const box = new THREE.Box3().setFromCenterAndSize(point, new THREE.Vector3(1, 2, 3));
    const turned = new THREE.Matrix4().makeRotationFromEuler(new THREE.Euler(0.5, 0.2, i));
    assert.deepEqual([...tree.trianglesInBox(box)], triangles.flatMap((t, k) => (box.intersectsTriangle(t) ? [k] : [])));
    const back = turned.clone().invert();
    const expected = triangles.flatMap((t, k) => {
      const moved = new THREE.Triangle(...[t.a, t.b, t.c].map((p) => p.clone().applyMatrix4(back)));
      return box.intersectsTriangle(moved) ? [k] : [];
    });
    assert.deepEqual([...tree.trianglesInBox(box, turned)], expected);
    assert.equal(tree.intersectsBox(box, turned), expected.length > 0);
  }
});
