/** Colours and layers have names, so that themes and stacking are decided in one file. */

import { readdirSync, readFileSync } from "node:fs";
import { expect, test } from "vitest";

const SOURCE = new URL("../", import.meta.url);
const TOKENS = "ui/tokens.css";

/** A colour by its components, and a layer by its number. */
const RAW = /#[0-9a-f]{3,8}\b|\b(?:rgb|hsl|oklch)a?\(|z-index:\s*\d+/gi;

test("colours and layers are tokens in every style sheet", () => {
  const files = readdirSync(SOURCE, { recursive: true, encoding: "utf8" })
    .map((path) => path.replaceAll("\\", "/"))
    .filter((path) => path.endsWith(".css") && path !== TOKENS);
  const raw = files.flatMap((file) =>
    [...readFileSync(new URL(file, SOURCE), "utf8").matchAll(RAW)].map(([text]) => [file, text]),
  );
  expect(files.length).toBeGreaterThan(40);
  expect(raw).toEqual([]);
});

test("every used token is declared", () => {
  const used = new Set<string>();
  for (const path of readdirSync(SOURCE, { recursive: true, encoding: "utf8" })) {
    if (!/\.(?:css|tsx?)$/.test(path)) continue;
    const text = readFileSync(new URL(path.replaceAll("\\", "/"), SOURCE), "utf8");
    for (const [, name = ""] of text.matchAll(/var\((--(?:layer|code|text|space)-[\w-]+)\)/g)) {
      used.add(name);
    }
  }
  const tokens = readFileSync(new URL(TOKENS, SOURCE), "utf8");
  const missing = [...used].filter((name) => !tokens.includes(`  ${name}:`));
  expect(missing).toEqual([]);
});
