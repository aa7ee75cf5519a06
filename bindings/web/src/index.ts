export { isReady, KerfError, type KerfErrorCode } from './core.js';
export { init, type ModuleSource } from './init.js';
export * from './bvh.js';
export { buildInWorker, type WorkerOptions } from './build-in-worker.js';
