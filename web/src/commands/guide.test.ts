/** The handbook's tables of keys are those of the commands. */

import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { allCommands } from "./all.ts";
import type { UserCommand } from "./command.ts";
import { MENUS } from "./command.ts";
import { keymap, shownKey } from "./keys.ts";

const GUIDE = new URL("../../../docs/guide/editor.md", import.meta.url);
const ALL = allCommands().all();
const OWN = keymap(ALL, { keymap: "rafcon", keys: {} });
const CLASSIC = keymap(ALL, { keymap: "classic", keys: {} });

function shown(keys: readonly string[] = []): string {
  return keys.map((key) => `\`${shownKey(key)}\``).join(" ");
}

/** A row of the table: what it does, its keys, those of the classic map where they differ. */
function row({ id, title }: UserCommand): readonly string[] {
  const [own, classic] = [shown(OWN.get(id)), shown(CLASSIC.get(id))];
  if (own === "" && classic === "") return [];
  const other = classic === "" ? "none" : classic;
  return [`| ${title} | ${own} | ${own === classic ? "" : other} |`];
}

const PALETTE_ONLY = "In the palette only";

function menuOf({ menu }: UserCommand): string {
  return menu?.split("/")[0] ?? PALETTE_ONLY;
}

/** The rows of the table below a heading of the handbook. */
function tableBelow(heading: string): readonly string[] {
  const text = readFileSync(GUIDE, "utf8");
  const section = text.split(`\n### ${heading}\n`)[1]?.split("\n#")[0] ?? "";
  const [, , ...rows] = section.split("\n").filter((line) => line.startsWith("|"));
  return rows;
}

test.each([...MENUS, PALETTE_ONLY])(
  "%s: the keys in the handbook are those of the page",
  (menu) => {
    const commands = ALL.filter((command) => menuOf(command) === menu);
    expect(tableBelow(menu)).toEqual(commands.flatMap(row));
  },
);
