/** How much a browser loads before it shows anything. */

import { join } from "node:path";
import { expect, test } from "vitest";
import { firstLoad } from "./support/first_load.ts";
import { REPOSITORY } from "./support/places.ts";

const DIST = join(REPOSITORY, "web", "dist");

test("mission control and the editor load without what is shown later", () => {
  expect(firstLoad(DIST, [])).toBeLessThan(250_000);
  expect(firstLoad(DIST, ["dock", "editor"])).toBeLessThan(450_000);
});
