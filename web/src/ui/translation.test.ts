// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { undoTranslations } from "./translation.ts";

/** The page with this body, after a translator and then the page have changed it. */
async function after(
  body: string,
  translate: (text: Text, font: Element) => void,
  change: (text: Text) => void = () => {},
): Promise<string> {
  document.body.innerHTML = body;
  let count = 0;
  const stop = undoTranslations(document, () => {
    count += 1;
  });
  const text = document.querySelector("[data-text]")?.firstChild as Text;
  const font = document.createElement("font");
  font.textContent = "auf Deutsch";
  translate(text, font);
  await new Promise((done) => setTimeout(done));
  change(text);
  stop();
  return `${count} ${document.body.textContent}`;
}

const BODY = '<p data-text="1">Running<b>!</b></p>';
const paused = (text: Text) => {
  text.data = "Paused";
};

test("a text that a translator replaces is there again, however it was replaced", async () => {
  const ways: readonly ((text: Text, font: Element) => void)[] = [
    (text, font) => text.replaceWith(font),
    (text, font) => {
      text.before(font);
      text.remove();
    },
    (text, font) => {
      const { parentNode } = text;
      text.remove();
      parentNode?.prepend(font);
    },
  ];
  for (const way of ways) expect(await after(BODY, way, paused)).toBe("1 Paused!");
});

test("texts of users and changes of the page itself stay", async () => {
  const own = `<div class="inspector-markdown">${BODY}</div>`;
  expect(await after(own, (text, font) => text.replaceWith(font))).toBe("0 auf Deutsch!");
  expect(await after(BODY, (text) => text.remove())).toBe("0 !");
  expect(await after(BODY, (text, font) => text.after(font))).toBe("0 Runningauf Deutsch!");
});
