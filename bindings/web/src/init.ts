// The WebAssembly module: from where it comes.

import { KerfError, start } from './core.js';

/** Where the module comes from: bytes, a response or its promise, a URL to fetch, or a compiled module. */
export type ModuleSource = BufferSource | Response | PromiseLike<Response> | URL | WebAssembly.Module;

let module: Promise<WebAssembly.Module> | undefined;
let ready: Promise<void> | undefined;

/**
 * Loads the module, once: later calls wait for the first. Without a source it is the one inside this package, which
 * needs no request and no help from a bundler; `kerf-bvh/kerf.wasm` is the same one as a file.
 */
export function init(source?: ModuleSource): Promise<void> {
  ready ??= load(source).catch((error) => {
    ready = module = undefined;
    throw error;
  });
  return ready;
}

/** The module that `init` has compiled, for workers. */
export async function compiled(): Promise<WebAssembly.Module> {
  await init();
  return module!;
}

async function load(source?: ModuleSource): Promise<void> {
  module = compile(source);
  await start(await module);
}

async function compile(source?: ModuleSource): Promise<WebAssembly.Module> {
  source ??= await inside();
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof URL) source = await fetch(source);
  if ('then' in source) source = await source;
  if (!(source instanceof Response)) return WebAssembly.compile(source as BufferSource);
  if (!source.ok) throw new KerfError('io', `${source.url}: the server answers ${source.status}`);
  return WebAssembly.compile(await source.arrayBuffer());
}

// The module is packed, for those who load this package from a server that packs nothing.
async function inside(): Promise<ArrayBuffer> {
  const { packed } = await import('./module.js');
  const text = atob(packed);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Response(unpacked).arrayBuffer();
}
