// What runs in the worker of `buildInWorker`: one build, then it is ended.

import type { Task, Told } from './build-in-worker.js';
import { Bvh } from './bvh.js';
import { KerfError, start } from './core.js';

type Tell = (told: Told, transfer?: ArrayBuffer[]) => void;

async function run(task: Task, tell: Tell): Promise<void> {
  try {
    await start(task.module);
    const onProgress = task.tellProgress ? (progress: number) => tell({ progress }) : undefined;
    const bvh = Bvh.build(task.mesh, { ...task.options, onProgress });
    const file = bvh.save() as Uint8Array<ArrayBuffer>;
    tell({ file }, [file.buffer]);
  } catch (error) {
    const code = error instanceof KerfError ? error.code : 'internal';
    tell({ code, sentence: error instanceof Error ? error.message : String(error) });
  }
}

interface Port {
  postMessage(message: unknown, transfer?: unknown[]): void;
}
if (typeof self !== 'undefined' && typeof self.postMessage === 'function') {
  const port = self as unknown as Port & { onmessage: (event: MessageEvent<Task>) => void };
  port.onmessage = (event) => void run(event.data, (told, transfer) => port.postMessage(told, transfer));
} else {
  const threads = 'node:worker_threads';
  void import(/* @vite-ignore */ /* webpackIgnore: true */ threads).then(({ parentPort }) =>
    parentPort?.on('message', (task: Task) => void run(task, (told, transfer) => parentPort.postMessage(told, transfer))));
}
