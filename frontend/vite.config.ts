import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import react from "@vitejs/plugin-react";
import type { HtmlTagDescriptor, Plugin } from "vite";
import { defineConfig } from "vitest/config";

const server = "http://127.0.0.1:8000";

/**
 * Has the browser run what asks for the first frame ahead of all other code, and fetch the review page's code beside the
 * first script, which asks for it only when it runs.
 */
function beginEarly(): Plugin {
  return {
    name: "begin-early",
    apply: "build",
    transformIndexHtml(_, { bundle }) {
      const chunks = Object.values(bundle ?? {}).filter((one) => one.type === "chunk");
      const byFile = new Map(chunks.map((one) => [one.fileName, one]));
      const withImports = (chunk: (typeof chunks)[number] | undefined, found = new Set<string>()) => {
        if (!chunk || chunk.isEntry || found.has(chunk.fileName)) return found;
        found.add(chunk.fileName);
        for (const other of chunk.imports) withImports(byFile.get(other), found);
        return found;
      };
      const early = chunks.find((one) => one.name === "early");
      const review = chunks.find((one) => one.name === "ReviewPage");
      if (!early || !review)
        throw new Error("A script of the page is no chunk of its own any more: see vite.config.ts.");
      return [
        {
          tag: "script",
          attrs: { type: "module", async: true, crossorigin: true, src: `/${early.fileName}` },
          injectTo: "head",
        },
        ...[...withImports(review)].map(
          (fileName): HtmlTagDescriptor => ({
            tag: "link",
            attrs: { rel: "modulepreload", crossorigin: true, href: `/${fileName}` },
            injectTo: "head",
          }),
        ),
      ];
    },
  };
}

const COMPRESSED_FROM_BYTES = 4_096;

/** Puts a compressed copy beside each larger file, so that the server need not compress it each time. */
function compress(): Plugin {
  return {
    name: "compress",
    apply: "build",
    async writeBundle({ dir = "" }, bundle) {
      for (const fileName of Object.keys(bundle)) {
        const content = /\.(js|css|svg)$/.test(fileName) ? await readFile(join(dir, fileName)) : Buffer.alloc(0);
        if (content.length < COMPRESSED_FROM_BYTES) continue;
        await writeFile(join(dir, `${fileName}.gz`), gzipSync(content, { level: 9 }));
      }
    },
  };
}

export default defineConfig({
  plugins: [react(), beginEarly(), compress()],
  server: {
    proxy: {
      "/api": { target: server },
      "/scene": { target: server, ws: true },
    },
  },
  build: {
    outDir: "../app/static",
    emptyOutDir: true,
    target: "es2022",
    cssCodeSplit: false,
    rolldownOptions: { input: { index: "index.html", early: "src/early.ts" } },
  },
  test: {
    environment: "node",
    include: ["src/**/*.test.ts"],
  },
});
