/** A machine in front of commands, for tests: from short text, with what is selected, and a record of what was asked and edited. */

import { signal } from "@preact/signals-core";
import { type ElementKey, elementOf } from "../../model/element.ts";
import type { Edit, MachineProblem, MachineStatus, Right } from "../../model/generated/protocol.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import type { MachineSession } from "../../store/document/machine_session.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { FIRST_SETTINGS } from "../../store/page/settings.ts";
import { newView, select } from "../../store/page/view.ts";
import type { CommandContext, Shell } from "../command.ts";

export interface TestContext extends CommandContext {
  readonly tab: OpenTab;
  /** What was done, in order: edits by name, requests, questions, notices. */
  readonly record: string[];
}

export interface TestContextOptions {
  readonly selected?: readonly ElementKey[];
  readonly rights?: readonly Right[];
  readonly changed?: boolean;
  /** What is wrong with the machine. */
  readonly problems?: readonly MachineProblem[];
  /** What the user answers, in order. */
  readonly answers?: readonly unknown[];
  /** What the server answers to a request. */
  readonly serve?: (request: string) => unknown;
}

export function testContext(text: string, options: TestContextOptions = {}): TestContext {
  const record: string[] = [];
  const machine = machineOf(sketch(text));
  const view = newView();
  select(
    view,
    (options.selected ?? []).flatMap((key) => elementOf(key) ?? []),
  );
  const session = {
    id: "m1",
    fixed: null,
    machine,
    version: signal(0),
    status: signal(statusOf(options.changed ?? false)),
    people: signal([]),
    pending: signal([]),
    named: (text: string) => text,
    onChange: () => () => {},
    check: () => Promise.resolve(options.problems ?? []),
    edit: (name: string, edit: Edit) => {
      record.push(`edit ${name} (${edit.edit})`);
      return Promise.resolve({ revision: 2 });
    },
  } as unknown as MachineSession;
  const tab: OpenTab = { session, view, run: signal(null) };
  const page = pageOf(tab, record, options);
  return { page, tab, canvas: null, shell: shellOf(record, options.answers ?? []), record };
}

function statusOf(is_changed: boolean): MachineStatus {
  const file = { project: "p", path: "drill" };
  const revisions = { revision: 2, saved_revision: is_changed ? 1 : 2, is_changed };
  return {
    summary: {
      id: "m1",
      file,
      name: "Drill",
      ...revisions,
      disk: "same",
      is_recovered: false,
      set_aside: 0,
    },
    people: [],
  };
}

function pageOf(tab: OpenTab, record: string[], options: TestContextOptions): Page {
  const rights = options.rights ?? ["observe", "edit"];
  const tabs = signal<readonly OpenTab[]>([tab]);
  const request = (method: string, path: string, body?: unknown) => {
    const text = `${method} ${path}${body === undefined ? "" : ` ${JSON.stringify(body)}`}`;
    record.push(text);
    return Promise.resolve().then(() => options.serve?.(text));
  };
  return {
    server: { link: signal({ state: "up", session: { rights } }), request },
    tabs,
    active: signal(tab),
    settings: signal(FIRST_SETTINGS),
    robots: signal([]),
    tell: ({ text }: { text: string }) => record.push(`tell ${text}`),
    leave: (left: OpenTab) => {
      record.push("leave");
      tabs.value = tabs.peek().filter((other) => other !== left);
    },
  } as unknown as Page;
}

function shellOf(record: string[], answers: readonly unknown[]): Shell {
  const left = [...answers];
  const ask = (question: { title: string }) => {
    record.push(`ask ${question.title}`);
    return Promise.resolve(left.shift() ?? null);
  };
  return {
    confirm: ask,
    choose: ask,
    prompt: ask,
    dialog: (name: string) => ask({ title: name }),
    showPanel: (panel: string) => void record.push(`show ${panel}`),
    openPalette: () => {},
    layouts: { panels: () => [], names: () => [], own: () => [], isShown: () => true },
  } as unknown as Shell;
}
