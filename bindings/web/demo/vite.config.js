// `vite build demo`: a page for any server of files, at any place on it.
export default {
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 1200 },
  worker: { format: 'es' },
};
