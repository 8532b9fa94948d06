// Builds the pages: `vite build`, into dist/.

import { defineConfig } from 'vite';
import { mountain } from './vite.mountain.js';

export default defineConfig({
  // Wherever it is put, below whatever address.
  base: './',
  plugins: [mountain()],
  server: { fs: { allow: ['..'] } },
  build: { target: 'es2022', rollupOptions: { input: { index: 'index.html', play: 'play.html' } } },
});
