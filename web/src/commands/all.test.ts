import { expect, test } from "vitest";
import { allCommands } from "./all.ts";
import { MENUS } from "./command.ts";
import { conflicts, isKeptByBrowser, keymap, readKey } from "./keys.ts";

const ALL = allCommands().all();

test("no key does two things in the maps that ship", () => {
  for (const name of ["rafcon", "classic"]) {
    const map = keymap(ALL, { keymap: name, keys: {} });
    expect([...conflicts(map)]).toEqual([]);
  }
});

test("every key can be pressed, and the own map asks for none that browsers keep", () => {
  for (const { id, keys = [], classic = [] } of ALL) {
    for (const key of [...keys, ...classic]) expect([id, readKey(key)]).toEqual([id, key]);
    expect([id, keys.filter(isKeptByBrowser)]).toEqual([id, []]);
  }
});

test("what browsers keep in the classic map has another key beside it", () => {
  for (const { id, classic = [] } of ALL) {
    const free = classic.filter((key) => !isKeptByBrowser(key));
    if (classic.length > 0) expect([id, free.length > 0]).toEqual([id, true]);
  }
});

test("every command stands in a menu that there is, or is for the palette alone", () => {
  for (const { id, menu } of ALL) {
    const [title = "File", block = "1"] = menu?.split("/") ?? [];
    expect([id, MENUS.some((known) => known === title), /^\d$/.test(block)]).toEqual([
      id,
      true,
      true,
    ]);
  }
});
