import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

/** The page asks the server that it came from; in development it is passed on to the one named here. */
const server = process.env["RAFCON_URL"] ?? "http://127.0.0.1:4747";

/** Asked as by the server's own page, which is the only one that it answers. */
const passedOn = { target: server, ws: true, changeOrigin: true, headers: { origin: server } };

export default defineConfig({
  plugins: [react()],
  worker: { format: "es" },
  build: { target: "es2022", outDir: "dist", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000 },
  server: { host: "127.0.0.1", proxy: { "/api": passedOn, "^/\\?token=[0-9a-f]{64}": passedOn } },
  test: { include: ["src/**/*.test.{ts,tsx}", "bench/**/*.test.ts"], environment: "node" },
});
