import { expect, test } from "vitest";
import { perOwner } from "./per_owner.ts";

test("each owner has one value, made when it is first wanted", () => {
  const made: string[] = [];
  const nameOf = perOwner((owner: { readonly id: string }, suffix: string) => {
    made.push(owner.id);
    return owner.id === "none" ? undefined : owner.id + suffix;
  });
  const [a, b, none] = [{ id: "a" }, { id: "b" }, { id: "none" }];
  expect([
    nameOf(a, "!"),
    nameOf(b, "?"),
    nameOf(a, "?"),
    nameOf(none, ""),
    nameOf(none, ""),
  ]).toEqual(["a!", "b?", "a!", undefined, undefined]);
  expect(made).toEqual(["a", "b", "none"]);
});
