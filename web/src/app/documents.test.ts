/** What the documents say of the page is held by tests that are there. */

import { readdirSync, readFileSync } from "node:fs";
import { expect, test } from "vitest";

const REPOSITORY = new URL("../../../", import.meta.url);

/** `web/e2e/draw.journey.ts` “a state is moved”: a file, and the words of a test in it. */
const NAMED = /`(web\/[^`]+\.ts)` “([^”]+)”/g;

function read(path: string): string {
  return readFileSync(new URL(path, REPOSITORY), "utf8");
}

const documents = readdirSync(new URL("docs", REPOSITORY)).filter((name) => name.endsWith(".md"));

test.each(documents)("tests of the page that docs/%s names are there", (document) => {
  const named = [...read(`docs/${document}`).matchAll(NAMED)];
  const gone = named.filter(([, file = "", words = ""]) => !read(file).includes(`"${words}"`));
  expect(gone.map(([text]) => text)).toEqual([]);
});

test("journeys wait by the times of one file", () => {
  const files = readdirSync(new URL("web/e2e", REPOSITORY), { recursive: true, encoding: "utf8" });
  const others = files.filter((name) => name.endsWith(".ts") && !name.endsWith("patience.ts"));
  const own = others.filter((name) => /[tT]imeout(\(|: )\d/.test(read(`web/e2e/${name}`)));
  // Waits for a picture that somebody wants to look at.
  expect(own).toEqual(["mission_words.journey.ts"]);
});
