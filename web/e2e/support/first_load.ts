/** What a browser loads before it shows the page: the files that are named by the page itself, and all that these import at once. */

import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

/** Bytes of scripts and styles, packed, of the page built in `dist` and of these parts of it. */
export function firstLoad(dist: string, parts: readonly string[]): number {
  const assets = readdirSync(join(dist, "assets"));
  const text = (file: string) => readFileSync(join(dist, "assets", file), "utf8");
  const named = (source: string, pattern: RegExp) =>
    [...source.matchAll(pattern)].map(([, file = ""]) => file);
  const page = readFileSync(join(dist, "index.html"), "utf8");
  const waiting = named(page, /assets\/([\w.-]+\.(?:js|css))"/g);
  for (const part of parts) {
    const own = assets.filter((file) => new RegExp(`^${part}-[\\w-]{8}\\.(js|css)$`).test(file));
    if (own.length === 0) throw new Error(`${part} has no file of its own in ${dist}`);
    waiting.push(...own);
  }
  const loaded = new Set<string>();
  for (let file = waiting.pop(); file !== undefined; file = waiting.pop()) {
    if (loaded.has(file)) continue;
    loaded.add(file);
    if (file.endsWith(".js")) {
      waiting.push(...named(text(file), /(?:from|import)\s*"\.\/([\w.-]+\.js)"/g));
    }
  }
  return [...loaded].reduce((sum, file) => sum + gzipSync(text(file), { level: 9 }).length, 0);
}
