// Puts the WebAssembly module into the package: as dist/kerf.wasm, and packed inside dist/module.js.
import { readFileSync, writeFileSync, copyFileSync } from 'node:fs';
import { brotliCompressSync, deflateRawSync } from 'node:zlib';

const dist = new URL('dist/', import.meta.url);
const source = new URL(process.env.KERF_WASM ?? '../../build/web/kerf_web.wasm', import.meta.url);
const module = readFileSync(source);
copyFileSync(source, new URL('kerf.wasm', dist));
copyFileSync(new URL('../../LICENSE', import.meta.url), new URL('LICENSE', dist));
const packed = deflateRawSync(module, { level: 9 }).toString('base64');
writeFileSync(new URL('module.js', dist), `// kerf.wasm, deflated, in base64\nexport const packed = '${packed}';\n`);
writeFileSync(new URL('module.d.ts', dist), 'export declare const packed: string;\n');
console.log(`kerf.wasm: ${module.length} bytes, ${brotliCompressSync(module).length} with brotli; ` +
  `module.js: ${packed.length}, ${brotliCompressSync(packed).length} with brotli`);
