import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

// One page, everything inside: it is opened from disk, mailed, and embedded in the binary.
export default defineConfig({
  base: "./",
  plugins: [viteSingleFile({ removeViteModuleLoader: true })],
  // A classic script, because a worker from a blob may not import.
  worker: { format: "iife" },
  build: { target: "es2022", modulePreload: false, reportCompressedSize: true, chunkSizeWarningLimit: 2000 },
});
