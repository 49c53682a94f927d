import { expect, test } from "vitest";
import { pageBase, storePrefix } from "./base.ts";

function at(href: string, content: string | null): string {
  const meta = content === null ? null : { content };
  return pageBase({ querySelector: () => meta, location: { href } } as unknown as Document);
}

test("the server is where the page is, below whatever path", () => {
  expect(at("http://127.0.0.1:4747/?layout=mission#x", "./")).toBe("http://127.0.0.1:4747");
  expect(at("https://robot.lan/robot/?run=1", "./")).toBe("https://robot.lan/robot");
  expect(at("https://robot.lan/robot", "/robot/")).toBe("https://robot.lan/robot");
  expect(at("http://127.0.0.1:5173/", null)).toBe("http://127.0.0.1:5173");
  expect(pageBase(undefined)).toBe("");
});

test("robots of one origin do not share what a browser keeps", () => {
  expect(storePrefix("https://robot.lan")).toBe("");
  expect(storePrefix("")).toBe("");
  expect(storePrefix("https://fleet.lan/one")).toBe("/one:");
});
