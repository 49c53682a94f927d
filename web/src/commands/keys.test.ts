import { expect, test } from "vitest";
import type { UserCommand } from "./command.ts";
import { conflicts, isCanvasKey, keymap, keyName, readKey, readKeys, shownKey } from "./keys.ts";

const none = { ctrlKey: false, metaKey: false, altKey: false, shiftKey: false };

test("a pressed key has one name, whatever the modifiers make of it", () => {
  expect(keyName({ ...none, key: "s", code: "KeyS" })).toBe("S");
  expect(keyName({ ...none, key: "Z", code: "KeyZ", ctrlKey: true, shiftKey: true })).toBe(
    "Ctrl+Shift+Z",
  );
  expect(keyName({ ...none, key: "?", code: "Minus", shiftKey: true })).toBe("?");
  expect(keyName({ ...none, key: "+", code: "BracketRight", ctrlKey: true })).toBe("Ctrl+Plus");
  expect(keyName({ ...none, key: "!", code: "Digit1", ctrlKey: true, altKey: true })).toBe(
    "Ctrl+Alt+1",
  );
  expect(keyName({ ...none, key: " ", code: "Space", ctrlKey: true })).toBe("Ctrl+Space");
  expect(keyName({ ...none, key: "Shift", code: "ShiftLeft", shiftKey: true })).toBeNull();
});

test("letters and digits of every script have the name of their key", () => {
  const check = (key: string, code: string, name: string) =>
    expect(keyName({ ...none, key, code })).toBe(name);
  check("у", "KeyE", "E");
  check("γ", "KeyG", "G");
  check("ש", "KeyA", "A");
  check("ㄹ", "KeyF", "F");
  check("١", "Digit1", "1");
  expect(keyName({ ...none, key: "П", code: "KeyG", shiftKey: true })).toBe("Shift+G");
});

test("a Latin layout keeps its own places, and signs stay signs", () => {
  expect(keyName({ ...none, key: "a", code: "KeyQ" })).toBe("A");
  expect(keyName({ ...none, key: "'", code: "KeyQ" })).toBe("'");
  expect(keyName({ ...none, key: "!", code: "Digit1", shiftKey: true })).toBe("!");
});

test("AltGr types a sign, and is not taken for Ctrl+Alt", () => {
  const altGr = { getModifierState: (name: string) => name === "AltGraph" };
  const held = { ...none, ctrlKey: true, altKey: true, ...altGr };
  expect(keyName({ ...held, key: "}", code: "Digit0" })).toBe("}");
  expect(keyName({ ...held, key: "@", code: "KeyQ" })).toBe("@");
  expect(keyName({ ...held, key: "ą", code: "KeyA" })).toBe("Ą");
});

test("keys that people write are read, in any order and case", () => {
  expect(readKey("shift+ctrl+z")).toBe("Ctrl+Shift+Z");
  expect(readKey("delete")).toBe("Delete");
  expect(readKey("hyper+x")).toBeNull();
  expect(readKey("Ctrl+")).toBeNull();
  expect(shownKey("Ctrl+Plus")).toBe("Ctrl++");
});

test("letters count on the canvas only, and F keys everywhere", () => {
  expect(["S", "Shift+G", "Delete", "?"].every(isCanvasKey)).toBe(true);
  expect(["Ctrl+S", "Ctrl+Alt+1", "F2", "Shift+F5"].some(isCanvasKey)).toBe(false);
});

const command = (id: string, keys: string[], classic?: string[]): UserCommand => ({
  id: id as "edit.undo",
  title: id,
  keys,
  ...(classic ? { classic } : {}),
  run: () => {},
});

const TWO = [command("a", ["Ctrl+D"]), command("b", ["D"], ["Ctrl+D"])];

test("the classic map takes its keys from whoever has them else", () => {
  const map = keymap(TWO, { keymap: "classic", keys: {} });
  expect([...map]).toEqual([
    ["a", []],
    ["b", ["Ctrl+D"]],
  ]);
});

test("what the user chose comes first, and what two have is found", () => {
  const map = keymap(TWO, { keymap: "rafcon", keys: { b: ["Ctrl+D"] } });
  expect(map.get("b")).toEqual(["Ctrl+D"]);
  expect([...conflicts(map)]).toEqual([["Ctrl+D", ["a", "b"]]]);
});

test("a file of keys says what is wrong with it and gives the rest", () => {
  const text = `{"a": ["ctrl+q", "x+y"], "c": ["Z"], "b": "Z"}`;
  expect(readKeys(text, (id) => id !== "c")).toEqual({
    keys: { a: ["Ctrl+Q"] },
    faults: ["a: x+y is not a key", "there is no command c", "b: keys must be a list of texts"],
  });
});
