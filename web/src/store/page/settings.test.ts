import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { expect, test } from "vitest";
import { FIRST_SETTINGS } from "./settings.ts";

const SOURCES = join(import.meta.dirname, "..");

function sources(folder: string): string[] {
  return readdirSync(folder).flatMap((name) => {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) return sources(path);
    return /(?<!\.test)\.tsx?$/.test(name) ? [path] : [];
  });
}

test("every setting that can be chosen is read by something else than its dialog", () => {
  const declaring = /settings\.tsx?$|store\/page\.ts$/;
  const texts = sources(SOURCES)
    .filter((path) => !declaring.test(path))
    .map((path) => readFileSync(path, "utf8"));
  const unread = Object.keys(FIRST_SETTINGS).filter(
    (name) => !texts.some((text) => new RegExp(`\\b${name}\\b`).test(text)),
  );
  expect(unread).toEqual([]);
});
