// kerf-bvh beside three-mesh-bvh: the same meshes, rays and points in one run, interleaved, the best of several.
//
// usage: node bench/bench.mjs [--browser] [--repeats N] [--rays N] [--json FILE] [MODEL...]
//
// A model is torus, beams, or a file: .obj, .ply, .stl. `:30` behind it turns it by 30 degrees about all axes.
// `--browser` runs it in a page of headless Chromium.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import * as THREE from 'three';
import { beams, torus } from '../tests/support/meshes.mjs';
import { launch, serve } from '../tests/support/browser.mjs';
import { raceModel } from './race.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    browser: { type: 'boolean', default: false }, repeats: { type: 'string', default: '3' },
    rays: { type: 'string', default: '20000' }, json: { type: 'string' },
  },
});
const repeats = Number(values.repeats), rayCount = Number(values.rays);
const models = positionals.length ? positionals : ['torus', 'beams'];

async function geometryOf(model) {
  const [name, angle] = model.split(':');
  let geometry;
  if (name === 'torus' || name === 'beams') {
    const mesh = name === 'torus' ? torus(1000, 200) : beams(4000, 9);
    geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(mesh.positions, 3));
    geometry.setIndex(new THREE.BufferAttribute(mesh.index, 1));
  } else if (name.endsWith('.obj')) {
    geometry = readObj(readFileSync(name, 'utf8'));
  } else {
    const kind = name.slice(-3).toUpperCase();
    const loaders = await import(`three/addons/loaders/${kind}Loader.js`);
    geometry = new loaders[`${kind}Loader`]().parse(readFileSync(name).buffer);
  }
  if (angle) {
    const a = (Number(angle) * Math.PI) / 180;
    for (const turn of ['rotateZ', 'rotateY', 'rotateX']) geometry[turn](a);
  }
  return geometry;
}

function readObj(text) {
  const positions = [], index = [];
  for (const line of text.split('\n')) {
    const [kind, ...rest] = line.trim().split(/\s+/);
    if (kind === 'v') positions.push(...rest.slice(0, 3).map(Number));
    if (kind !== 'f') continue;
    const at = rest.map((corner) => parseInt(corner)).map((k) => (k < 0 ? positions.length / 3 + k : k - 1));
    for (let i = 2; i < at.length; ++i) index.push(at[0], at[i - 1], at[i]);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
  return geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
}

/** `raceModel` in a page of Chromium, and what to call when all is done. */
async function openBrowser() {
  const folder = mkdtempSync(join(tmpdir(), 'kerf-bench-')), web = fileURLToPath(new URL('..', import.meta.url));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  process.once('SIGINT', () => process.exit(130)); // an exit: Playwright ends the browser then
  const imports = { three: '/web/node_modules/three/build/three.module.js', 'three-mesh-bvh': '/web/node_modules/three-mesh-bvh/build/index.module.js' };
  writeFileSync(join(folder, 'index.html'), `<!doctype html><script type="importmap">${JSON.stringify({ imports })}</script>`);
  const { server, root } = await serve({ '/web/': web, '/': folder }), browser = await launch(), page = await browser.newPage();
  page.setDefaultTimeout(0);
  await page.goto(`${root}/index.html`);
  const race = (geometry, rays, times) => {
    writeFileSync(join(folder, 'positions'), new Uint8Array(geometry.attributes.position.array.buffer));
    if (geometry.index) writeFileSync(join(folder, 'index'), new Uint8Array(Uint32Array.from(geometry.index.array).buffer));
    return page.evaluate(async ([indexed, rays, times]) => {
      const { raceModel } = await import('/web/bench/race.mjs');
      const { BufferAttribute, BufferGeometry } = await import('three');
      const numbers = async (file) => (await fetch(`/${file}`)).arrayBuffer();
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(new Float32Array(await numbers('positions')), 3));
      if (indexed) geometry.setIndex(new BufferAttribute(new Uint32Array(await numbers('index')), 1));
      return raceModel(geometry, rays, times);
    }, [geometry.index !== null, rays, times]);
  };
  const close = async () => {
    await browser.close();
    server.close();
  };
  return { race, close, name: `Chromium ${browser.version()}` };
}

const version = (name) => JSON.parse(readFileSync(new URL(`../node_modules/${name}/package.json`, import.meta.url), 'utf8')).version;
const { race, close, name } = values.browser ? await openBrowser() : { race: raceModel, close: () => {}, name: `Node ${process.version}` };
const report = { cpu: cpus()[0].model.trim(), engine: name, three: version('three'), 'three-mesh-bvh': version('three-mesh-bvh'), models: [] };
console.log(`${report.cpu}, ${name}, three ${report.three}, three-mesh-bvh ${report['three-mesh-bvh']}\n`);

const best = (times) => Math.min(times.CENTER, times.AVERAGE, times.SAH);
for (const model of models) {
  const result = await race(await geometryOf(model), rayCount, repeats), { triangles, rays, points, build, first, many, closest, shapes } = result;
  const each = (times, text) => Object.fromEntries(Object.entries(times).map(([who, seconds]) => [who, text(seconds)]));
  const rate = (count) => (seconds) => `${(count / seconds / 1e6).toFixed(3)} M/s`;
  const factor = (times, who = 'kerf') => ({ factor: (best(times) / times[who]).toFixed(2) });
  console.log(`${model}: ${triangles} triangles, ${rays} rays, ${points} points`);
  console.table({
    build: { ...each(build, (seconds) => `${(1000 * seconds).toFixed(0)} ms`), ...factor(build) },
    'raycaster, first hit': { ...each(first, rate(rays)), ...factor(first) },
    'many rays': { ...each(many, rate(rays)), ...factor(many) },
    'closest point': { ...each(closest, rate(points)), ...factor(closest) },
    'closest points': factor(closest, 'kerf, many'),
  });
  const theirs = (what) => (shapes[`SAH${what}`] / shapes[`kerf's tree${what}`]).toFixed(2);
  console.log(`their calls on kerf's tree over their SAH tree: shapecast ${theirs('')} rays ${theirs(', rays')} spheres ${theirs(', spheres')}`);
  console.log('clear hits missed', result.missed, '\n');
  report.models.push({ model, ...result });
}
await close();
if (values.json) writeFileSync(values.json, JSON.stringify(report, null, 1));
