import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";
import { JOURNEY_MS, PATIENCE } from "./support/patience.ts";

/** Journeys: a browser, the page as it is built, the real server. Two at a time, one for each processor of the smallest machine: more of
 * them press each other beyond the times that people wait. The files of one process share its modules and its browser, where each journey has a profile of its own. */
export default defineConfig({
  root: fileURLToPath(new URL("..", import.meta.url)),
  test: {
    include: ["e2e/**/*.journey.ts"],
    environment: "node",
    pool: "forks",
    isolate: false,
    maxWorkers: 2,
    testTimeout: JOURNEY_MS,
    hookTimeout: JOURNEY_MS,
    retry: 0,
    expect: { poll: PATIENCE },
  },
});
