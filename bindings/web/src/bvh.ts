// A hierarchy, and what it answers.

import { allocate, bytes, check, type Core, core, doubles, floats, KerfError, refuse, Scratch, withProgress, words } from './core.js';

/** A point or a direction. */
export type Triple = ArrayLike<number> | { readonly x: number; readonly y: number; readonly z: number };

/** Which hierarchy: object and spatial splits (the one to use), object splits only, or splitting before the build. */
export type Builder = 'sbvh' | 'bvh' | 'esc' | 'evh';
const builders: Builder[] = ['sbvh', 'bvh', 'esc', 'evh'];

/** How much time a build spends on a better tree: none; a fifth to four fifths more; five to fifty times as long. */
export type Quality = 'fast' | 'high' | 'best';
const qualities: Quality[] = ['fast', 'high', 'best'];

/** How to build. The defaults suit most uses; <kerf/build.hpp> says more of each. */
export interface BuildOptions {
  /** Default: `sbvh`. */
  builder?: Builder;
  /** Default: `fast`. */
  quality?: Quality;
  /** Where the children of the best object split overlap by more than this fraction of the root's surface area, a
   * spatial split is tried; 1: nowhere. In [0, 1]. Default: 1e-5. */
  alpha?: number;
  /** At most this many references for each triangle, in [1, 16]. Default: 1.5. */
  maxReferenceRatio?: number;
  /** At most this many triangles in a leaf, in [1, 8]. Default: 8. */
  maxLeafSize?: number;
  /** Triangles with vertices that are not finite make the build fail, or are left out. Default: `refuse`. */
  nonFinite?: 'refuse' | 'skip';
  /** For `esc` and `evh`: how many references splitting makes. Default: as many as there is room for. */
  presplitReferences?: number;
  /** Called now and then with a fraction that never falls. Returning `false` cancels the build, which then throws. */
  onProgress?: (fraction: number) => unknown;
}

/** A mesh: three numbers a vertex and three vertices a triangle. */
export interface Mesh {
  positions: ArrayLike<number>;
  /** Without it, vertices 0, 1, 2 are the first triangle, 3, 4, 5 the second, and so on. */
  index?: ArrayLike<number> | null;
  /** Numbers from one vertex to the next in `positions`. Default: 3. */
  stride?: number;
}

/** Where a ray meets a triangle with corners a, b, c: at `(1 - u - v) a + u b + v c`. */
export interface Hit {
  /** In lengths of the ray's direction. */
  t: number;
  u: number;
  v: number;
  /** Its number in the mesh. */
  triangle: number;
}

/** The point of a triangle that is closest to a given one. */
export interface SurfacePoint {
  position: [number, number, number];
  distance: number;
  u: number;
  v: number;
  triangle: number;
}

/** Many rays: six numbers each, the origin first; or origins and directions apart, of which one may stand for all. */
export type Rays =
  | Float32Array
  | {
      origins: Float32Array;
      directions: Float32Array;
      tMin?: Float32Array | number;
      tMax?: Float32Array | number;
    };

/** The hits of many rays. For a miss, `t` is infinite and `triangle` is `none`. */
export interface Hits {
  t: Float32Array;
  u: Float32Array;
  v: Float32Array;
  triangle: Uint32Array;
}

/** The closest points of many. Where there is none, `distance` is infinite and `triangle` is `none`. */
export interface SurfacePoints {
  position: Float32Array;
  distance: Float32Array;
  u: Float32Array;
  v: Float32Array;
  triangle: Uint32Array;
}

/** A list of answers for each of many questions: those of question i are `items[offsets[i] ... offsets[i + 1] - 1]`. */
export interface Lists<Item> {
  offsets: Uint32Array;
  items: Item[];
}

/** Stands for no triangle. */
export const none = 0xffffffff;

/** Triangles `first` to `last - 1`, seen by rays from that side. The front is where corners run counter-clockwise. */
export interface Part {
  first: number;
  last: number;
  side: 'front' | 'back' | 'both';
}
const sides = ['front', 'back', 'both'];

/** Which triangles rays see. Without it, all, from both sides. */
export interface Seen {
  parts?: Part[];
}

/** What a build made, and what it cost. */
export interface Statistics {
  triangles: number;
  /** Left out because they have no area. */
  degenerateTriangles: number;
  /** Left out because they are not finite. */
  nonFiniteTriangles: number;
  /** Triangles in leaves, each counted once per leaf. */
  references: number;
  nodes: number;
  bytes: number;
  buildPeakBytes: number;
  buildSeconds: number;
  bounds: { lower: [number, number, number]; upper: [number, number, number] };
  /** Children of a node, and nodes on the longest path. */
  width: number;
  depth: number;
}

/** A tree as three-mesh-bvh keeps it: see `packTree`. */
export interface PackedTree {
  /** 32 bytes a node: box, right child or first triangle, axis or leaf mark and count. */
  nodes: ArrayBuffer;
  /** The triangles of the leaves, of which some may stand in several. */
  triangles: Uint32Array;
  /** The surface area heuristic: 1.2 for a node, 1 for a triangle, over the root's area. */
  cost: number;
}

function x(at: Triple): number {
  return 'x' in at ? at.x : at[0];
}
function y(at: Triple): number {
  return 'y' in at ? at.y : at[1];
}
function z(at: Triple): number {
  return 'z' in at ? at.z : at[2];
}

// A `MeshView` and an `OptionsView` of core/kerf_web.cpp.
function passMesh(scratch: Scratch, mesh: Mesh): number {
  const { positions, index } = mesh;
  const stride = mesh.stride ?? 3;
  if (!(Number.isInteger(stride) && stride >= 3)) refuse('the stride of positions is not a whole number from 3 up');
  const vertices = Math.floor((positions.length + stride - 3) / stride);
  if (stride === 3 && positions.length % 3 !== 0) refuse('the length of positions is no multiple of three');
  const corners = index ? index.length : vertices;
  if (corners % 3 !== 0) refuse(`the length of ${index ? 'the index' : 'positions'} is not that of whole triangles`);
  const at = scratch.floats(positions);
  const triangles = index ? scratch.words(index) : 0;
  return scratch.words([at, vertices, 4 * stride, triangles, corners / 3]);
}

function passOptions(scratch: Scratch, options: BuildOptions): number {
  const builder = builders.indexOf(options.builder ?? 'sbvh');
  if (builder < 0) refuse(`there is no builder "${options.builder}": ${builders.join(', ')}`);
  const quality = qualities.indexOf(options.quality ?? 'fast');
  if (quality < 0) refuse(`there is no quality "${options.quality}": ${qualities.join(', ')}`);
  const at = scratch.words([builder, 0, 0, options.maxLeafSize ?? 8, options.nonFinite === 'skip' ? 1 : 0,
    options.presplitReferences ?? 0, options.onProgress ? 1 : 0, quality]);
  floats().set([options.alpha ?? 1e-5, options.maxReferenceRatio ?? 1.5], at / 4 + 1);
  return at;
}

// A `RaysView`.
function passRays(scratch: Scratch, rays: Rays): { view: number; count: number } {
  if (rays instanceof RayBatch) return { view: rays.view(), count: rays.count };
  if (rays instanceof Float32Array) {
    if (rays.length % 6 !== 0) refuse('the length of rays is no multiple of six');
    const at = scratch.floats(rays), count = rays.length / 6;
    return { view: scratch.words([at, at + 12, count, 24, 24, 0, 0, 0, 0]), count };
  }
  const { origins, directions } = rays;
  if (origins.length % 3 !== 0 || directions.length % 3 !== 0)
    refuse('the length of origins or directions is no multiple of three');
  const count = Math.max(origins.length, directions.length) / 3;
  const stride = (array: Float32Array, words: number, what: string): number => {
    if (array.length === words * count) return 4 * words;
    if (array.length !== words) refuse(`there are ${array.length / words} ${what} for ${count} rays`);
    return 0;
  };
  const limit = (limits: Float32Array | number | undefined): Float32Array | undefined =>
    typeof limits === 'number' ? new Float32Array([limits]) : limits;
  const tMin = limit(rays.tMin), tMax = limit(rays.tMax);
  const view = [scratch.floats(origins), scratch.floats(directions), count, stride(origins, 3, 'origins'),
    stride(directions, 3, 'directions'), tMin ? scratch.floats(tMin) : 0, tMax ? scratch.floats(tMax) : 0,
    tMin ? stride(tMin, 1, 'limits tMin') : 0, tMax ? stride(tMax, 1, 'limits tMax') : 0];
  return { view: scratch.words(view), count };
}

function passPoints(scratch: Scratch, points: Float32Array): { at: number; count: number } {
  if (points.length % 3 !== 0) refuse('the length of points is no multiple of three');
  return { at: scratch.floats(points), count: points.length / 3 };
}

function passParts(scratch: Scratch, parts: Part[] | undefined): number {
  return parts ? scratch.words(parts.flatMap((part) => [part.first, part.last, sides.indexOf(part.side)])) : 0;
}

// No parts at all is not the same as none given: rays then see nothing.
const nothing: Part[] = [{ first: 0, last: 0, side: 'both' }];
function partsOf(seen: Seen | undefined): Part[] | undefined {
  return seen?.parts?.length === 0 ? nothing : seen?.parts;
}

const copyFloats = (at: number, count: number): Float32Array => floats().slice(at / 4, at / 4 + count);
const copyWords = (at: number, count: number): Uint32Array => words().slice(at / 4, at / 4 + count);

// The items that the last call left, as 32-bit words and as floats.
function takeItems(): { words: Uint32Array; floats: Float32Array } {
  const at = core().items() >>> 0;
  const items = copyWords(at, core().item_words() >>> 0);
  return { words: items, floats: new Float32Array(items.buffer) };
}
function takeOffsets(count: number): Uint32Array {
  return copyWords(core().offsets() >>> 0, count);
}

const hitWords = 5;
function hitsOf(items: { words: Uint32Array; floats: Float32Array }): Hit[] {
  return Array.from({ length: items.words.length / hitWords }, (_, i) => ({
    t: items.floats[hitWords * i],
    u: items.floats[hitWords * i + 1],
    v: items.floats[hitWords * i + 2],
    triangle: items.words[hitWords * i + 3],
  }));
}

const pointWords = 8;
function pointsOf(items: { words: Uint32Array; floats: Float32Array }): SurfacePoint[] {
  return Array.from({ length: items.words.length / pointWords }, (_, i) => {
    const [px, py, pz, distance, u, v] = items.floats.subarray(pointWords * i, pointWords * i + 6);
    return { position: [px, py, pz], distance, u, v, triangle: items.words[pointWords * i + 6] };
  });
}

function passTransform(scratch: Scratch, transform: ArrayLike<number> | undefined): number {
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const m = transform ?? identity;
  if (m.length !== 16) refuse('a transform has sixteen numbers, column by column');
  return scratch.doubles([m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14]]);
}

// Hierarchies that nobody has disposed of and nobody can reach any more.
const finalizer = new FinalizationRegistry<number>((handle) => core().destroy(handle));

/** A split bounding volume hierarchy over a mesh, which never changes. */
export class Bvh {
  private constructor(private handle: number) {
    finalizer.register(this, handle, this);
  }

  /** Builds the hierarchy of a mesh, which may change or go as soon as this returns. */
  static build(mesh: Mesh, options: BuildOptions = {}): Bvh {
    return Scratch.use((scratch) => {
      const made = scratch.words([0]);
      const view = passMesh(scratch, mesh), how = passOptions(scratch, options);
      withProgress(options.onProgress, () => check(core().build(view, how, made)));
      return new Bvh(words()[made / 4]);
    });
  }

  /** From the bytes of a `.kerf` file. Everything in it is checked before it is used. */
  static load(file: Uint8Array | ArrayBuffer): Bvh {
    return Scratch.use((scratch) => {
      const content = file instanceof Uint8Array ? file : new Uint8Array(file);
      const made = scratch.words([0]);
      check(core().load(scratch.bytes(content), content.length, made));
      return new Bvh(words()[made / 4]);
    });
  }

  /** From a `.kerf` file that a server has. Its parts go into the module's memory as they come. */
  static async fetch(source: URL | string | Response | PromiseLike<Response>): Promise<Bvh> {
    const response = await (typeof source === 'string' || source instanceof URL ? fetch(source) : source);
    if (!response.ok) throw new KerfError('io', `${response.url}: the server answers ${response.status}`);
    const size = Number(response.headers.get('content-length'));
    const packed = response.headers.get('content-encoding');
    if (!response.body || !(size > 0) || packed) return Bvh.load(await response.arrayBuffer());
    const scratch = new Scratch();
    try {
      const at = scratch.take(size), reader = response.body.getReader();
      let count = 0;
      for (let part = await reader.read(); !part.done; part = await reader.read()) {
        if (count + part.value.length > size) throw new KerfError('io', `${response.url}: is longer than it says`);
        bytes().set(part.value, at + count);
        count += part.value.length;
      }
      const made = scratch.words([0]);
      check(core().load(at, count, made));
      return new Bvh(words()[made / 4]);
    } finally {
      scratch.release();
    }
  }

  /** The bytes of a `.kerf` file, which every other kerf reads, too. */
  save(): Uint8Array {
    check(core().save(this.at));
    const at = core().file() >>> 0;
    const file = bytes().slice(at, at + (core().file_bytes() >>> 0));
    core().forget();
    return file;
  }

  /** Frees the module's memory. The garbage collector does so too, but later. */
  dispose(): void {
    if (this.handle === 0) return;
    finalizer.unregister(this);
    core().destroy(this.handle);
    this.handle = 0;
  }

  /** @internal */
  get at(): number {
    if (this.handle === 0) refuse('this hierarchy has been disposed of');
    return this.handle;
  }

  get statistics(): Statistics {
    core().statistics(this.at);
    const of = doubles().subarray(core().numbers() / 8);
    return {
      triangles: of[0], degenerateTriangles: of[1], nonFiniteTriangles: of[2], references: of[3], nodes: of[4],
      bytes: of[5], buildPeakBytes: of[6], buildSeconds: of[7],
      bounds: { lower: [of[8], of[9], of[10]], upper: [of[11], of[12], of[13]] }, width: of[14], depth: of[15],
    };
  }

  /** The boxes of nodes that many levels below the root, and of leaves above them: six numbers each. */
  boxes(level: number): Float32Array {
    check(core().boxes(this.at, level));
    const { floats: boxes } = takeItems();
    return boxes;
  }

  // ---- Rays ----

  /** The closest hit with `tMin <= t <= tMax`, or null. Of several at the same t, the lowest triangle. */
  intersect(origin: Triple, direction: Triple, tMin = 0, tMax = Infinity, seen?: Seen): Hit | null {
    const parts = partsOf(seen);
    if (parts) return Scratch.use((scratch) => this.first(origin, direction, tMin, tMax, passParts(scratch, parts), parts.length));
    return this.first(origin, direction, tMin, tMax, 0, 0);
  }

  private first(o: Triple, d: Triple, tMin: number, tMax: number, parts: number, count: number): Hit | null {
    const status = core().intersect(this.at, x(o), y(o), z(o), x(d), y(d), z(d), tMin, tMax, parts, count);
    if (status < 0) check(-status);
    if (status === 0) return null;
    const at = core().hit() / 4, f = floats();
    return { t: f[at], u: f[at + 1], v: f[at + 2], triangle: words()[at + 3] };
  }

  /** Whether anything is hit with `tMin <= t <= tMax`. */
  occluded(origin: Triple, direction: Triple, tMin = 0, tMax = Infinity, seen?: Seen): boolean {
    return Scratch.use((scratch) => {
      const parts = partsOf(seen);
      const status = core().occluded(this.at, x(origin), y(origin), z(origin), x(direction), y(direction),
        z(direction), tMin, tMax, passParts(scratch, parts), parts?.length ?? 0);
      if (status < 0) check(-status);
      return status === 1;
    });
  }

  /** Every triangle that the ray crosses, each once, nearest first. Crossings are decided in exact arithmetic. */
  allHits(origin: Triple, direction: Triple, tMin = 0, tMax = Infinity): Hit[] {
    check(core().all_hits(this.at, x(origin), y(origin), z(origin), x(direction), y(direction), z(direction), tMin, tMax));
    return hitsOf(takeItems());
  }

  /** Whether a ray comes to a triangle from its front. Exact. */
  isFront(origin: Triple, direction: Triple, triangle: number): boolean {
    const status = core().is_front(this.at, x(origin), y(origin), z(origin), x(direction), y(direction), z(direction), triangle);
    if (status < 0) check(-status);
    return status === 1;
  }

  /** The closest hits of many rays. Those of a `RayBatch` lie in it; other hits are copies. */
  intersectMany(rays: Rays | RayBatch, seen?: Seen): Hits {
    return Scratch.use((scratch) => {
      const { view, count } = passRays(scratch, rays as Rays);
      const parts = partsOf(seen), seenAt = passParts(scratch, parts), seenCount = parts?.length ?? 0;
      if (rays instanceof RayBatch) {
        check(core().intersect_many(this.at, view, ...rays.hitsAt(), seenAt, seenCount));
        return rays;
      }
      const at = [0, 1, 2, 3].map(() => scratch.take(4 * count));
      check(core().intersect_many(this.at, view, at[0], at[1], at[2], at[3], seenAt, seenCount));
      return { t: copyFloats(at[0], count), u: copyFloats(at[1], count), v: copyFloats(at[2], count),
        triangle: copyWords(at[3], count) };
    });
  }

  /** For each of many rays 1 if it hits anything, else 0. */
  occludedMany(rays: Rays | RayBatch, seen?: Seen): Uint8Array {
    return Scratch.use((scratch) => {
      const { view, count } = passRays(scratch, rays as Rays);
      const parts = partsOf(seen), flags = scratch.take(count);
      check(core().occluded_many(this.at, view, flags, passParts(scratch, parts), parts?.length ?? 0));
      return bytes().slice(flags, flags + count);
    });
  }

  /** For each of many rays the number of triangles that it crosses. */
  countHitsMany(rays: Rays | RayBatch): Uint32Array {
    return Scratch.use((scratch) => {
      const { view, count } = passRays(scratch, rays as Rays);
      const counts = scratch.take(4 * count);
      check(core().count_hits_many(this.at, view, counts));
      return copyWords(counts, count);
    });
  }

  /** For each of many rays every triangle that it crosses, each once, nearest first. */
  allHitsMany(rays: Rays | RayBatch): Lists<Hit> {
    return Scratch.use((scratch) => {
      const { view, count } = passRays(scratch, rays as Rays);
      check(core().all_hits_many(this.at, view));
      return { offsets: takeOffsets(count + 1), items: hitsOf(takeItems()) };
    });
  }

  /** What the closest hit of each of many rays costs: inner nodes visited, and triangles tested. */
  countSteps(rays: Rays | RayBatch): { steps: Uint32Array; triangleTests: Uint32Array } {
    return Scratch.use((scratch) => {
      const { view, count } = passRays(scratch, rays as Rays);
      const steps = scratch.take(4 * count), tests = scratch.take(4 * count);
      check(core().count_steps(this.at, view, steps, tests));
      return { steps: copyWords(steps, count), triangleTests: copyWords(tests, count) };
    });
  }

  // ---- Points and boxes ----

  /** The closest point of any triangle within `maxDistance`, or null. */
  closestPoint(point: Triple, maxDistance = Infinity): SurfacePoint | null {
    const status = core().closest_point(this.at, x(point), y(point), z(point), maxDistance);
    if (status < 0) check(-status);
    if (status === 0) return null;
    const at = core().surface_point() / 4, f = floats();
    return { position: [f[at], f[at + 1], f[at + 2]], distance: f[at + 3], u: f[at + 4], v: f[at + 5],
      triangle: words()[at + 6] };
  }

  /** The same for many points. */
  closestPointMany(points: Float32Array, maxDistance = Infinity): SurfacePoints {
    return Scratch.use((scratch) => {
      const { at, count } = passPoints(scratch, points);
      const position = scratch.take(12 * count);
      const [distance, u, v, triangle] = [0, 1, 2, 3].map(() => scratch.take(4 * count));
      check(core().closest_point_many(this.at, at, count, maxDistance, position, distance, u, v, triangle));
      return { position: copyFloats(position, 3 * count), distance: copyFloats(distance, count),
        u: copyFloats(u, count), v: copyFloats(v, count), triangle: copyWords(triangle, count) };
    });
  }

  /** For each of many points 1 if it lies inside a closed surface or on it, else 0. Decided exactly. */
  contains(points: Float32Array): Uint8Array {
    return this.flags(points, core().contains_many);
  }

  /** For each of many points 0 outside a closed surface, 1 on it, 2 inside. Decided exactly. */
  side(points: Float32Array): Uint8Array {
    return this.flags(points, core().side_many);
  }

  private flags(points: Float32Array, call: Core['contains_many']): Uint8Array {
    return Scratch.use((scratch) => {
      const { at, count } = passPoints(scratch, points);
      const flags = scratch.take(count);
      check(call(this.at, at, count, flags));
      return bytes().slice(flags, flags + count);
    });
  }

  /** The distances of many points to the closest point of a closed surface, negative inside. */
  signedDistance(points: Float32Array): Float32Array {
    return Scratch.use((scratch) => {
      const { at, count } = passPoints(scratch, points);
      const distances = scratch.take(4 * count);
      check(core().signed_distance_many(this.at, at, count, distances));
      return copyFloats(distances, count);
    });
  }

  /** For each of many points the `count` triangles nearest to it, each once, nearest first. */
  nearest(points: Float32Array, count: number, maxDistance = Infinity): Lists<SurfacePoint> {
    return this.surfacePoints(points, (at, of) => core().nearest_many(this.at, at, of, count, maxDistance));
  }

  /** For each of many points every triangle with a point within `radius`, each once, nearest first. */
  within(points: Float32Array, radius: number): Lists<SurfacePoint> {
    return this.surfacePoints(points, (at, of) => core().within_many(this.at, at, of, radius));
  }

  private surfacePoints(points: Float32Array, call: (at: number, count: number) => number): Lists<SurfacePoint> {
    return Scratch.use((scratch) => {
      const { at, count } = passPoints(scratch, points);
      check(call(at, count));
      return { offsets: takeOffsets(count + 1), items: pointsOf(takeItems()) };
    });
  }

  /** For each of many boxes (six numbers: lower corner, upper corner) every triangle with a point in it. Exact. */
  trianglesIn(boxes: Float32Array): { offsets: Uint32Array; items: Uint32Array } {
    return Scratch.use((scratch) => {
      if (boxes.length % 6 !== 0) refuse('the length of boxes is no multiple of six');
      check(core().triangles_in(this.at, scratch.floats(boxes), boxes.length / 6));
      return { offsets: takeOffsets(boxes.length / 6 + 1), items: takeItems().words.filter((_, i) => i % 2 === 0) };
    });
  }

  /** Whether a triangle of this hierarchy and one of `other`, moved by sixteen numbers as those of
   * `THREE.Matrix4.elements`, have a point in common. Exact. */
  touches(other: Bvh, transform?: ArrayLike<number>): boolean {
    return Scratch.use((scratch) => {
      const status = core().touches(this.at, other.at, passTransform(scratch, transform));
      if (status < 0) check(-status);
      return status === 1;
    });
  }

  /** All such pairs: twice as many numbers, a triangle of this hierarchy and one of the other by turns. */
  touchingPairs(other: Bvh, transform?: ArrayLike<number>): Uint32Array {
    return Scratch.use((scratch) => {
      check(core().touching_pairs(this.at, other.at, passTransform(scratch, transform)));
      return takeItems().words.filter((_, i) => i % 2 === 0);
    });
  }
}

/**
 * Rays and their hits in the module's memory, so that nothing is copied: write `rays`, call `bvh.intersectMany(batch)`,
 * read `t` and the others. Take each array anew after a call, since memory that grows lies elsewhere.
 */
export class RayBatch implements Hits {
  private memory: number;
  private readonly viewAt: number;

  constructor(readonly count: number) {
    this.viewAt = 40 * count;
    this.memory = allocate(this.viewAt + 48);
  }
  dispose(): void {
    core().release(this.memory);
    this.memory = 0;
  }
  /** Six numbers for each ray, the origin first. */
  get rays(): Float32Array {
    return this.floats(0, 6);
  }
  get t(): Float32Array {
    return this.floats(6, 1);
  }
  get u(): Float32Array {
    return this.floats(7, 1);
  }
  get v(): Float32Array {
    return this.floats(8, 1);
  }
  get triangle(): Uint32Array {
    const at = (this.begin + 36 * this.count) / 4;
    return words().subarray(at, at + this.count);
  }
  private get begin(): number {
    if (this.memory === 0) refuse('this batch of rays has been disposed of');
    return this.memory;
  }
  private floats(row: number, rows: number): Float32Array {
    const at = this.begin / 4 + row * this.count;
    return floats().subarray(at, at + rows * this.count);
  }
  /** @internal */
  hitsAt(): [number, number, number, number] {
    const row = (i: number): number => this.begin + 4 * i * this.count;
    return [row(6), row(7), row(8), row(9)];
  }
  /** @internal */
  view(): number {
    const at = this.begin + this.viewAt;
    words().set([this.begin, this.begin + 12, this.count, 24, 24, 0, 0, 0, 0], at / 4);
    return at;
  }
}

/** The binary tree that a build makes, in the nodes of three-mesh-bvh: `kerf-bvh/three-mesh-bvh` makes use of it. */
export function packTree(mesh: Mesh, options: BuildOptions = {}): PackedTree {
  return Scratch.use((scratch) => {
    const view = passMesh(scratch, mesh), how = passOptions(scratch, options);
    withProgress(options.onProgress, () => check(core().pack(view, how)));
    const [cost, , references] = doubles().subarray(core().numbers() / 8);
    const packed = { nodes: takeItems().words.buffer as ArrayBuffer, triangles: takeOffsets(references), cost };
    core().forget();
    return packed;
  });
}
