// Bundlers as they come: a page that builds in a worker needs no plugin and no option.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { after, before, test } from 'node:test';
import { build } from 'vite';
import webpack from 'webpack';
import { complaintsOf, hasBrowser, launch, serve } from './support/browser.mjs';

const program = `import { buildInWorker, init } from 'kerf-bvh';
await init();
const bvh = await buildInWorker({ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0] });
document.title = \`hit \${bvh.intersect([0.25, 0.25, 1], [0, 0, -1])?.t}\`;
`;
// It says that it has no icon, for which a browser asks otherwise.
const pageOf = (script) => `<!doctype html><link rel="icon" href="data:,">${script}`;
let folder, browser;

before(async () => {
  // Inside the package, so that it is found by its own name.
  folder = mkdtempSync(fileURLToPath(new URL('../.bundle-', import.meta.url)));
  writeFileSync(join(folder, 'main.js'), program);
  writeFileSync(join(folder, 'index.html'), pageOf('<script type="module" src="./main.js"></script>'));
  if (hasBrowser) browser = await launch();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

/** The one file that holds the module, of those that a bundler made. */
function holdingTheModule(assets) {
  const sizes = Object.fromEntries(readdirSync(assets).map((name) => [name, readFileSync(join(assets, name)).length]));
  const holding = Object.keys(sizes).filter((name) => sizes[name] > 150000);
  assert.equal(holding.length, 1, JSON.stringify(sizes));
  return holding[0];
}

/** Opens what a bundler made as static files, below a path that it was not told of. */
async function opened(dist) {
  const { server, root } = await serve({ '/some/where/': dist });
  const page = await browser.newPage();
  const complaints = complaintsOf(page);
  try {
    await page.goto(`${root}/some/where/`);
    await page.waitForFunction(() => document.title !== '', null, { timeout: 30000 }).catch(() => {});
    return { title: await page.title(), complaints };
  } finally {
    await page.close();
    server.close();
  }
}

test('Vite bundles the package with its worker by its defaults, and the module only where it is loaded', async () => {
  await build({ root: folder, base: './', logLevel: 'error', configFile: false, build: { target: 'es2022', outDir: 'vite' } });
  const assets = join(folder, 'vite/assets'), files = readdirSync(assets);
  assert.ok(files.some((name) => name.startsWith('worker')), files.join());
  assert.ok(holdingTheModule(assets).startsWith('module'));
  if (browser) assert.deepEqual(await opened(join(folder, 'vite')), { title: 'hit 1', complaints: [] });
});

test('webpack bundles the package with its worker by its defaults, and the module only where it is loaded', async () => {
  const output = join(folder, 'webpack');
  const stats = await new Promise((resolve, reject) => {
    webpack({ mode: 'production', context: folder, entry: './main.js', output: { path: output } }, (error, stats) => (error ? reject(error) : resolve(stats)));
  });
  const { errors, warnings } = stats.toJson({ all: false, errors: true, warnings: true });
  assert.deepEqual({ errors, warnings: warnings.filter(({ message }) => !/size limit|code splitting/.test(message)) }, { errors: [], warnings: [] });
  assert.notEqual(holdingTheModule(output), 'main.js');
  writeFileSync(join(output, 'index.html'), pageOf('<script src="main.js"></script>'));
  if (browser) assert.deepEqual(await opened(output), { title: 'hit 1', complaints: [] });
});
