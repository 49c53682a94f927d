import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { shades } from "./colours.ts";

const TOKENS = readFileSync(new URL("../../ui/tokens.css", import.meta.url), "utf8");

/** The colours of a theme, by their variables. */
function theme(start: string): ReadonlyMap<string, string> {
  const from = TOKENS.indexOf(start);
  const block = TOKENS.slice(from, TOKENS.indexOf("}", from));
  const found = block.matchAll(/--([\w-]+): (#[0-9a-f]{6});/g);
  return new Map([...found].map(([, name = "", colour = ""]) => [name, colour]));
}

function luminance(colour: string): number {
  const parts = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16) / 255);
  const [red = 0, green = 0, blue = 0] = parts.map((part) =>
    part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(one: string, other: string): number {
  const [dark = 0, light = 0] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (light + 0.05) / (dark + 0.05);
}

const THEMES = { dark: ":root {", light: ':root[data-theme="light"] {' };

describe.each(Object.entries(THEMES))("in the %s theme", (_, start) => {
  const colours = theme(start);
  const of = (name: string) => colours.get(name) ?? "#000000";
  const grounds = [...shades(of("canvas-state"), of("canvas-state-deep")), of("canvas-library")];
  const least = (name: string) => Math.min(...grounds.map((ground) => contrast(of(name), ground)));

  test.each(["text", "text-soft", "data", "aborted", "preempted"])("%s can be read", (name) => {
    expect(least(name)).toBeGreaterThanOrEqual(4.5);
  });

  test.each(["canvas-data", "canvas-outcome", "canvas-selection", "running", "waiting"])(
    "%s can be made out",
    (name) => {
      expect(least(name)).toBeGreaterThanOrEqual(3);
    },
  );

  test("names of people can be read, on the canvas and in the bar", () => {
    for (let person = 0; person < 6; person++) {
      const colour = of(`canvas-person-${person}`);
      expect(contrast(of("canvas-on-person"), colour)).toBeGreaterThanOrEqual(4.5);
      expect(contrast(of("ground"), colour)).toBeGreaterThanOrEqual(4.5);
    }
  });
});
