// @vitest-environment happy-dom
import { afterEach, expect, test, vi } from "vitest";
import { Button } from "./button.tsx";
import type { Commit } from "./field.tsx";
import { LostTexts, TextField } from "./field.tsx";
import { ContextMenu } from "./menu.tsx";
import { Section } from "./section.tsx";
import { Table } from "./table.tsx";
import {
  byRole,
  click,
  draw,
  leave,
  mount,
  press,
  settled,
  type,
  unmount,
} from "./testing/mounted.tsx";
import { Tree } from "./tree.tsx";

afterEach(unmount);

function field(commit: (text: string) => string | null | Promise<string | null>) {
  const place = mount(<TextField label="Name" value="old" onCommit={commit} />);
  return place.querySelector("input");
}

test("a field commits on Enter, once, and only if the text is another one", async () => {
  const commit = vi.fn(() => null);
  const input = field(commit);
  press(input, "Enter");
  expect(commit).not.toHaveBeenCalled();
  await type(input, "new");
  press(input, "Enter");
  await settled();
  press(input, "Enter");
  await settled();
  expect(commit.mock.calls).toEqual([["new"]]);
});

test("a refused text stays, says why, and Escape brings back what was", async () => {
  const input = field(() => "There is a state of this name already.");
  await type(input, "taken");
  press(input, "Enter");
  await settled();
  expect(input?.value).toBe("taken");
  expect(input?.getAttribute("aria-invalid")).toBe("true");
  expect(document.querySelector("[role=alert]")?.textContent).toContain("already");
  press(input, "Escape");
  expect(input?.value).toBe("old");
  expect(document.querySelector("[role=alert]")).toBeNull();
});

test("what was typed is committed when the field goes away", async () => {
  const commit = vi.fn(() => null);
  await type(field(commit), "new");
  unmount();
  await settled();
  expect(commit.mock.calls).toEqual([["new"]]);
});

test("what someone else makes of a text while it is typed is said, and only Enter overwrites it", async () => {
  const commit = vi.fn(() => null);
  const name = (value: string) => <TextField label="Name" value={value} onCommit={commit} />;
  const input = mount(name("old")).querySelector("input");
  const alertText = () => document.querySelector("[role=alert]")?.textContent;
  await type(input, "mine");
  expect(alertText()).toBeUndefined();
  draw(name("theirs"));
  expect(alertText()).toBe(
    "It was changed to “theirs” in the meantime. Enter keeps your text, Escape takes theirs.",
  );
  leave(input);
  await settled();
  expect([commit.mock.calls.length, input?.value]).toEqual([0, "mine"]);
  press(input, "Enter");
  await settled();
  expect(commit.mock.calls).toEqual([["mine"]]);
  expect(alertText()).toBeUndefined();
});

test("a text that would overwrite someone else's goes with its field, and that is said", async () => {
  const [commit, lost] = [vi.fn(() => null), vi.fn()];
  const name = (value: string) => (
    <LostTexts.Provider value={lost}>
      <TextField label="Name" value={value} onCommit={commit} />
    </LostTexts.Provider>
  );
  await type(mount(name("old")).querySelector("input"), "mine");
  draw(name("theirs"));
  unmount();
  await settled();
  expect(commit).not.toHaveBeenCalled();
  expect(lost.mock.calls).toEqual([
    ["Name “mine” was not applied: it was changed to “theirs” in the meantime"],
  ]);
});

test("what one's own Enter made of a text is no one else's", async () => {
  let answer = (_: null) => {};
  const commit = () => new Promise<null>((resolve) => (answer = resolve));
  const name = (value: string) => <TextField label="Name" value={value} onCommit={commit} />;
  const input = mount(name("old")).querySelector("input");
  await type(input, "new");
  press(input, "Enter");
  await type(input, "newer");
  draw(name("new"));
  expect(document.querySelector("[role=alert]")).toBeNull();
  answer(null);
  await settled();
  expect(document.querySelector("[role=alert]")).toBeNull();
});

test("a section folds and says so", () => {
  const place = mount(
    <Section title="Ports" count={2}>
      inside
    </Section>,
  );
  const head = place.querySelector("button");
  expect(head?.getAttribute("aria-expanded")).toBe("true");
  click(head);
  expect(head?.getAttribute("aria-expanded")).toBe("false");
  expect(place.textContent).not.toContain("inside");
});

test("a menu is walked by arrows, leaves out nothing, and does not do what cannot be done", () => {
  const [done, closed] = [vi.fn(), vi.fn()];
  mount(
    <ContextMenu
      label="State"
      at={{ x: 0, y: 0 }}
      onClose={closed}
      items={[
        { id: "a", title: "Add", run: () => done("a") },
        "separator",
        { id: "b", title: "Break", disabled: true, run: () => done("b") },
        { id: "c", title: "More", items: [{ id: "d", title: "Deep", run: () => done("d") }] },
      ]}
    />,
  );
  const [menu] = byRole(document, "menu");
  const now = () => document.activeElement?.textContent;
  expect(now()).toBe("Add");
  press(document.activeElement, "ArrowDown");
  expect(now()).toBe("Break");
  click(document.activeElement);
  expect(closed).not.toHaveBeenCalled();
  press(document.activeElement, "m");
  press(document.activeElement, "ArrowRight");
  expect(now()).toBe("Deep");
  click(document.activeElement);
  expect(done.mock.calls).toEqual([["d"]]);
  expect(closed).toHaveBeenCalledOnce();
  press(menu ?? null, "Escape");
  expect(closed).toHaveBeenCalledTimes(2);
});

const NUMBERS = Array.from({ length: 5_000 }, (_, index) => `row ${index}`);

test("a long tree makes only what is in sight, and the keyboard selects", () => {
  const select = vi.fn();
  const place = mount(
    <Tree
      label="Rows"
      roots={NUMBERS}
      id={(node) => node}
      childrenOf={() => null}
      text={(node) => node}
      expanded={new Set()}
      onExpand={() => {}}
      onSelect={select}
    />,
  );
  const [tree] = byRole(place, "tree");
  const rows = byRole(place, "treeitem");
  expect(rows.length).toBeGreaterThan(5);
  expect(rows.length).toBeLessThan(60);
  expect(rows[0]?.getAttribute("aria-setsize")).toBe("5000");
  press(tree ?? null, "ArrowDown");
  press(tree ?? null, "ArrowDown");
  expect(select.mock.calls.map(([node]) => node)).toEqual(["row 1", "row 2"]);
});

test("a cell is edited in place, and what is refused stays in it", async () => {
  const commit = vi.fn((_: string, text: string) => (text === "bad" ? "No." : null));
  const place = mount(
    <Table
      label="Ports"
      rows={["one", "two"]}
      id={(row) => row}
      columns={[
        { key: "name", title: "Name", cell: (row) => row, edit: { value: (row) => row, commit } },
      ]}
    />,
  );
  const [grid = null] = byRole(place, "grid");
  press(grid, "ArrowDown");
  press(grid, "Enter");
  const input = () => place.querySelector("input");
  expect(input()?.value).toBe("one");
  await type(input(), "bad");
  press(input(), "Enter");
  await settled();
  expect(document.querySelector("[role=alert]")?.textContent).toBe("No.");
  await type(input(), "good");
  press(input(), "Enter");
  await settled();
  expect(input()).toBeNull();
  expect(commit.mock.calls).toEqual([
    ["one", "bad"],
    ["one", "good"],
  ]);
});

test("a cell says, too, what someone else makes of it meanwhile, and leaving it overwrites nothing", async () => {
  const commit = vi.fn(() => null);
  const table = (name: string) => (
    <Table
      label="Ports"
      rows={[{ name }]}
      id={() => "0"}
      columns={[
        {
          key: "name",
          title: "Name",
          cell: (row) => row.name,
          edit: { value: (row) => row.name, commit },
        },
      ]}
    />
  );
  const place = mount(table("old"));
  const [grid = null] = byRole(place, "grid");
  press(grid, "ArrowDown");
  press(grid, "Enter");
  const input = () => place.querySelector("input");
  await type(input(), "mine");
  draw(table("theirs"));
  expect(document.querySelector("[role=alert]")?.textContent).toContain("changed to “theirs”");
  leave(input());
  await settled();
  expect([commit.mock.calls.length, input()]).toEqual([0, null]);
});

test("a row that was just added is edited at once, in its first cell that can be", () => {
  const table = (rows: readonly string[], newRow?: string) => (
    <Table
      label="Ports"
      rows={rows}
      id={(row) => row}
      newRow={newRow}
      columns={[
        { key: "id", title: "Id", cell: () => "0" },
        {
          key: "name",
          title: "Name",
          cell: (row) => row,
          edit: { value: (row) => row, commit: () => null },
        },
      ]}
    />
  );
  const place = mount(table(["one"]));
  draw(table(["one", "two"], "two"));
  const input = () => place.querySelector("input");
  expect(input()?.value).toBe("two");
  press(input(), "Escape");
  draw(table(["one", "two"], "two"));
  expect(input()).toBeNull();
});

test("Tab continues to the next cell while the key is still down, but not from what is refused or asked", async () => {
  const answers: Record<string, Commit> = {
    later: new Promise<null>(() => {}),
    bad: "No.",
    rename: { asked: new Promise<null>(() => {}) },
  };
  const place = mount(
    <Table
      label="Ports"
      rows={["one"]}
      id={(row) => row}
      columns={["name", "type"].map((key) => ({
        key,
        title: key,
        cell: () => key,
        edit: { value: () => key, commit: (_: string, text: string) => answers[text] },
      }))}
    />,
  );
  const [grid = null] = byRole(place, "grid");
  const input = () => place.querySelector("input");
  const tabbed = async (text: string) => {
    await type(input(), text);
    press(input(), "Tab");
    return input()?.value;
  };
  press(grid, "ArrowDown");
  press(grid, "Enter");
  expect(await tabbed("bad")).toBe("bad");
  await settled();
  expect(await tabbed("rename")).toBe("rename");
  await settled();
  expect(await tabbed("later")).toBe("type");
});

test("a text that was refused when its field had gone is said elsewhere, with what was typed", async () => {
  const lost: string[] = [];
  mount(
    <LostTexts.Provider value={(text) => lost.push(text)}>
      <TextField label="Name" value="old" onCommit={() => "There is one of this name."} />
    </LostTexts.Provider>,
  );
  await type(document.querySelector("input"), "taken");
  unmount();
  await settled();
  expect(lost).toEqual(["Name “taken” was not applied: There is one of this name."]);
});

test("a table names the cell that the keys are on, and counts its head among its rows", () => {
  const rows = ["one", "two"];
  const columns = [
    { key: "a", title: "A", cell: (row: string) => row },
    { key: "b", title: "B", cell: (row: string) => `${row}!` },
  ];
  const place = mount(<Table label="Words" columns={columns} rows={rows} id={(row) => row} />);
  const [grid] = byRole(place, "grid");
  const named = () =>
    document.getElementById(grid?.getAttribute("aria-activedescendant") ?? "")?.textContent;
  press(grid ?? null, "ArrowDown");
  expect(named()).toBe("one");
  press(grid ?? null, "ArrowDown");
  press(grid ?? null, "ArrowRight");
  expect(named()).toBe("two!");
  expect(grid?.getAttribute("aria-rowcount")).toBe("3");
  expect(byRole(place, "row").map((row) => row.getAttribute("aria-rowindex"))).toEqual([
    "1",
    "2",
    "3",
  ]);
});

test("only rows that can be chosen say whether they are", () => {
  const columns = [{ key: "a", title: "A", cell: (row: string) => row }];
  const table = (selected?: ReadonlySet<string>) => (
    <Table
      label="Words"
      columns={columns}
      rows={["one", "two"]}
      id={(row) => row}
      selected={selected}
    />
  );
  const place = mount(table());
  const selected = () => byRole(place, "row").map((row) => row.getAttribute("aria-selected"));
  const [grid] = byRole(place, "grid");
  expect([selected(), grid?.getAttribute("aria-multiselectable")]).toEqual([
    [null, null, null],
    null,
  ]);
  draw(table(new Set(["two"])));
  expect(selected()).toEqual([null, "false", "true"]);
  expect(grid?.getAttribute("aria-multiselectable")).toBe("true");
});

test("a button that can no longer be pressed keeps the keyboard and its reason, and does nothing", () => {
  const press = vi.fn();
  const button = (disabled: boolean) => (
    <Button title="Nothing to undo" disabled={disabled} onClick={press}>
      Undo
    </Button>
  );
  const place = mount(button(false));
  const shown = place.querySelector("button");
  shown?.focus();
  draw(button(true));
  click(shown);
  expect(press).not.toHaveBeenCalled();
  expect(document.activeElement).toBe(shown);
  expect([shown?.disabled, shown?.getAttribute("aria-disabled")]).toEqual([false, "true"]);
  draw(button(false));
  click(shown);
  expect([press.mock.calls.length, shown?.hasAttribute("aria-disabled")]).toEqual([1, false]);
});

test("a press beside a menu closes it, and gives the keyboard back", () => {
  const close = vi.fn();
  const items = [{ id: "a", title: "Add" }];
  const page = (isOpen: boolean) => (
    <div>
      <button type="button">Open</button>
      {isOpen && <ContextMenu label="State" at={{ x: 0, y: 0 }} onClose={close} items={items} />}
    </div>
  );
  mount(page(false)).querySelector("button")?.focus();
  draw(page(true));
  expect(document.activeElement?.textContent).toBe("Add");
  document
    .querySelector(".menu-shield")
    ?.dispatchEvent(new MouseEvent("mousedown", { bubbles: true, cancelable: true }));
  expect(close).toHaveBeenCalledOnce();
  expect(document.activeElement?.textContent).toBe("Open");
});
