// The reports of `kerf compare` and `kerf sweep` as everyone can read them: axe-core finds nothing serious in light and
// in dark, paper keeps figures whole, and scripts are not needed. It stands here since npm and Playwright do.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { after, before, test } from 'node:test';
import { findings } from './support/accessibility.mjs';
import { launch, skipWithout } from './support/browser.mjs';

const tool = fileURLToPath(new URL('../../../build/release/bin/kerf', import.meta.url));
const pictures = fileURLToPath(new URL('../../../build/web-pictures/', import.meta.url));
const skip = skipWithout(tool, 'no tool: scripts/web builds it');

const reports = { comparison: ['compare', 'sticks:detail=0.02', 'terrain:detail=0.01,rotate=30'], sweep: ['sweep', 'sticks:detail=0.02', '--alphas', '1,1e-3,0'],
  budgets: ['sweep', 'sticks:detail=0.02', '--budgets', '1,1.5'] };
let folder, browser;

before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'kerf-reports-'));
  mkdirSync(pictures, { recursive: true });
  for (const [name, command] of Object.entries(reports))
    execFileSync(tool, [...command, '--pixels', '24x16', '--rounds', '3', '--pictures', '48x32', '--report', join(folder, name)]);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

const addressOf = (name) => pathToFileURL(join(folder, name, 'index.html')).href;

for (const colorScheme of ['light', 'dark']) {
  for (const name of Object.keys(reports)) {
    test(`a ${name} has no serious finding of axe-core, ${colorScheme}`, { skip }, async () => {
      // The report allows no script: axe-core comes past its policy.
      const page = await browser.newPage({ colorScheme, bypassCSP: true });
      await page.goto(addressOf(name));
      assert.deepEqual(await findings(page), []);
      await page.screenshot({ path: join(pictures, `report-${name}-${colorScheme}.png`), fullPage: true });
      await page.close();
    });
  }
}

test('a report on paper cuts no figure, card or row in two, and keeps its colours', { skip }, async () => {
  const page = await browser.newPage({ viewport: { width: 720, height: 1000 } });
  await page.goto(addressOf('comparison'));
  await page.emulateMedia({ media: 'print' });
  const kept = await page.$$eval('figure, .legend, .card, tr, .table', (elements) => elements.map((element) => {
    const style = getComputedStyle(element);
    return [element.tagName, style.breakInside, style.printColorAdjust];
  }));
  assert.ok(kept.length > 40);
  assert.deepEqual(kept.filter(([, inside, colours]) => inside !== 'avoid' || colours !== 'exact'), []);
  const bars = await page.$$eval('.legend', (elements) => elements.map((element) => getComputedStyle(element).breakBefore));
  assert.ok(bars.length > 0 && bars.every((before) => before === 'avoid'), 'a colour bar is on the page of its pictures');
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true);
  await page.pdf({ path: join(pictures, 'report.pdf'), format: 'A4', printBackground: true });
  await page.close();
});

test('a scene and its four builders stand in one row of a wide screen, to be compared', { skip }, async () => {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  await page.goto(addressOf('comparison'));
  const rows = await page.$$eval('.gallery', (galleries) => galleries.map((gallery) => {
    const tops = [...gallery.querySelectorAll('figure')].map((figure) => figure.getBoundingClientRect().top);
    return [tops.length, new Set(tops).size];
  }));
  assert.deepEqual(rows, [[5, 1], [5, 1]]);
  await page.close();
});

test('a report without scripts shows what it shows with them', { skip }, async () => {
  const seen = [];
  for (const javaScriptEnabled of [true, false]) {
    const context = await browser.newContext({ javaScriptEnabled });
    const page = await context.newPage();
    await page.goto(addressOf('comparison'));
    seen.push(await page.screenshot({ fullPage: true }));
    await context.close();
  }
  assert.ok(seen[0].equals(seen[1]));
});
