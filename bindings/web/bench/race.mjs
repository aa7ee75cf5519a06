// The races of a model: kerf-bvh beside three-mesh-bvh, in Node as in a page.
import * as THREE from 'three';
import { AVERAGE, CENTER, MeshBVH, SAH, acceleratedRaycast as theirRaycast } from 'three-mesh-bvh';
import { Bvh, init, none } from '../dist/index.js';
import { acceleratedRaycast, GeometryBvh, meshOf } from '../dist/three.js';
import { buildMeshBVH } from '../dist/three-mesh-bvh.js';
import { boundsOf, corners, cross, dot, random, sub } from '../tests/support/meshes.mjs';

const strategies = { CENTER, AVERAGE, SAH };

const copyOf = (geometry) => {
  const copy = new THREE.BufferGeometry().setAttribute('position', geometry.attributes.position);
  return geometry.index ? copy.setIndex(geometry.index.clone()) : copy;
};

/** Runs all once more each time, in turns; the shortest time of each, in seconds. */
function race(runs, repeats) {
  const best = Object.fromEntries(Object.keys(runs).map((name) => [name, Infinity]));
  for (let i = 0; i < repeats; ++i) {
    for (const [name, run] of Object.entries(runs)) {
      const begin = performance.now();
      run();
      best[name] = Math.min(best[name], (performance.now() - begin) / 1000);
    }
  }
  return best;
}

/** From points in the box of a mesh: half in tiles as a camera makes them, half from where those hit, in any direction. */
function raysOf(mesh, bvh, rayCount) {
  const { lower, upper } = boundsOf(mesh), next = random(11), rays = new Float32Array(6 * rayCount);
  const primary = rayCount / 2, tile = 64, views = 8;
  for (let i = 0; i < primary; ++i) {
    const view = Math.floor((i * views) / primary), within = i % Math.ceil(primary / views);
    const from = random(100 + view), eye = lower.map((l, k) => l + (upper[k] - l) * (0.2 + 0.6 * from()));
    const phi = 2 * Math.PI * from(), x = (within % tile) / tile - 0.5, y = Math.floor(within / tile) / tile - 0.5;
    const direction = [Math.cos(phi) - x * Math.sin(phi), Math.sin(phi) + x * Math.cos(phi), y];
    const length = Math.hypot(...direction);
    rays.set([...eye, ...direction.map((d) => d / length)], 6 * i);
  }
  const hits = bvh.intersectMany(rays.subarray(0, 6 * primary));
  for (let i = 0; i < primary; ++i) {
    const origin = rays.subarray(6 * i, 6 * i + 3), d = rays.subarray(6 * i + 3, 6 * i + 6);
    const t = hits.triangle[i] === none ? 0 : hits.t[i] * (1 - 1e-4);
    let direction;
    do direction = [next() * 2 - 1, next() * 2 - 1, next() * 2 - 1];
    while (Math.hypot(...direction) > 1 || Math.hypot(...direction) < 0.1);
    const length = Math.hypot(...direction);
    rays.set([...origin.map((o, k) => o + t * d[k]), ...direction.map((x) => x / length)], 6 * (primary + i));
  }
  return rays;
}

/** Whether a ray clearly hits a triangle, in doubles: not near an edge, not nearly along its plane. */
function clearlyHits(mesh, triangle, ray) {
  const origin = [...ray.subarray(0, 3)], direction = [...ray.subarray(3, 6)];
  const [a, b, c] = corners(mesh, triangle).map((p) => sub(p, origin));
  const v = [dot(direction, cross(b, c)), dot(direction, cross(c, a)), dot(direction, cross(a, b))];
  const sum = v[0] + v[1] + v[2];
  return v.every((x) => x / sum > 1e-4) && dot(cross(sub(b, a), sub(c, a)), a) / sum > 1e-6;
}

/** The shortest times in seconds of what is done with a model, and the hits that are missed. */
export async function raceModel(geometry, rayCount, repeats) {
  await init();
  const mesh = meshOf(geometry);
  mesh.index ??= new Uint32Array(mesh.positions.length / 3).map((_, i) => i);
  const triangles = mesh.index.length / 3;

  const theirs = {};
  const build = race({
    ...Object.fromEntries(Object.entries(strategies).map(([name, strategy]) => [name, () => {
      theirs[name] = new MeshBVH(copyOf(geometry), { strategy });
    }])),
    kerf: () => Bvh.build(mesh).dispose(),
    'kerf, no splits': () => Bvh.build(mesh, { builder: 'bvh' }).dispose(),
  }, repeats);
  const ours = new GeometryBvh(geometry, Bvh.build(mesh));
  const packed = buildMeshBVH(copyOf(geometry));

  const numbers = raysOf(mesh, ours.bvh, rayCount), material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide });
  const rays = Array.from({ length: rayCount }, (_, i) => new THREE.Ray(
    new THREE.Vector3(...numbers.subarray(6 * i, 6 * i + 3)), new THREE.Vector3(...numbers.subarray(6 * i + 3, 6 * i + 6))));
  const through = (tree, raycast) => {
    const object = new THREE.Mesh(tree.geometry, material), caster = new THREE.Raycaster();
    object.raycast = raycast;
    object.updateMatrixWorld();
    tree.geometry.boundsTree = tree;
    caster.firstHitOnly = true;
    return () => {
      let hits = 0;
      for (const ray of rays) {
        caster.ray = ray;
        hits += caster.intersectObject(object).length;
      }
      return hits;
    };
  };
  const each = (run) => Object.fromEntries(Object.entries(theirs).map(([name, tree]) => [name, run(tree)]));
  const first = race({ ...each((tree) => through(tree, theirRaycast)), kerf: through(ours, acceleratedRaycast),
    'their calls on kerf\'s tree': through(packed, theirRaycast) }, repeats);
  const bare = (tree) => () => { for (const ray of rays) tree.raycastFirst(ray, THREE.DoubleSide); };
  const many = race({ ...each(bare), kerf: () => ours.bvh.intersectMany(numbers) }, repeats);

  const points = numbers.filter((_, i) => i % 6 < 3).slice(0, 3 * Math.floor(rayCount / 2));
  const vectors = Array.from({ length: points.length / 3 }, (_, i) => new THREE.Vector3(...points.subarray(3 * i, 3 * i + 3)));
  const next = random(5);
  for (const vector of vectors) vector.add(new THREE.Vector3(next(), next(), next()).subScalar(0.5).multiplyScalar(0.1));
  vectors.forEach((vector, i) => points.set(vector.toArray(), 3 * i));
  const target = {};
  const nearest = (tree) => () => { for (const vector of vectors) tree.closestPointToPoint(vector, target); };
  const closest = race({ ...each(nearest), kerf: nearest(ours), 'kerf, many': () => ours.bvh.closestPointMany(points) }, repeats);

  // Boxes as large as a twentieth of the model: the triangles in them.
  const { lower, upper } = boundsOf(mesh), box = new THREE.Box3(), size = new THREE.Vector3(...sub(upper, lower)).multiplyScalar(0.05);
  const shapecast = (tree) => () => {
    for (const vector of vectors.slice(0, 4000)) {
      box.setFromCenterAndSize(vector, size);
      tree.shapecast({ intersectsBounds: (bounds) => box.intersectsBox(bounds), intersectsTriangle: (triangle) => (box.intersectsTriangle(triangle), false) });
    }
  };
  // Spheres that just reach the surface.
  const sphere = new THREE.Sphere();
  const spheres = (tree) => () => { for (const vector of vectors) tree.intersectsSphere(sphere.set(vector, 0.05)); };
  const shapes = race({ SAH: shapecast(theirs.SAH), 'kerf\'s tree': shapecast(packed), 'SAH, rays': bare(theirs.SAH), 'kerf\'s tree, rays': bare(packed),
    'SAH, spheres': spheres(theirs.SAH), 'kerf\'s tree, spheres': spheres(packed) }, repeats);

  // Hits that are missed: where one finds nothing and another a triangle, that triangle decides.
  const hits = ours.bvh.intersectMany(numbers), missed = { kerf: 0, ...each(() => 0) };
  const whole = copyOf(geometry), numbered = new MeshBVH(whole, { strategy: SAH, indirect: true });
  rays.forEach((ray, i) => {
    const found = each((tree) => tree.raycastFirst(ray, THREE.DoubleSide) !== null);
    found.kerf = hits.triangle[i] !== none;
    const names = Object.keys(found);
    if (names.every((name) => found[name]) || names.every((name) => !found[name])) return;
    const triangle = found.kerf ? hits.triangle[i] : numbered.raycastFirst(ray, THREE.DoubleSide)?.faceIndex;
    if (triangle === undefined || !clearlyHits(mesh, triangle, numbers.subarray(6 * i, 6 * i + 6))) return;
    for (const name of names) if (!found[name]) ++missed[name];
  });
  ours.dispose();
  return { triangles, build, first, many, closest, shapes, missed, rays: rayCount, points: vectors.length };
}
