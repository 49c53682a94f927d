import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { expect, test } from "vitest";
import type { Settings } from "./page.ts";
import { FIRST_SETTINGS, withRecent } from "./settings.ts";

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

test("of more than twenty machines that were opened the one opened first goes", () => {
  const open = (settings: Settings, at: number) =>
    withRecent(settings, { project: "p", path: `${at}` });
  const paths = (settings: Settings) => settings.recent.map(({ path }) => path);
  const twenty = Array.from({ length: 20 }, (_, at) => at + 1).reduce(open, FIRST_SETTINGS);
  expect([paths(twenty).length, paths(twenty).at(-1)]).toEqual([20, "1"]);
  const more = paths(open(twenty, 21));
  expect([more.length, more[0], more.at(-1)]).toEqual([20, "21", "2"]);
  expect(paths(open(twenty, 1)).slice(0, 2)).toEqual(["1", "20"]);
});
