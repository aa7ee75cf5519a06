// Vite, as it comes: a page that builds in a worker needs no plugin and no option.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';
import { build } from 'vite';

test('Vite bundles the package with its worker by its defaults, and the module only where it is loaded', async () => {
  // Inside the package, so that it is found by its own name.
  const folder = mkdtempSync(fileURLToPath(new URL('../.bundle-', import.meta.url)));
  try {
    writeFileSync(join(folder, 'index.html'), '<script type="module" src="./main.js"></script>');
    writeFileSync(join(folder, 'main.js'), `import { buildInWorker, init } from 'kerf-bvh';
      await init();
      console.log((await buildInWorker({ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0] })).statistics);`);
    await build({ root: folder, logLevel: 'error', configFile: false, build: { target: 'es2022' } });
    const assets = join(folder, 'dist/assets'), files = readdirSync(assets);
    assert.ok(files.some((name) => name.startsWith('worker')), files.join());
    const sizes = Object.fromEntries(files.map((name) => [name, readFileSync(join(assets, name)).length]));
    const holding = files.filter((name) => sizes[name] > 150000);
    assert.equal(holding.length, 1, JSON.stringify(sizes));
    assert.ok(holding[0].startsWith('module'));
  } finally {
    rmSync(folder, { recursive: true });
  }
});
