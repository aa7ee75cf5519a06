// The WebAssembly module: how it is loaded, its memory, and its errors. Nothing here knows what a hierarchy is.

/** What the module exports: see core/kerf_web.cpp. Addresses and counts are 32-bit numbers, statuses 0 or a code. */
export interface Core {
  readonly memory: WebAssembly.Memory;
  allocate(bytes: number): number;
  release(address: number): void;
  error(): number;
  items(): number;
  item_words(): number;
  offsets(): number;
  hit(): number;
  surface_point(): number;
  numbers(): number;
  forget(): void;
  build(mesh: number, options: number, made: number): number;
  pack(mesh: number, options: number): number;
  destroy(bvh: number): void;
  save(bvh: number): number;
  file(): number;
  file_bytes(): number;
  load(bytes: number, count: number, made: number): number;
  statistics(bvh: number): void;
  boxes(bvh: number, level: number): number;
  intersect(bvh: number, ox: number, oy: number, oz: number, dx: number, dy: number, dz: number, tMin: number,
    tMax: number, parts: number, partCount: number): number;
  occluded(bvh: number, ox: number, oy: number, oz: number, dx: number, dy: number, dz: number, tMin: number,
    tMax: number, parts: number, partCount: number): number;
  all_hits(bvh: number, ox: number, oy: number, oz: number, dx: number, dy: number, dz: number, tMin: number,
    tMax: number): number;
  is_front(bvh: number, ox: number, oy: number, oz: number, dx: number, dy: number, dz: number,
    triangle: number): number;
  intersect_many(bvh: number, rays: number, t: number, u: number, v: number, triangle: number, parts: number,
    partCount: number): number;
  occluded_many(bvh: number, rays: number, flags: number, parts: number, partCount: number): number;
  count_hits_many(bvh: number, rays: number, counts: number): number;
  all_hits_many(bvh: number, rays: number): number;
  count_steps(bvh: number, rays: number, steps: number, tests: number): number;
  closest_point(bvh: number, x: number, y: number, z: number, maxDistance: number): number;
  closest_point_many(bvh: number, points: number, count: number, maxDistance: number, positions: number,
    distances: number, u: number, v: number, triangles: number): number;
  contains_many(bvh: number, points: number, count: number, flags: number): number;
  side_many(bvh: number, points: number, count: number, sides: number): number;
  signed_distance_many(bvh: number, points: number, count: number, distances: number): number;
  nearest_many(bvh: number, points: number, count: number, wanted: number, maxDistance: number): number;
  within_many(bvh: number, points: number, count: number, radius: number): number;
  triangles_in(bvh: number, boxes: number, count: number): number;
  touches(bvh: number, other: number, transform: number): number;
  touching_pairs(bvh: number, other: number, transform: number): number;
}

/** The kinds of errors. */
export type KerfErrorCode =
  | 'invalid_argument' // an option or an array that cannot be right
  | 'non_finite_vertex' // a vertex used by a triangle is not a number, infinite, or 2^126 and more
  | 'index_out_of_range' // a triangle names a vertex that does not exist
  | 'too_large' // more references than 32 bits can number
  | 'out_of_memory' // everything allocated before has been freed
  | 'cancelled' // the progress callback asked to stop
  | 'io' // a file cannot be had
  | 'bad_format' // a file is not what it says it is
  | 'internal'; // a fault of the library itself

const codes: KerfErrorCode[] = [
  'invalid_argument', 'non_finite_vertex', 'index_out_of_range', 'too_large', 'out_of_memory', 'cancelled', 'io',
  'bad_format',
];

/** What went wrong: a code to branch on, and a sentence to show. */
export class KerfError extends Error {
  override readonly name = 'KerfError';
  constructor(readonly code: KerfErrorCode, sentence: string) {
    super(sentence);
  }
}

export function refuse(sentence: string): never {
  throw new KerfError('invalid_argument', sentence);
}

let loaded: Core | undefined;

/** What a running build tells of its progress; a build sets it and takes it away. */
let progress: ((fraction: number) => unknown) | undefined;
let thrown: { error: unknown } | undefined; // by `progress`; passed on when the build has ended

/** Calls `work`, during which the module tells `listener` how far it has come. */
export function withProgress<T>(listener: ((fraction: number) => unknown) | undefined, work: () => T): T {
  progress = listener;
  thrown = undefined;
  try {
    return work();
  } catch (error) {
    const of = thrown as { error: unknown } | undefined;
    throw of ? of.error : error;
  } finally {
    progress = undefined;
    thrown = undefined;
  }
}

const success = 0;
const badArgument = 28; // WASI's EINVAL is what its callers here take for "there is none"

const imports = {
  kerf: {
    progress(fraction: number): number {
      try {
        return progress?.(fraction) === false ? 0 : 1;
      } catch (error) {
        thrown = { error };
        return 0;
      }
    },
  },
  env: { emscripten_notify_memory_growth() {} },
  wasi_snapshot_preview1: {
    clock_time_get(_clock: number, _precision: bigint, at: number): number {
      const nanoseconds = BigInt(Math.round(performance.now() * 1e6));
      new DataView(core().memory.buffer).setBigUint64(at, nanoseconds, true);
      return success;
    },
    environ_sizes_get(count: number, bytes: number): number {
      const memory = new DataView(core().memory.buffer);
      memory.setUint32(count, 0, true);
      memory.setUint32(bytes, 0, true);
      return success;
    },
    environ_get: () => success,
    fd_write: () => badArgument,
    fd_seek: () => badArgument,
    fd_close: () => badArgument,
    proc_exit(code: number): never {
      throw new KerfError('internal', `the module ended with status ${code}`);
    },
  },
};

/** Makes the module ready for calls. */
export async function start(module: WebAssembly.Module): Promise<void> {
  const instance = await WebAssembly.instantiate(module, imports);
  loaded = instance.exports as unknown as Core;
  (instance.exports._initialize as () => void)();
}

/** Whether everything else may be called. */
export function isReady(): boolean {
  return loaded !== undefined;
}

export function core(): Core {
  if (loaded === undefined) throw new KerfError('invalid_argument', 'kerf-bvh is not loaded yet: await init() first');
  return loaded;
}

// Views of the module's memory, made anew when it has grown.
let buffer: ArrayBufferLike | undefined;
let f32: Float32Array, u32: Uint32Array, u8: Uint8Array, f64: Float64Array;

function views(): void {
  const now = core().memory.buffer;
  if (now === buffer) return;
  buffer = now;
  f32 = new Float32Array(now);
  u32 = new Uint32Array(now);
  u8 = new Uint8Array(now);
  f64 = new Float64Array(now);
}

/** The memory as floats, of which address / 4 is the place; valid until the next call into the module. */
export function floats(): Float32Array {
  views();
  return f32;
}
export function words(): Uint32Array {
  views();
  return u32;
}
export function bytes(): Uint8Array {
  views();
  return u8;
}
export function doubles(): Float64Array {
  views();
  return f64;
}

/** Throws what a status stands for. */
export function check(status: number): void {
  if (status === 0) return;
  const memory = bytes();
  const begin = core().error();
  let end = begin;
  while (memory[end] !== 0) ++end;
  throw new KerfError(codes[status - 1] ?? 'internal', new TextDecoder().decode(memory.slice(begin, end)));
}

/** Memory of the module, which whoever takes it gives back with `core().release`. */
export function allocate(size: number): number {
  // An address has 32 bits: larger numbers would come out as smaller ones.
  const address = size < 2 ** 32 - 64 ? core().allocate(Math.max(size, 1)) >>> 0 : 0;
  if (address === 0) throw new KerfError('out_of_memory', `not enough memory for ${size} bytes`);
  return address;
}

/** Memory of the module, taken piece by piece and given back as a whole when `work` ends. */
export class Scratch {
  private readonly taken: number[] = [];

  static use<T>(work: (scratch: Scratch) => T): T {
    const scratch = new Scratch();
    try {
      return work(scratch);
    } finally {
      scratch.release();
    }
  }

  release(): void {
    for (const address of this.taken.splice(0)) core().release(address);
  }

  take(size: number): number {
    const address = allocate(size);
    this.taken.push(address);
    return address;
  }
  floats(data: ArrayLike<number>): number {
    const address = this.take(4 * data.length);
    floats().set(data, address / 4);
    return address;
  }
  words(data: ArrayLike<number>): number {
    const address = this.take(4 * data.length);
    words().set(data, address / 4);
    return address;
  }
  bytes(data: Uint8Array): number {
    const address = this.take(data.length);
    bytes().set(data, address);
    return address;
  }
  doubles(data: ArrayLike<number>): number {
    const address = this.take(8 * data.length);
    doubles().set(data, address / 8);
    return address;
  }
}
