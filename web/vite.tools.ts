// Builds what runs in Node: `vite build --config vite.tools.ts`.

import { defineConfig } from 'vite';

export default defineConfig({
  build: {
    ssr: true,
    outDir: 'dist-tools',
    target: 'node20',
    minify: false,
    rollupOptions: { input: { figures: 'test/figures.ts', hangs: 'test/hangs.ts', node: 'test/node.ts', run: 'test/run.ts', time: 'test/time.ts' } },
  },
});
