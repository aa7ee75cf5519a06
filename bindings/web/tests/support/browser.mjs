// Chromium, and a server that serves files and nothing else: no headers, no paths of its own.
import { createServer } from 'node:http';
import { existsSync, readFileSync } from 'node:fs';
import { extname, join } from 'node:path';

const chromium = process.env.KERF_CHROMIUM ?? '/usr/bin/chromium';

/** Whether there is Chromium, or has to be: then tests fail without it. */
export const hasBrowser = existsSync(chromium) || Boolean(process.env.KERF_REQUIRE_BROWSER);

/** For tests that need Chromium and a file: false, or why they are skipped. */
export function skipWithout(file, what) {
  const there = existsSync(chromium) && existsSync(file);
  return there || process.env.KERF_REQUIRE_BROWSER ? false : `there is no Chromium, or ${what}`;
}

export async function launch() {
  const { chromium: driver } = await import('playwright-core');
  return driver.launch({
    executablePath: chromium,
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--enable-unsafe-swiftshader'], // the last one: WebGL without a GPU
  });
}

const kinds = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };

/** A server of folders, each below a path, and where it is. */
export async function serve(folders) {
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    for (const [prefix, folder] of Object.entries(folders)) {
      const file = path.startsWith(prefix) && join(folder, path.slice(prefix.length) || 'index.html');
      if (!file || !existsSync(file)) continue;
      response.setHeader('content-type', kinds[extname(file)] ?? 'application/octet-stream');
      response.end(readFileSync(file));
      return;
    }
    response.statusCode = 404;
    response.end();
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { server, root: `http://127.0.0.1:${server.address().port}` };
}

/** What a page complains of, from now on. */
export function complaintsOf(page) {
  const complaints = [];
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('requestfailed', (request) => complaints.push(`${request.url()}: ${request.failure()?.errorText}`));
  page.on('response', (response) => response.status() >= 400 && complaints.push(`${response.url()}: ${response.status()}`));
  return complaints;
}
