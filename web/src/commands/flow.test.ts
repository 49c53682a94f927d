import { expect, test } from "vitest";
import type { Edit } from "../model/generated/protocol.ts";
import { RefusalError } from "../store/page/server.ts";
import { allCommands } from "./all.ts";
import { folderName } from "./save.ts";
import { type TestContextOptions, testContext } from "./testing/context.ts";

const MACHINE = `
  R "Drill" hierarchy 0 0 400 300 outcome done
    A "Scan" execution 20 20 80 60 outcome ok
    B "Move" execution 120 20 80 60 outcome ok
`;

/** What a command does, as it is recorded. */
async function done(
  id: string,
  { machine = MACHINE, ...options }: TestContextOptions & { readonly machine?: string } = {},
  argument?: unknown,
): Promise<string[]> {
  const context = testContext(machine, options);
  const command = allCommands().find(id);
  if (!command || command.enabled?.(context) === false) return ["cannot"];
  try {
    await command.run(context, argument as undefined);
  } catch (error) {
    context.record.push(`failed ${String(error)}`);
  }
  return context.record;
}

test("an edit that is planned is made under its name", async () => {
  expect(await done("edit.delete", { selected: ["state:R/A"] })).toEqual([
    "edit Delete state (remove_state)",
  ]);
  expect(await done("arrange.align-left", { selected: ["state:R/A", "state:R/B"] })).toHaveLength(
    1,
  );
  expect(await done("arrange.align-left", { selected: ["state:R/A"] })).toEqual(["cannot"]);
});

test("what is refused is told with its reason, and nothing is sent", async () => {
  const [only = "", ...more] = await done("insert.transition-to-parent", {
    selected: ["state:R/A"],
  });
  expect(more).toEqual([]);
  expect(only).toMatch(/^(edit|tell) /);
  expect(await done("edit.delete", { selected: ["state:R"] })).toEqual([
    expect.stringMatching(/^tell .*root/),
  ]);
});

test("saving over what another program changed asks, and loses nothing without a word", async () => {
  let first = true;
  const serve = (request: string) => {
    if (!first || !request.includes("/save")) return undefined;
    first = false;
    throw new RefusalError({ code: "changed_on_disk", message: "changed" }, 409);
  };
  expect(await done("file.save", { serve, answers: ["mine"] })).toEqual([
    `POST /machines/m1/save {"overwrite":false}`,
    "ask Another program changed the files",
    `POST /machines/m1/save {"overwrite":true}`,
  ]);
});

test("closing what is not saved asks, and takes no for an answer", async () => {
  const title = "ask Save “Drill” before closing?";
  expect(await done("file.close", { changed: true, answers: [null] })).toEqual([title]);
  expect(await done("file.close", { changed: true, answers: ["keep"] })).toEqual([title, "leave"]);
  expect(await done("file.close", { changed: true, answers: ["save"] })).toEqual([
    title,
    `POST /machines/m1/save {"overwrite":false}`,
    `POST /machines/m1/close {"discard":false}`,
    "leave",
  ]);
  expect(await done("file.close")).toEqual([`POST /machines/m1/close {"discard":false}`, "leave"]);
});

test("who may only look closes their tab and nothing else", async () => {
  expect(await done("file.close", { rights: ["observe"], changed: true })).toEqual(["leave"]);
  expect(await done("file.save", { rights: ["observe"] })).toEqual(["cannot"]);
});

test("a folder's name is what every file system takes", () => {
  expect(["Drill & Fill!", "  Ölwechsel 2 ", "../..", "§"].map(folderName)).toEqual([
    "drill_fill",
    "ölwechsel_2",
    "machine",
    "machine",
  ]);
});

test("a state is inserted into the selected transition, of a kind or by a library", async () => {
  const library = { path: "arm", name: "grasp" };
  const states = [
    { path: "G", name: "Grasp", kind: "hierarchy", outcomes: [{ id: 0, name: "ok" }] },
  ];
  const options = {
    machine: `${MACHINE}    A.ok > B\n`,
    selected: ["transition:R:0"],
    answers: [library],
    serve: () => ({ header: {}, states }),
  };
  expect(await done("insert.into-transition", options, "execution")).toEqual([
    "edit Insert state into transition (batch)",
  ]);
  expect(await done("insert.into-transition", options, "library")).toEqual([
    "ask library",
    "GET /libraries/arm/grasp",
    "edit Insert state into transition (batch)",
  ]);
  expect(await done("insert.into-transition", { selected: ["state:R/A"] }, "execution")).toEqual([
    "cannot",
  ]);
});

test("a library state keeps the version that it is made with, however it comes into the machine", async () => {
  const states = [
    { path: "G", name: "Grasp", kind: "hierarchy", outcomes: [{ id: 0, name: "ok" }] },
  ];
  const serve = () => ({ header: { version: "1.0" }, states });
  const library = { path: "arm", name: "grasp" };
  const made = async (id: string, selected: string, argument: unknown) => {
    const context = testContext(`${MACHINE}    A.ok > B\n`, {
      serve,
      selected: [selected],
      answers: [library],
    });
    const edits: string[] = [];
    const edit = (_: string, each: Edit) => {
      edits.push(JSON.stringify(each));
      return Promise.resolve({ revision: 2 });
    };
    Object.assign(context.tab.session, { edit });
    await allCommands()
      .find(id)
      ?.run(context, argument as undefined);
    return edits.map((each) => /"version":"([^"]*)"/.exec(each)?.[1]);
  };
  expect(await made("insert.library", "state:R", undefined)).toEqual(["1.0"]);
  expect(
    await made("insert.library", "state:R", { ...library, container: "R", at: { x: 9, y: 9 } }),
  ).toEqual(["1.0"]);
  expect(await made("insert.into-transition", "transition:R:0", "library")).toEqual(["1.0"]);
  expect(await made("arrange.substitute", "state:R/A", undefined)).toEqual(["1.0"]);
});
