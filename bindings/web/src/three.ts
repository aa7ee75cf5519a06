// Under three.js: what THREE.Raycaster and others ask of meshes.

import {
  BackSide, Box3, type BufferGeometry, DoubleSide, type InterleavedBufferAttribute, type BufferAttribute, type Intersection,
  type Material, Matrix4, Mesh as ThreeMesh, type Object3D, Ray, type Raycaster, type Sphere, Triangle, Vector2, Vector3,
} from 'three';

import { type BuildOptions, Bvh, type Mesh } from './bvh.js';
import { allocate, core, floats, words } from './core.js';
import { buildInWorker, type WorkerOptions } from './build-in-worker.js';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The positions and the index of a geometry, whatever its attributes are made of. */
export function meshOf(geometry: BufferGeometry): Mesh {
  const attribute = geometry.getAttribute('position');
  const plain = attribute.array instanceof Float32Array && attribute.itemSize === 3 && !('data' in attribute);
  const positions = plain ? (attribute.array as Float32Array) : new Float32Array(3 * attribute.count);
  if (!plain) {
    for (let i = 0; i < attribute.count; ++i)
      positions.set([attribute.getX(i), attribute.getY(i), attribute.getZ(i)], 3 * i);
  }
  const corners = geometry.index ? geometry.index.count : attribute.count;
  const whole = corners - (corners % 3); // three.js passes over what is left of a triangle
  if (geometry.index) return { positions, index: geometry.index.array.subarray(0, whole) as Uint32Array };
  return { positions: positions.subarray(0, 3 * whole) };
}

/** A part of a mesh that is drawn with one material: triangles `first` to `last - 1`. */
interface DrawnPart {
  first: number;
  last: number;
  side: number;
  materialIndex: number;
}

const sideOf = (material: Material): number => (material.side === DoubleSide ? 2 : material.side === BackSide ? 1 : 0);
const whole = (corner: number): boolean => corner % 3 === 0;

const inverse = /* @__PURE__ */ new Matrix4();
const localRay = /* @__PURE__ */ new Ray();
const along = /* @__PURE__ */ new Vector3();
const pA = /* @__PURE__ */ new Vector3(), pB = /* @__PURE__ */ new Vector3(), pC = /* @__PURE__ */ new Vector3();
const edge1 = /* @__PURE__ */ new Vector3(), edge2 = /* @__PURE__ */ new Vector3();

function push(intersects: Intersection[], found: Intersection[], firstOnly: boolean): Intersection[] {
  if (!firstOnly) for (const hit of found) intersects.push(hit);
  else if (found.length > 0) intersects.push(found.reduce((a, b) => (b.distance < a.distance ? b : a)));
  return intersects;
}

/** The hierarchy of a geometry: what `geometry.boundsTree` is for `acceleratedRaycast`, which may also be that of
 * three-mesh-bvh. All calls but `raycastObject3D` are in the coordinates of the geometry. */
export class GeometryBvh {
  /** Where rays of this geometry find the parts that they see. */
  private partsAt = 0;
  private partWords = 0;
  private written: number[] = [];

  constructor(readonly geometry: BufferGeometry, readonly bvh: Bvh) {}

  static build(geometry: BufferGeometry, options: BuildOptions = {}): GeometryBvh {
    return new GeometryBvh(geometry, Bvh.build(meshOf(geometry), options));
  }
  static async buildInWorker(geometry: BufferGeometry, options: WorkerOptions = {}): Promise<GeometryBvh> {
    return new GeometryBvh(geometry, await buildInWorker(meshOf(geometry), options));
  }

  dispose(): void {
    this.bvh.dispose();
    if (this.partsAt !== 0) core().release(this.partsAt);
    this.partsAt = 0;
    this.partWords = 0;
    this.written = [];
  }

  /** What `THREE.Mesh.raycast` does: all hits, or the closest if `raycaster.firstHitOnly` is set. */
  raycastObject3D(object: Object3D, raycaster: Raycaster, intersects: Intersection[] = []): Intersection[] {
    const { material } = object as ThreeMesh;
    if (material === undefined) return intersects;
    const parts = this.drawnParts(material);
    const firstOnly = (raycaster as { firstHitOnly?: boolean }).firstHitOnly === true;
    if (parts === null) {
      const all: Intersection[] = [];
      originalRaycast.call(object as ThreeMesh, raycaster, all);
      return push(intersects, all, firstOnly);
    }
    if (parts.length === 0) return intersects;
    inverse.copy(object.matrixWorld).invert();
    localRay.copy(raycaster.ray).applyMatrix4(inverse);
    // Lengths in the world for one in the geometry, whose ray has unit length.
    const m = object.matrixWorld.elements, d = localRay.direction;
    const scale = along.set(m[0] * d.x + m[4] * d.y + m[8] * d.z, m[1] * d.x + m[5] * d.y + m[9] * d.z,
      m[2] * d.x + m[6] * d.y + m[10] * d.z).length();
    // Limits are told in full precision below; the hierarchy's may be too generous by the rounding of floats.
    const tMin = (raycaster.near / scale) * (1 - 1e-6), tMax = (raycaster.far / scale) * (1 + 1e-6);
    const all: Intersection[] = [];
    if (firstOnly) {
      const triangle = this.first(localRay, tMin, tMax, parts);
      if (triangle < 0) return intersects;
      const part = parts.find((at) => this.sees(at, triangle, localRay))!;
      const hit = this.intersectionOf(object, raycaster, triangle, part, this.hitDistance);
      if (hit) {
        intersects.push(hit);
        return intersects;
      }
      // The closest hit lies between a limit and its rounding: of all hits, the first that does not.
    }
    this.all(object, raycaster, tMin, tMax, parts, all);
    return push(intersects, all, firstOnly);
  }

  private all(object: Object3D, raycaster: Raycaster, tMin: number, tMax: number, parts: DrawnPart[],
    intersects: Intersection[]): void {
    for (const hit of this.bvh.allHits(localRay.origin, localRay.direction, tMin, tMax)) {
      for (const part of parts) {
        if (!this.sees(part, hit.triangle, localRay)) continue;
        const found = this.intersectionOf(object, raycaster, hit.triangle, part, hit.t);
        if (found) intersects.push(found);
      }
    }
  }

  private sees(part: DrawnPart, triangle: number, ray: Ray): boolean {
    if (triangle < part.first || triangle >= part.last) return false;
    return part.side === 2 || this.bvh.isFront(ray.origin, ray.direction, triangle) === (part.side === 0);
  }

  // What is drawn, or null where only three.js itself can tell: parts that begin within a triangle.
  private drawnParts(material: Material | Material[]): DrawnPart[] | null {
    const { index, groups, drawRange } = this.geometry;
    const corners = index ? index.count : this.geometry.getAttribute('position').count;
    const drawn = (start: number, count: number, one: Material, materialIndex: number): DrawnPart => ({
      first: Math.max(0, start, drawRange.start) / 3,
      last: Math.ceil(Math.min(corners, start + count, drawRange.start + drawRange.count) / 3),
      side: sideOf(one),
      materialIndex,
    });
    if (!Array.isArray(material)) {
      if (!whole(drawRange.start)) return null;
      const part = drawn(0, Infinity, material, 0);
      return part.first < part.last ? [part] : [];
    }
    if (!whole(drawRange.start) || groups.some((group) => !whole(group.start))) return null;
    const parts: DrawnPart[] = [];
    for (const group of groups) {
      const one = material[group.materialIndex ?? 0];
      if (!one) continue;
      const part = drawn(group.start, group.count, one, group.materialIndex ?? 0);
      if (part.first < part.last) parts.push(part);
    }
    return parts;
  }

  // Puts the parts where the module reads them, unless they are there. Returns how many it has to look at.
  private writeParts(parts: DrawnPart[]): number {
    const { index } = this.geometry;
    const triangles = (index ? index.count : this.geometry.getAttribute('position').count) / 3;
    if (parts.length === 1 && parts[0].side === 2 && parts[0].first === 0 && parts[0].last >= Math.floor(triangles)) return 0;
    const { written } = this;
    let same = written.length === 3 * parts.length && this.partsAt !== 0;
    for (let i = 0; same && i < parts.length; ++i) {
      const part = parts[i];
      same = written[3 * i] === part.first && written[3 * i + 1] === part.last && written[3 * i + 2] === part.side;
    }
    if (same) return parts.length;
    this.written = parts.flatMap((part) => [part.first, part.last, part.side]);
    if (this.written.length > this.partWords) {
      if (this.partsAt !== 0) core().release(this.partsAt);
      this.partWords = this.written.length;
      this.partsAt = allocate(4 * this.partWords);
    }
    words().set(this.written, this.partsAt / 4);
    return parts.length;
  }

  private hitDistance = 0; // of the last `first`

  // The closest triangle that is seen, or -1.
  private first(ray: Ray, tMin: number, tMax: number, parts: DrawnPart[]): number {
    const count = this.writeParts(parts);
    const { origin: o, direction: d } = ray, module = core();
    const status = module.intersect(this.bvh.at, o.x, o.y, o.z, d.x, d.y, d.z, tMin, tMax, count ? this.partsAt : 0, count);
    if (status <= 0) return -1;
    const at = module.hit() >>> 2;
    this.hitDistance = floats()[at];
    return words()[at + 3];
  }

  private corners(triangle: number): [number, number, number] {
    const { index } = this.geometry, at = 3 * triangle;
    const corners: [number, number, number] = index ? [index.getX(at), index.getX(at + 1), index.getX(at + 2)] : [at, at + 1, at + 2];
    const position = this.geometry.attributes.position as Attribute;
    pA.fromBufferAttribute(position, corners[0]);
    pB.fromBufferAttribute(position, corners[1]);
    pC.fromBufferAttribute(position, corners[2]);
    return corners;
  }

  // What three.js says of a hit; null beyond its limits. Distances are told in doubles, as three.js does.
  private intersectionOf(object: Object3D, raycaster: Raycaster, triangle: number, part: DrawnPart, t: number): Intersection | null {
    const [a, b, c] = this.corners(triangle);
    const { origin, direction } = localRay;
    const normal = new Vector3().crossVectors(edge1.subVectors(pB, pA), edge2.subVectors(pC, pA));
    const slope = normal.dot(direction), exact = normal.dot(along.subVectors(pA, origin)) / slope;
    // A ray along the triangle's plane leaves nothing of the quotient.
    const distanceInside = Math.abs(exact - t) <= 1e-5 * Math.abs(t) ? exact : t;
    const inside = along.copy(origin).addScaledVector(direction, distanceInside);
    const point = inside.clone().applyMatrix4(object.matrixWorld);
    const distance = raycaster.ray.origin.distanceTo(point);
    if (distance < raycaster.near || distance > raycaster.far) return null;
    const barycoord = Triangle.getBarycoord(inside, pA, pB, pC, new Vector3())!;
    const { uv, uv1, normal: normals } = this.geometry.attributes as Record<string, Attribute>;
    const intersection: Intersection = {
      distance,
      point,
      object,
      faceIndex: triangle,
      face: { a, b, c, normal: normal.normalize(), materialIndex: part.materialIndex },
      barycoord,
    };
    if (uv) intersection.uv = Triangle.getInterpolatedAttribute(uv, a, b, c, barycoord, new Vector2());
    if (uv1) intersection.uv1 = Triangle.getInterpolatedAttribute(uv1, a, b, c, barycoord, new Vector2());
    if (normals) {
      intersection.normal = Triangle.getInterpolatedAttribute(normals, a, b, c, barycoord, new Vector3());
      if (intersection.normal.dot(direction) > 0) intersection.normal.multiplyScalar(-1);
    }
    return intersection;
  }

  /** The closest point within `maxDistance`, or null. */
  closestPointToPoint(point: Vector3, target: { point?: Vector3; distance?: number; faceIndex?: number } = {},
    minDistance = 0, maxDistance = Infinity): { point: Vector3; distance: number; faceIndex: number } | null {
    const found = this.bvh.closestPoint(point, maxDistance);
    if (!found || found.distance < minDistance) return null;
    (target.point ??= new Vector3()).fromArray(found.position);
    target.distance = found.distance;
    target.faceIndex = found.triangle;
    return target as { point: Vector3; distance: number; faceIndex: number };
  }

  /** Whether a triangle has a point in a sphere or on it. */
  intersectsSphere(sphere: Sphere): boolean {
    return this.bvh.closestPoint(sphere.center, sphere.radius) !== null;
  }

  /** Every triangle that does, nearest to the center first. */
  trianglesInSphere(sphere: Sphere): Uint32Array {
    return new Uint32Array(this.bvh.within(new Float32Array(sphere.center.toArray()), sphere.radius).items.map((at) => at.triangle));
  }

  /** Whether a triangle has a point in a box or on it. With a matrix, the box is one that it has moved. */
  intersectsBox(box: Box3, matrix?: Matrix4): boolean {
    return this.trianglesInBox(box, matrix, 1).length !== 0;
  }

  /** Every triangle that does, in the order of their numbers; at most `limit`. */
  trianglesInBox(box: Box3, matrix?: Matrix4, limit = Infinity): Uint32Array {
    const around = matrix ? new Box3().copy(box).applyMatrix4(matrix) : box;
    // A box in floats that is no smaller: what lies in it is told exactly below.
    const grown = (x: number, sign: number): number => x + sign * Math.abs(x) * 2 ** -23;
    const { min, max } = around;
    const floatBox = matrix
      ? [grown(min.x, -1), grown(min.y, -1), grown(min.z, -1), grown(max.x, 1), grown(max.y, 1), grown(max.z, 1)]
      : [min.x, min.y, min.z, max.x, max.y, max.z];
    const found = this.bvh.trianglesIn(new Float32Array(floatBox)).items;
    if (!matrix) return found.subarray(0, limit);
    const back = new Matrix4().copy(matrix).invert(), triangle = new Triangle(pA, pB, pC), inside: number[] = [];
    for (let i = 0; i < found.length && inside.length < limit; ++i) {
      this.corners(found[i]);
      for (const corner of [pA, pB, pC]) corner.applyMatrix4(back);
      if (box.intersectsTriangle(triangle)) inside.push(found[i]);
    }
    return new Uint32Array(inside);
  }

  /** The box around all triangles. */
  getBoundingBox(target: Box3): Box3 {
    const { lower, upper } = this.bvh.statistics.bounds;
    target.min.fromArray(lower);
    target.max.fromArray(upper);
    return target;
  }

}

const originalRaycast = ThreeMesh.prototype.raycast;

interface WithTree {
  boundsTree?: { raycastObject3D(object: Object3D, raycaster: Raycaster, intersects: Intersection[]): unknown } | null;
}

/** `THREE.Mesh.prototype.raycast = acceleratedRaycast`: meshes whose geometry has a `boundsTree` use it, be it kerf's
 * or that of three-mesh-bvh; all others, and those whose vertices move (skins, morphs), are what they were. */
export function acceleratedRaycast(this: ThreeMesh, raycaster: Raycaster, intersects: Intersection[]): void {
  const { boundsTree } = this.geometry as unknown as WithTree;
  const moves = (this as { isSkinnedMesh?: boolean }).isSkinnedMesh || (this.morphTargetInfluences?.length ?? 0) > 0;
  if (boundsTree && !moves) boundsTree.raycastObject3D(this, raycaster, intersects);
  else originalRaycast.call(this, raycaster, intersects);
}

/** `THREE.BufferGeometry.prototype.computeBoundsTree = computeBoundsTree` */
export function computeBoundsTree(this: BufferGeometry, options: BuildOptions = {}): GeometryBvh {
  const holder = this as unknown as { boundsTree?: unknown };
  const old = holder.boundsTree;
  const made = GeometryBvh.build(this, options);
  if (old instanceof GeometryBvh) old.dispose();
  holder.boundsTree = made;
  return made;
}

/** `THREE.BufferGeometry.prototype.disposeBoundsTree = disposeBoundsTree` */
export function disposeBoundsTree(this: BufferGeometry): void {
  const holder = this as unknown as { boundsTree?: unknown };
  if (holder.boundsTree instanceof GeometryBvh) holder.boundsTree.dispose();
  holder.boundsTree = null;
}
