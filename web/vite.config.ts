import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

/** The page asks the server that it came from; in development it is passed on to the one named here. */
const server = process.env["RAFCON_URL"] ?? "http://127.0.0.1:4747";

/** Asked as by the server's own page, which is the only one that it answers. */
const passedOn = { target: server, ws: true, changeOrigin: true, headers: { origin: server } };

/** Few files, for each request costs a round trip: what the page begins with, what the editor shows at first, all other panels
 * and dialogs, and the editor of scripts. Higher numbers take first what several need. */
const EDITOR =
  /src\/panels\/(inspector\/(?!code\/|script_code|script_conflict)|libraries\/|globals\/|problems\/)|@lezer\/(python|lr|common|highlight)\//;
const GROUPS = [
  { name: "page", test: /src\/app\/main\.tsx$/, priority: 4 },
  { name: "editor", test: EDITOR, priority: 3 },
  { name: "later", test: /src\/(panels\/(?!inspector\/)|app\/dialogs\/)/, priority: 2 },
  { name: "script", test: /(script_code|script_conflict|text_difference)\.tsx$/, priority: 1 },
];

export default defineConfig({
  plugins: [react()],
  worker: { format: "es" },
  build: {
    target: "es2022",
    outDir: "dist",
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 2000,
    rolldownOptions: { output: { codeSplitting: { groups: GROUPS } } },
  },
  server: { host: "127.0.0.1", proxy: { "/api": passedOn, "^/\\?token=[0-9a-f]{64}": passedOn } },
  test: { include: ["src/**/*.test.{ts,tsx}", "bench/**/*.test.ts"], environment: "node" },
});
