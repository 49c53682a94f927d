import { expect, test } from "vitest";
import { crumbsIn } from "./crumbs.ts";

const NAMES = ["Coffee", "Make coffee", "Grind", "Weigh the beans", "Tare"];

/** What is named in so much room, `…` where states are left out. */
function shown(room_px: number, names: readonly string[] = NAMES): string {
  const { from, to } = crumbsIn(names, room_px);
  return names
    .flatMap((name, index) => (index < from || index >= to ? [name] : index === from ? ["…"] : []))
    .join(" > ");
}

test("states between the root and the innermost give way, the outer ones first", () => {
  expect(shown(800)).toBe("Coffee > Make coffee > Grind > Weigh the beans > Tare");
  expect(shown(400)).toBe("Coffee > … > Grind > Weigh the beans > Tare");
  expect(shown(300)).toBe("Coffee > … > Weigh the beans > Tare");
  expect(shown(150)).toBe("Coffee > … > Tare");
});

test("the root and the innermost are named in any room", () => {
  expect(shown(10)).toBe("Coffee > … > Tare");
  expect(shown(10, ["Coffee", "Tare"])).toBe("Coffee > Tare");
  expect(shown(10, ["Coffee"])).toBe("Coffee");
});
