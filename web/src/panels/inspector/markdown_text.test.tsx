// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import { click, mount, unmount } from "../../ui/testing/mounted.tsx";
import { Markdown } from "./markdown_text.tsx";

afterEach(unmount);

test("a long description is shortened, says so, and shows all of its text on demand", async () => {
  const text = `${"A line of many.\n".repeat(20_000)}The end.`;
  const place = mount(<Markdown text={text} />);
  const note = () => place.querySelector("[role=note]")?.textContent ?? "";
  expect(note()).toMatch(/Shortened: the first 31\d\d\d of 320008 characters are formatted\./);
  expect(place.querySelector(".inspector-plain")).toBeNull();
  const button = place.querySelector("[role=note] button");
  if (button) await click(button);
  expect(place.querySelector(".inspector-plain")?.textContent).toBe(text);
});

test("a short description is not", () => {
  const place = mount(<Markdown text="Short" />);
  expect(place.querySelector("[role=note]")).toBeNull();
});
