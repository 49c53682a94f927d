import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

/** Journeys: a browser, the page as it is built, the real server. Three at a time: each has a server of its own and often waits for
 * it. The files of one process share its modules and its browser, where each journey has a profile of its own. */
export default defineConfig({
  root: fileURLToPath(new URL("..", import.meta.url)),
  test: {
    include: ["e2e/**/*.journey.ts"],
    environment: "node",
    pool: "forks",
    isolate: false,
    maxWorkers: 3,
    testTimeout: 120_000,
    hookTimeout: 120_000,
    retry: 0,
    expect: { poll: { timeout: 20_000, interval: 50 } },
  },
});
