// Builds that leave the page alone: in a worker, which can be told to stop.

import { Bvh, type BuildOptions, type Mesh } from './bvh.js';
import { KerfError, type KerfErrorCode } from './core.js';
import { compiled } from './init.js';

/** What a worker is told to build. */
export interface Task {
  module: WebAssembly.Module;
  mesh: Mesh;
  options: BuildOptions;
  tellProgress: boolean;
}

/** What it tells. */
export type Told =
  | { progress: number }
  | { file: Uint8Array<ArrayBuffer> }
  | { code: KerfErrorCode; sentence: string };

export interface WorkerOptions extends BuildOptions {
  /** Stops the build, whose promise is then rejected with the signal's reason. */
  signal?: AbortSignal;
  /** A worker that runs `kerf-bvh/worker`, for bundlers that do not see it by themselves. It ends with the build. */
  worker?: () => Worker;
}

// A worker of the web or of Node.
interface AnyWorker {
  postMessage(message: unknown): void;
  listen(told: (message: Told) => void, failed: (error: unknown) => void): void;
  terminate(): unknown;
}

async function newWorker(make: (() => Worker) | undefined): Promise<AnyWorker> {
  if (make || typeof Worker !== 'undefined') {
    const worker = make ? make() : new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    return {
      postMessage: (message) => worker.postMessage(message),
      listen(told, failed) {
        worker.onmessage = (event) => told(event.data);
        worker.onerror = (event) => failed(new KerfError('internal', event.message || 'the worker cannot be loaded'));
      },
      terminate: () => worker.terminate(),
    };
  }
  const threads = 'node:worker_threads';
  const { Worker: NodeWorker } = await import(/* @vite-ignore */ /* webpackIgnore: true */ threads);
  const worker = new NodeWorker(new URL('./worker.js', import.meta.url));
  return {
    postMessage: (message) => worker.postMessage(message),
    listen: (told, failed) => void worker.on('message', told).on('error', failed),
    terminate: () => worker.terminate(),
  };
}

/** `Bvh.build` in a worker. What comes back is checked as every file is, which takes a fraction of the build. */
export async function buildInWorker(mesh: Mesh, { signal, worker: make, onProgress, ...options }: WorkerOptions = {}): Promise<Bvh> {
  signal?.throwIfAborted();
  const module = await compiled();
  const worker = await newWorker(make);
  let abort: (() => void) | undefined;
  try {
    const file = await new Promise<Uint8Array>((resolve, reject) => {
      abort = () => reject(signal!.reason);
      if (signal?.aborted) return abort();
      signal?.addEventListener('abort', abort);
      worker.listen((told) => {
        if ('progress' in told) {
          try {
            if (onProgress?.(told.progress) === false) reject(new KerfError('cancelled', 'the build was cancelled'));
          } catch (error) {
            reject(error);
          }
        } else if ('file' in told) {
          resolve(told.file);
        } else {
          reject(new KerfError(told.code, told.sentence));
        }
      }, reject);
      worker.postMessage({ module, mesh, options, tellProgress: onProgress !== undefined } satisfies Task);
    });
    return Bvh.load(file);
  } finally {
    if (abort) signal?.removeEventListener('abort', abort);
    await worker.terminate();
  }
}
