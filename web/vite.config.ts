import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

/** The page asks the server that it came from; in development it is passed on to the one named here. */
const server = process.env["RAFCON_URL"] ?? "http://127.0.0.1:4747";

export default defineConfig({
  plugins: [react()],
  worker: { format: "es" },
  build: { target: "es2022", outDir: "dist", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000 },
  server: { proxy: { "/api": { target: server, ws: true } } },
  test: { include: ["src/**/*.test.{ts,tsx}", "bench/**/*.test.ts"], environment: "node" },
});
