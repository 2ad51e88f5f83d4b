import { defineConfig } from "vitest/config";

// One script and one style sheet of fixed names: the binary embeds them, and an exported page has them inline.
export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    // The folder is there from the start, so that the crate can watch it.
    emptyOutDir: false,
    modulePreload: { polyfill: false },
    assetsInlineLimit: 1_000_000,
    chunkSizeWarningLimit: 2000,
    rollupOptions: {
      output: {
        entryFileNames: "viewer.js",
        assetFileNames: "viewer[extname]",
        codeSplitting: false,
      },
    },
  },
  test: { include: ["src/**/*.test.ts"] },
});
