// Chromium with WebGPU in software, and a server for the built pages.

import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import { dirname, extname, join, normalize } from 'node:path';
import { type Browser, chromium } from 'playwright-core';

const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.capsule': 'application/octet-stream',
};

/** Serves the files of folders, the first that has one, on a free port of this machine. */
export async function serve(folders: readonly string[]): Promise<{ address: string; server: Server }> {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url ?? '/', 'http://localhost').pathname));
    const file = folders.map((folder) => join(folder, path)).find((name) => existsSync(name) && statSync(name).isFile());
    if (!file) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' });
    createReadStream(file).pipe(response);
  });
  await new Promise<void>((listening) => server.listen(0, '127.0.0.1', listening));
  const address = server.address();
  if (!address || typeof address === 'string') throw new Error('the server has no port');
  return { address: `http://127.0.0.1:${address.port}/`, server };
}

/** Where Chromium is: as CHROMIUM says, or as Debian installs it. */
export function chromiumPath(): string | undefined {
  const places = [process.env['CHROMIUM'], '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  return places.find((place) => place !== undefined && existsSync(place));
}

/** Headless, its WebGPU computed by SwiftShader: the same pictures on every machine. */
export async function launch(webgpu = true): Promise<Browser> {
  const executablePath = chromiumPath();
  if (!executablePath) throw new Error('there is no Chromium');
  const args = ['--no-sandbox', '--force-color-profile=srgb', '--hide-scrollbars'];
  if (webgpu) {
    args.push('--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader');
    // All of the browser on the same software Vulkan: with OpenGL beside it, a canvas of WebGPU ends the GPU process.
    // Software on a busy machine takes long over a shader; nobody sits before it who would think that it hangs.
    args.push('--disable-gpu-watchdog');
    args.push('--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan');
  }
  if (!webgpu) args.push('--disable-features=WebGPU', '--disable-gpu');
  return chromium.launch({ executablePath, args, headless: true, timeout: PATIENCE });
}

/**
 * Most that anything may take before it counts as hung, milliseconds. On a quiet machine all takes a few seconds; on a
 * software adapter that others keep busy, compiling alone takes a minute.
 */
export const PATIENCE = 240_000;

/** What a promise gives; where it takes longer than it may, an error that says what was waited for. */
export async function within<T>(what: string, milliseconds: number, promise: Promise<T>): Promise<T> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const late = new Promise<never>((_, refuse) => {
    timer = setTimeout(() => refuse(new Error(`${what}: nothing after ${milliseconds / 1000} s; the browser hangs`)), milliseconds);
  });
  try {
    return await Promise.race([promise, late]);
  } finally {
    clearTimeout(timer);
  }
}

/**
 * Ends this program with code 3 and a line that says so after so many seconds, whatever it waits for. Its browser ends
 * with it: Playwright kills it as the process exits.
 */
export function endAfter(seconds: number): void {
  const timer = setTimeout(() => {
    console.log(`WRONG  not done after ${seconds} s: the browser is killed`);
    process.exit(3);
  }, seconds * 1000);
  timer.unref();
}

/** The folder of this package: the first above this file that holds package.json, wherever the build puts this file. */
export const ROOT = ((): string => {
  let folder = import.meta.dirname;
  while (!existsSync(join(folder, 'package.json'))) {
    const above = dirname(folder);
    if (above === folder) throw new Error(`no folder above ${import.meta.dirname} holds package.json`);
    folder = above;
  }
  return folder;
})();
