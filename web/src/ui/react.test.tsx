// @vitest-environment happy-dom
import { act, useDeferredValue, useEffect, useState } from "react";
import { createPortal } from "react-dom";
import { createRoot } from "react-dom/client";
import { afterEach, expect, test, vi } from "vitest";
import { Checkbox, Select, TextField } from "./field.tsx";
import { click, draw, mount, settled, unmount } from "./testing/mounted.tsx";

afterEach(unmount);

test("what is given the keyboard has it as often as it comes, and once", () => {
  const form = (isThere: boolean, hint = "") => (
    <>
      <button type="button">Other</button>
      {isThere && <TextField label="Name" value="" hint={hint} autoFocus />}
    </>
  );
  const place = mount(form(true));
  const [input, button] = [place.querySelector("input"), place.querySelector("button")];
  expect(document.activeElement).toBe(input);
  button?.focus();
  draw(form(true, "a new hint"));
  expect(document.activeElement).toBe(button);
  draw(form(false));
  draw(form(true));
  expect(document.activeElement).toBe(place.querySelector("input"));
});

test("a choice that is refused shows again what holds", async () => {
  const refuse = vi.fn();
  const place = mount(
    <>
      <Checkbox label="On" checked={false} onChange={refuse} />
      <Select
        label="Kind"
        value="a"
        options={[
          { value: "a", title: "A" },
          { value: "b", title: "B" },
        ]}
        onChange={refuse}
      />
    </>,
  );
  const [box, select] = [place.querySelector("input"), place.querySelector("select")];
  click(box);
  if (select) select.value = "b";
  select?.dispatchEvent(new Event("change", { bubbles: true }));
  await settled();
  expect(refuse.mock.calls).toEqual([[true], ["b"]]);
  expect([box?.checked, select?.value]).toEqual([false, "a"]);
});

function BoxInRow({ onChange }: { onChange: (isOn: boolean) => void }) {
  const [presses, setPresses] = useState(0);
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions lint/a11y/useKeyWithClickEvents: as a row of a table
    <div onClick={() => setPresses(presses + 1)}>
      <Checkbox label={presses} checked onChange={onChange} />
    </div>
  );
}

test("a box in a row that is drawn again by the same press tells what was pressed", async () => {
  const change = vi.fn();
  const place = document.createElement("div");
  document.body.append(place);
  createRoot(place).render(<BoxInRow onChange={change} />);
  place.querySelector("input")?.click();
  await Promise.resolve();
  expect(change.mock.calls).toEqual([[false]]);
});

function Counter() {
  const [count, setCount] = useState(0);
  return (
    <button type="button" onClick={() => setCount(count + 1)}>
      {count}
    </button>
  );
}

test("a portal that goes takes nothing from the others", () => {
  const places = ["a", "b"].map((id) => Object.assign(document.createElement("div"), { id }));
  const all = (shown: readonly HTMLElement[]) => (
    <div>{shown.map((place) => createPortal(<Counter />, place, place.id))}</div>
  );
  mount(all(places));
  const [, last] = places;
  click(last?.querySelector("button") ?? null);
  draw(all(places.slice(1)));
  expect(last?.textContent).toBe("1");
});

function Later({ value }: { value: string }) {
  return <p>{useDeferredValue(value)}</p>;
}

test("a value that may come later comes", async () => {
  const place = mount(<Later value="first" />);
  draw(<Later value="second" />);
  expect(place.textContent).toBe("first");
  await vi.waitFor(() => expect(place.textContent).toBe("second"));
});

test("a value that changes without a pause is shown, late", () => {
  vi.useFakeTimers();
  try {
    const place = mount(<Later value="0" />);
    for (let change = 1; change <= 5; change++) {
      draw(<Later value={String(change)} />);
      act(() => void vi.advanceTimersByTime(16));
    }
    expect(Number(place.textContent)).toBeGreaterThan(0);
    act(() => void vi.runAllTimers());
    expect(place.textContent).toBe("5");
  } finally {
    vi.useRealTimers();
  }
});

function Heard({ heard }: { heard: string[] }) {
  const [text, setText] = useState("");
  useEffect(() => void heard.push(text), [heard, text]);
  return <input value={text} onChange={(event) => setText(event.currentTarget.value)} />;
}

test("effects of a key come before the next task", async () => {
  const heard: string[] = [];
  const place = document.createElement("div");
  createRoot(place).render(<Heard heard={heard} />);
  const input = place.querySelector("input");
  if (input) input.value = "a";
  input?.dispatchEvent(new Event("input", { bubbles: true }));
  for (let step = 0; step < 10; step++) await Promise.resolve();
  expect(heard).toEqual(["", "a"]);
});
