import react from "@vitejs/plugin-react";
import type { HtmlTagDescriptor, Plugin } from "vite";
import { defineConfig } from "vitest/config";

const server = "http://127.0.0.1:8000";

/** Lets the browser fetch the review page's code beside the first script, which asks for it only when it runs. */
function preloadReview(): Plugin {
  return {
    name: "preload-review",
    apply: "build",
    transformIndexHtml(_, { bundle }) {
      const chunks = Object.values(bundle ?? {}).filter((one) => one.type === "chunk");
      const byFile = new Map(chunks.map((one) => [one.fileName, one]));
      const needed = new Set<string>();
      const need = (fileName: string) => {
        const chunk = byFile.get(fileName);
        if (!chunk || chunk.isEntry || needed.has(fileName)) return;
        needed.add(fileName);
        for (const other of chunk.imports) need(other);
      };
      for (const chunk of chunks) if (chunk.name === "ReviewPage") need(chunk.fileName);
      if (needed.size === 0) throw new Error("The review page is no chunk of its own any more: see vite.config.ts.");
      return [...needed].map(
        (fileName): HtmlTagDescriptor => ({
          tag: "link",
          attrs: { rel: "modulepreload", crossorigin: true, href: `/${fileName}` },
          injectTo: "head",
        }),
      );
    },
  };
}

export default defineConfig({
  plugins: [react(), preloadReview()],
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
  },
  test: {
    environment: "node",
    include: ["src/**/*.test.ts"],
  },
});
