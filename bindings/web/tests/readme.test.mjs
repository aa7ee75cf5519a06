// The code of the documents runs and prints what they say.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';

const here = new URL('../', import.meta.url);
for (const name of ['README.md', '../../docs/guide/web.md', '../../README.md']) {
  const file = new URL(name, here);
  if (!existsSync(file)) continue;
  const programs = [...readFileSync(file, 'utf8').matchAll(/```js\n([\s\S]*?)```\n(?:\n```text\n([\s\S]*?)```)?/g)];
  programs.forEach(([, code, printed], i) => {
    test(`${name}, program ${i + 1}`, () => {
      // Beside package.json, so that the package is found by its own name.
      const program = new URL(`.program-${process.pid}-${i}.mjs`, here);
      writeFileSync(program, code);
      try {
        const output = execFileSync(process.execPath, [fileURLToPath(program)], { encoding: 'utf8' });
        if (printed !== undefined) assert.equal(output, printed);
      } finally {
        rmSync(program);
      }
    });
  });
}
