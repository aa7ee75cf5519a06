// The page, in Chromium, from a server that serves files and nothing else: no headers, no paths of its own.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { after, before, test } from 'node:test';
import { findings } from './support/accessibility.mjs';
import { complaintsOf, launch, serve, skipWithout } from './support/browser.mjs';

const dist = fileURLToPath(new URL('../demo/dist/', import.meta.url));
const pictures = fileURLToPath(new URL('../../../build/web-pictures/', import.meta.url));
const skip = skipWithout(join(dist, 'index.html'), 'no page: scripts/web demo');

let server, browser, root;

before(async () => {
  if (skip) return;
  mkdirSync(pictures, { recursive: true });
  ({ server, root } = await serve({ '/some/where/': dist, '/package/': fileURLToPath(new URL('../dist/', import.meta.url)), '/plain/': fileURLToPath(new URL('plain/', import.meta.url)) }));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  server?.close();
});

/** A page that is complete, and what it complained of. */
async function opened(options = {}, path = '/some/where/') {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 }, ...options });
  const complaints = complaintsOf(page);
  await page.goto(root + path);
  return { page, complaints };
}
/** Waits until the last picture that was asked for is there. */
async function settled(page, act) {
  const last = await page.evaluate(() => window.shown.number);
  await act?.();
  await page.waitForFunction((number) => window.shown.number > number, last, { timeout: 60000 });
  await page.waitForTimeout(100);
}
/** What the picture is, as a number that tells it from others, and how many shades of red are in it. */
const pixels = (page) => page.evaluate(async () => {
  const canvas = document.getElementById('picture');
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const hash = new Uint8Array(await crypto.subtle.digest('SHA-256', data));
  return { hash: [...hash].join(), shades: new Set(data.filter((_, i) => i % 4 === 0)).size };
});
const colours = (image) => image.shades;

test('the page draws a model, and every builder draws the same picture', { skip }, async () => {
  const { page, complaints } = await opened();
  await settled(page);
  const shaded = await pixels(page);
  assert.ok(colours(shaded) > 20);
  for (const builder of ['bvh', 'esc', 'evh']) {
    await settled(page, () => page.selectOption('#builder', builder));
    assert.deepEqual(await pixels(page), shaded);
  }
  await settled(page, () => page.selectOption('#builder', 'sbvh'));
  await page.screenshot({ path: join(pictures, 'shaded.png'), fullPage: true });
  for (const mode of ['ao', 'steps']) {
    await settled(page, () => page.click(`input[value=${mode}]`));
    const image = await pixels(page);
    assert.ok(colours(image) > 10);
    assert.notDeepEqual(image, shaded);
    await page.screenshot({ path: join(pictures, `${mode}.png`) });
  }
  assert.deepEqual(complaints, []);
  await page.close();
});

test('the picture of a split BVH costs fewer steps than that of a plain one, as the table says', { skip }, async () => {
  const { page, complaints } = await opened();
  await settled(page);
  await settled(page, () => page.selectOption('#model', 'beams'));
  await page.click('#compare');
  await page.waitForFunction(() => document.querySelectorAll('#table tbody tr').length === 5 && !document.getElementById('compare').disabled, null, { timeout: 120000 });
  const rows = await page.$$eval('#table tbody tr', (lines) => lines.map((line) => [...line.cells].map((cell) => cell.textContent)));
  const steps = (row) => Number(row[4]) + Number(row[5]);
  assert.ok(steps(rows[0]) < 0.8 * steps(rows[1]), JSON.stringify(rows));
  assert.match(rows[4][0], /three-mesh-bvh/);
  await page.screenshot({ path: join(pictures, 'table.png'), fullPage: true });
  assert.deepEqual(complaints, []);
  await page.close();
});

test('keys turn the model, change the picture and show boxes', { skip }, async () => {
  const { page, complaints } = await opened();
  await settled(page);
  const front = await pixels(page);
  await page.focus('#picture');
  await settled(page, () => page.keyboard.press('ArrowRight'));
  assert.notDeepEqual(await pixels(page), front);
  await settled(page, () => page.keyboard.press('ArrowLeft'));
  assert.deepEqual(await pixels(page), front);
  await settled(page, () => page.keyboard.press('3'));
  assert.equal(await page.isChecked('input[value=steps]'), true);
  const lines = () => page.evaluate(() => {
    const canvas = document.getElementById('boxes');
    return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((x) => x !== 0);
  });
  assert.equal(await lines(), false);
  for (let i = 0; i < 3; ++i) await page.keyboard.press(']');
  await page.waitForTimeout(300);
  assert.equal(await lines(), true);
  await page.screenshot({ path: join(pictures, 'boxes.png') });
  await settled(page, () => page.keyboard.press('b'));
  assert.equal(await page.inputValue('#builder'), 'bvh');
  assert.deepEqual(complaints, []);
  await page.close();
});

test('files of every kind are drawn, and what is none of them is refused by name', { skip }, async () => {
  const { page, complaints } = await opened();
  await settled(page);
  const corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
  const obj = [...corner.map((p) => `v ${p.join(' ')}`), ...faces.map((f) => `f ${f.map((i) => i + 1).join(' ')}`)].join('\n');
  const ply = ['ply', 'format ascii 1.0', 'element vertex 4', 'property float x', 'property float y', 'property float z', 'element face 4',
    'property list uchar int vertex_indices', 'end_header', ...corner.map((p) => p.join(' ')), ...faces.map((f) => `3 ${f.join(' ')}`), ''].join('\n');
  const stl = ['solid s', ...faces.flatMap((f) => ['facet normal 0 0 0', 'outer loop', ...f.map((i) => `vertex ${corner[i].join(' ')}`), 'endloop', 'endfacet']), 'endsolid s'].join('\n');
  const data = Buffer.concat([Buffer.from(new Float32Array(corner.flat()).buffer), Buffer.from(new Uint16Array(faces.flat()).buffer)]);
  const gltf = JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, scale: [2, 2, 2] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 1] }, { bufferView: 1, componentType: 5123, count: 12, type: 'SCALAR' }],
    bufferViews: [{ buffer: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 24 }],
    buffers: [{ byteLength: 72, uri: `data:application/octet-stream;base64,${data.toString('base64')}` }],
  });
  for (const [name, text] of Object.entries({ 'a.obj': obj, 'a.ply': ply, 'a.stl': stl, 'a.gltf': gltf })) {
    await settled(page, () => page.setInputFiles('#file', { name, mimeType: 'text/plain', buffer: Buffer.from(text) }));
    assert.match(await page.textContent('#facts'), /triangles4references/, name);
    assert.ok(colours(await pixels(page)) > 1, name);
  }
  await page.setInputFiles('#file', { name: 'a.txt', mimeType: 'text/plain', buffer: Buffer.from('x') });
  await page.waitForFunction(() => document.getElementById('status').textContent.includes('a.txt: none of'));
  assert.deepEqual(complaints, []);
  await page.close();
});

test('at the width of a phone, dark and light, nothing is cut off', { skip }, async () => {
  for (const colorScheme of ['dark', 'light']) {
    const { page, complaints } = await opened({ viewport: { width: 390, height: 844 }, colorScheme });
    await settled(page);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true);
    const [back, front] = await page.evaluate(() => [getComputedStyle(document.body).backgroundColor, getComputedStyle(document.body).color]);
    const light = (colour) => colour.match(/\d+/g).slice(0, 3).reduce((sum, x) => sum + Number(x), 0);
    assert.equal(light(back) > light(front), colorScheme === 'light');
    await page.screenshot({ path: join(pictures, `phone-${colorScheme}.png`), fullPage: true });
    assert.deepEqual(complaints, []);
    await page.close();
  }
});

test('two fingers zoom, and one turns', { skip }, async () => {
  const { page, complaints } = await opened({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await settled(page);
  const session = await page.context().newCDPSession(page), front = await pixels(page);
  // Points of the picture that are not of the background, which is in its corner.
  const covered = () => page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const words = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    return words.filter((word) => word !== words[0]).length;
  });
  const touch = (type, ...places) => session.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
  const small = await covered();
  await settled(page, async () => {
    await touch('touchStart', [180, 230], [210, 230]);
    await touch('touchMove', [165, 230], [225, 230]);
    await touch('touchEnd');
  });
  await page.waitForTimeout(500);
  assert.ok(await covered() > 1.5 * small);
  await settled(page, async () => {
    await touch('touchStart', [165, 230], [225, 230]);
    await touch('touchMove', [180, 230], [210, 230]);
    await touch('touchEnd');
  });
  await page.waitForTimeout(500);
  assert.deepEqual(await pixels(page), front);
  await settled(page, async () => {
    await touch('touchStart', [180, 230]);
    await touch('touchMove', [230, 230]);
    await touch('touchEnd');
  });
  assert.notDeepEqual(await pixels(page), front);
  assert.equal(await page.isVisible('.keys'), false); // nobody has keys there
  assert.deepEqual(complaints, []);
  await page.close();
});

test('axe-core has nothing serious against the page, dark and light', { skip }, async () => {
  for (const colorScheme of ['dark', 'light']) {
    const { page } = await opened({ colorScheme, bypassCSP: true });
    await settled(page);
    assert.deepEqual(await findings(page), [], colorScheme);
    await page.close();
  }
});

test('a plain script of type module loads the package as it is, and builds in a worker', { skip }, async () => {
  const { page, complaints } = await opened({}, '/plain/index.html');
  await page.waitForFunction(() => window.answer !== undefined, null, { timeout: 30000 });
  assert.deepEqual(await page.evaluate(() => window.answer), { t: 2, triangle: 0, fromWorker: 0, fromFile: 0, progress: true });
  assert.deepEqual(complaints, []);
  await page.close();
});
