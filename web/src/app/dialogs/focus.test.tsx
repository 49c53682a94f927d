// @vitest-environment happy-dom
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { FunctionComponent } from "react";
import { afterEach, expect, test } from "vitest";
import type { OpenTab } from "../../store/page/page.ts";
import { newBreakpoint } from "../../store/run/breakpoints.ts";
import { runLine, watched } from "../../store/testing/watched.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import type { UserQuestion } from "../question.ts";
import type { OpenDialog } from "../session.ts";
import { shown } from "../testing/shown.tsx";
import { type AskedDialogProps, DIALOGS, LATER_DIALOGS } from "./dialogs.tsx";

afterEach(unmount);

/** What opens each dialog, by name: a new dialog needs an entry here. */
const ASKS: Readonly<Record<OpenDialog["name"], (tab: OpenTab) => unknown>> = {
  question: () => ({ kind: "confirm", title: "Stop?", text: "It ends.", yes: "Stop" }),
  open: () => undefined,
  "save-as": () => ({ title: "Save as", name: "drill", yes: "Save" }),
  new: () => undefined,
  library: () => ({ title: "Library", yes: "Use" }),
  colour: () => null,
  "start-run": (tab) => tab,
  "resume-crashed": () => watched(runLine("crashed")).watch,
  "start-at-robot": () => undefined,
  "set-aside": (tab) => tab,
  breakpoint: () => newBreakpoint(1, "R"),
  keys: () => undefined,
  settings: () => undefined,
  about: () => undefined,
};

interface Opened {
  /** What has the focus: a field, or the answer that pressing it gives. */
  readonly focus: string;
}

/** Opens a dialog and presses what has the focus. */
async function opened(name: OpenDialog["name"], asks?: unknown): Promise<Opened> {
  for (const part of LATER_DIALOGS) await part.preload();
  const answers: unknown[] = [];
  const Component = DIALOGS[name] as FunctionComponent<AskedDialogProps<unknown>>;
  shown((tab) => (
    <Component asks={asks ?? ASKS[name](tab)} answer={(answer) => answers.push(answer)} />
  ));
  await settled();
  const { activeElement } = document;
  if (!activeElement?.closest("dialog")) return { focus: "nothing" };
  if (activeElement.matches("input, select, textarea")) return { focus: "field" };
  (activeElement as HTMLElement).click();
  return { focus: answers.length === 0 ? "stays" : JSON.stringify(answers[0]) };
}

test("in every dialog the focus is in a field, or on what changes nothing", async () => {
  const safe = ["field", "null", "false", "stays"];
  for (const name of Object.keys(ASKS) as OpenDialog["name"][]) {
    const { focus } = await opened(name);
    expect([name, safe.includes(focus) ? "safe" : focus]).toEqual([name, "safe"]);
  }
});

test("a question has the focus on the answer that changes nothing, and a choice on the one it calls safe", async () => {
  const confirm: UserQuestion = {
    kind: "confirm",
    title: "Start another run?",
    text: "",
    yes: "Start another",
  };
  expect((await opened("question", confirm)).focus).toBe("false");
  const choices = [
    { value: "start", title: "Start anyway" },
    { value: "show", title: "Show the problems" },
  ];
  const choose: UserQuestion = { kind: "choose", title: "Start?", text: "", safe: "show", choices };
  expect((await opened("question", choose)).focus).toBe('"show"');
  expect((await opened("question", { ...choose, safe: null })).focus).toBe("null");
  expect((await opened("question", { kind: "prompt", title: "Name", label: "Name" })).focus).toBe(
    "field",
  );
});

test("a dialog without a field has the focus on its first button, not on the one that does it", async () => {
  shown(() => (
    <Dialog
      title="Rename"
      onClose={() => {}}
      footer={
        <>
          <Button onClick={() => {}}>Cancel</Button>
          <Button onClick={() => {}}>Rename</Button>
        </>
      }
    >
      <p>Two places.</p>
    </Dialog>
  ));
  await settled();
  expect(document.activeElement?.textContent).toBe("Cancel");
});

/** Dialogs of panels. */
const OF_PANELS = [
  "globals/rename_global.tsx",
  "inspector/renaming.tsx",
  "inspector/script_conflict.tsx",
];

test("dialogs of panels begin their foot with Cancel", () => {
  const panels = join(import.meta.dirname, "../../panels");
  const files = readdirSync(panels, { recursive: true, encoding: "utf8" });
  const text = (file: string) => readFileSync(join(panels, file), "utf8");
  const found = files.filter((file) => file.endsWith(".tsx") && text(file).includes("<Dialog"));
  expect(found.sort()).toEqual(OF_PANELS);
  for (const file of found) {
    const [, first] = /footer=\{\s*<>\s*<Button.*>(\w+)<\/Button>/.exec(text(file)) ?? [];
    expect([file, first]).toEqual([file, "Cancel"]);
  }
});
