// For three-mesh-bvh: a tree of kerf in the buffers of that library, whose calls then run on spatial splits.

import { BufferAttribute, BufferGeometry } from 'three';
import { MeshBVH } from 'three-mesh-bvh';

import { type BuildOptions, type Mesh, type PackedTree, packTree } from './bvh.js';
import { meshOf } from './three.js';

/** What `MeshBVH.deserialize` takes. */
export interface SerializedTree {
  version: 1;
  roots: ArrayBuffer[];
  index: Uint32Array | Uint16Array | null;
  indirectBuffer: Uint32Array;
}

/** Which triangles: from that number of corners on, so many, as `THREE.BufferGeometry.drawRange` has it. */
export interface Range {
  start: number;
  count: number;
}

// Triangles that three-mesh-bvh has in its trees: those of the draw range and, where there are groups, of a group.
function trianglesOf(geometry: BufferGeometry, corners: number, range: Range): Uint32Array | null {
  const clip = (part: Range): [number, number] => [
    Math.max(0, Math.floor(Math.max(part.start, range.start) / 3)),
    Math.floor(Math.min(corners, part.start + part.count, range.start + range.count) / 3),
  ];
  const parts = (geometry.groups.length > 0 ? geometry.groups : [{ start: 0, count: Infinity }]).map(clip);
  if (parts.some(([first, last]) => first === 0 && last === Math.floor(corners / 3))) return null; // all
  const inside = new Set<number>();
  for (const [first, last] of parts) for (let i = first; i < last; ++i) inside.add(i);
  return Uint32Array.from(inside).sort();
}

/** The tree of a geometry, as `MeshBVH.serialize` would write it. */
export function serializedTree(geometry: BufferGeometry, options: BuildOptions & { range?: Range } = {}): SerializedTree {
  const mesh = meshOf(geometry);
  const corners = mesh.index ? mesh.index.length : mesh.positions.length / 3;
  const some = trianglesOf(geometry, corners, options.range ?? geometry.drawRange);
  const packed = some ? packSome(mesh, some, options) : packTree(mesh, options);
  const index = (geometry.index?.array ?? null) as Uint32Array | Uint16Array | null;
  return { version: 1, roots: [packed.nodes], index, indirectBuffer: packed.triangles };
}

function packSome(mesh: Mesh, some: Uint32Array, options: BuildOptions): PackedTree {
  const index = new Uint32Array(3 * some.length);
  some.forEach((triangle, i) => {
    for (let k = 0; k < 3; ++k) index[3 * i + k] = mesh.index ? mesh.index[3 * triangle + k] : 3 * triangle + k;
  });
  const packed = packTree({ ...mesh, index }, options);
  return { ...packed, triangles: packed.triangles.map((i) => some[i]) };
}

/**
 * A `MeshBVH` over a geometry whose tree is kerf's. The geometry's index stays as it is (`indirect`). With spatial
 * splits a triangle may stand in several leaves: docs/guide/web.md says what that means for each call.
 */
export function buildMeshBVH(geometry: BufferGeometry, options: BuildOptions & { range?: Range } = {}): MeshBVH {
  const tree = serializedTree(geometry, options);
  const bvh = MeshBVH.deserialize(tree as unknown as Parameters<typeof MeshBVH.deserialize>[0], geometry,
    { setIndex: false, indirect: true } as Parameters<typeof MeshBVH.deserialize>[2]);
  if (geometry.boundingBox === null) geometry.computeBoundingBox();
  return bvh;
}

/** Options of `buildExpandedMeshBVH`. */
export interface ExpandedOptions extends BuildOptions {
  range?: Range;
  /** A root, and a group of the new geometry, for each group that has triangles: materials in an array need them. Else
   * one root, as `MeshBVHUniformStruct` has it, and no groups. Default: false. */
  groups?: boolean;
}

/**
 * For shaders, which make no room for triangles that an indirect buffer repeats: a `MeshBVH` without one, over a
 * geometry of the same attributes whose index repeats them. `bvh.geometry` is that geometry. docs/guide/web.md says
 * how three-gpu-pathtracer takes it.
 */
export function buildExpandedMeshBVH(geometry: BufferGeometry, { groups = false, ...options }: ExpandedOptions = {}): MeshBVH {
  const whole = options.range ?? geometry.drawRange;
  const parts = groups && geometry.groups.length > 0 ? geometry.groups : [{ start: 0, count: Infinity, materialIndex: 0 }];
  const trees = parts.map((part) => {
    const start = Math.max(part.start, whole.start), end = Math.min(part.start + part.count, whole.start + whole.count);
    return { ...serializedTree(geometry, { ...options, range: { start, count: end - start } }), materialIndex: part.materialIndex };
  }).filter(({ indirectBuffer }, _, { length }) => length === 1 || indirectBuffer.length > 0);

  const expanded = new BufferGeometry();
  for (const [name, attribute] of Object.entries(geometry.attributes)) expanded.setAttribute(name, attribute);
  const index = new Uint32Array(3 * trees.reduce((sum, { indirectBuffer }) => sum + indirectBuffer.length, 0));
  let at = 0;
  for (const { roots, indirectBuffer, materialIndex } of trees) {
    moveLeaves(roots[0], at / 3);
    if (groups && geometry.groups.length > 0) expanded.addGroup(at, 3 * indirectBuffer.length, materialIndex);
    for (const triangle of indirectBuffer)
      for (let k = 0; k < 3; ++k) index[at++] = geometry.index ? geometry.index.getX(3 * triangle + k) : 3 * triangle + k;
  }
  expanded.setIndex(new BufferAttribute(index, 1));
  expanded.computeBoundingBox();
  const tree = { version: 1, roots: trees.map(({ roots }) => roots[0]), index, indirectBuffer: null };
  return MeshBVH.deserialize(tree as unknown as Parameters<typeof MeshBVH.deserialize>[0], expanded,
    { setIndex: false } as Parameters<typeof MeshBVH.deserialize>[2]);
}

// Lets the leaves of a tree begin so many triangles later.
function moveLeaves(root: ArrayBuffer, triangles: number): void {
  const words = new Uint32Array(root), halves = new Uint16Array(root);
  for (let node = 0; node < words.length; node += 8) if (halves[2 * node + 15] === 0xffff) words[node + 6] += triangles;
}
