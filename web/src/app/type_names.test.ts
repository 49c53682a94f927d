/** A type's name stands for one thing in the page. */

import { readdirSync, readFileSync } from "node:fs";
import { expect, test } from "vitest";

const SOURCE = new URL("../", import.meta.url);

/** A type that a file declares outside of functions. */
const DECLARED = /^(?:export )?(?:abstract )?(?:interface|type|class) (\w+)/gm;

/** Files of the product, and the generated words of the protocol; no tests, and nothing that only tests use. */
function isProduct(path: string): boolean {
  return /\.tsx?$/.test(path) && !/\.test\.tsx?$|(^|\/)testing\//.test(path);
}

test("no two files of the page declare types of one name", () => {
  const files = readdirSync(SOURCE, { recursive: true, encoding: "utf8" })
    .map((path) => path.replaceAll("\\", "/"))
    .filter(isProduct);
  const places = new Map<string, string[]>();
  for (const file of files) {
    for (const [, name = ""] of readFileSync(new URL(file, SOURCE), "utf8").matchAll(DECLARED)) {
      places.set(name, [...(places.get(name) ?? []), file]);
    }
  }
  const ambiguous = [...places].filter(([, declaring]) => declaring.length > 1);
  expect(places.size).toBeGreaterThan(500);
  expect(Object.fromEntries(ambiguous)).toEqual({});
});
