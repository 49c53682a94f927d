// @vitest-environment happy-dom
import { act } from "react";
import { createRoot } from "react-dom/client";
import { expect, it } from "vitest";
import { onDemand } from "./on_demand.tsx";

/** The text of what is shown, and what its button does. */
async function shown(element: React.ReactElement) {
  const place = document.createElement("div");
  await act(async () => createRoot(place).render(element));
  return {
    text: () => place.textContent,
    press: () => act(async () => place.querySelector("button")?.click()),
  };
}

const Name = ({ name }: { readonly name: string }) => <p>{name}</p>;

it("loads once what several places show, and gives each its props", async () => {
  let loads = 0;
  const Part = onDemand(async () => {
    loads += 1;
    return Name;
  });
  const one = await shown(<Part name="one" />);
  const other = await shown(<Part name="other" />);
  expect([one.text(), other.text(), loads]).toEqual(["one", "other", 1]);
});

it("shows at once what was loaded before", async () => {
  const Part = onDemand(async () => Name);
  await Part.preload();
  const place = document.createElement("div");
  act(() => createRoot(place).render(<Part name="there" />));
  expect(place.textContent).toBe("there");
});

it("says what did not load, in its frame, and loads it when asked again", async () => {
  let isCut = true;
  const Part = onDemand(
    async () => {
      if (isCut) throw new TypeError("Failed to fetch");
      return Name;
    },
    (words, { name }) => (
      <section>
        {name}: {words}
      </section>
    ),
  );
  await Part.preload();
  const part = await shown(<Part name="Compare" />);
  expect(part.text()).toMatch(/^Compare: This part of the page did not load/);
  isCut = false;
  await part.press();
  expect(part.text()).toBe("Compare");
});
