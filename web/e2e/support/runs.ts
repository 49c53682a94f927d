/** Runs as a person drives them in the page: by the buttons, seen by the words. And machines for it: examples with other scripts. */

import { cpSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type {
  CommandArguments,
  CommandCall,
  CommandId,
} from "../../src/store/page/command_arguments.ts";
import type { App } from "./app.ts";
import { EXAMPLES } from "./places.ts";

/** A copy of an example in which some files have other texts. */
export function exampleWith(name: string, files: Readonly<Record<string, string>>): string {
  const place = mkdtempSync(join(tmpdir(), "rafcon-e2e-machine-"));
  process.once("exit", () => rmSync(place, { recursive: true, force: true }));
  const folder = join(place, name);
  cpSync(join(EXAMPLES, name), folder, { recursive: true });
  for (const [file, text] of Object.entries(files)) writeFileSync(join(folder, file), text);
  return folder;
}

/** Presses a button of the run controls. */
export async function press(app: App, name: string): Promise<void> {
  const controls = app.sheet.getByRole("toolbar", { name: "Run", exact: true });
  await controls.getByRole("button", { name, exact: true }).click();
}

/** Answers a question of the page by a button. */
export async function answer(app: App, title: string, button: string): Promise<void> {
  const dialog = app.sheet.getByRole("dialog", { name: title });
  await dialog.getByRole("button", { name: button, exact: true }).click();
  await dialog.waitFor({ state: "detached" });
}

/** Waits until the word of the run in front is this, as the page shows it. */
export async function stands(app: App, word: string): Promise<void> {
  const shown = app.sheet.locator(".run-chooser .run-word");
  await shown.filter({ hasText: new RegExp(`^${word}$`) }).waitFor();
}

/** Waits until the run is over by an outcome. */
export async function ended(app: App, outcome: string): Promise<void> {
  await app.until(({ tab }, name) => {
    const run = tab?.run.value?.now.value?.run;
    return run?.phase === "finished" && run.outcome.name === name;
  }, outcome);
}

/** Waits until something is held before the state. */
export async function heldBefore(app: App, path: string): Promise<void> {
  await app.until(
    ({ tab }, next) =>
      tab?.run.value?.now.value?.snapshot?.active.some(({ held }) =>
        held.some((hold) => hold.next === next),
      ) ?? false,
    path,
  );
}

/** Waits until the run is held in the state itself, at its end too. */
export async function heldInside(app: App, path: string): Promise<void> {
  await app.until(
    ({ tab }, wanted) =>
      tab?.run.value?.now.value?.snapshot?.active.some(
        (state) => state.path === wanted && state.held.length > 0,
      ) ?? false,
    path,
  );
}

/** Waits until the state is active. */
export async function untilActive(app: App, path: string): Promise<void> {
  await app.until(
    ({ tab }, wanted) =>
      tab?.run.value?.now.value?.snapshot?.active.some((state) => state.path === wanted) ?? false,
    path,
  );
}

/** The id of the run in front. */
export async function runInFront(app: App): Promise<string> {
  const id = await app.sheet.evaluate(() => window.__rafcon.page.active.value?.run.value?.id);
  if (!id) throw new Error("no run is shown");
  return id;
}

/** Stops the run in front and waits for its end. */
export async function stopRun(app: App): Promise<void> {
  await press(app, "Stop");
  await answer(app, "Stop the run?", "Stop the run");
  await app.until(({ tab }) => tab?.run.value?.now.value?.run.phase === "finished", null);
}

/** Waits until the page has been told of the end of the run in front, and so of all that happened in it. */
export async function untilEndReceived(app: App): Promise<void> {
  await app.until(({ tab }) => {
    const journal = tab?.run.value?.journal;
    const last = journal?.at(journal.length - 1);
    return last?.kind === "other" && last.event.type === "finished";
  }, null);
}

/** Waits until the state has ended in the run in front. */
export async function left(app: App, path: string): Promise<void> {
  await app.until(({ tab }, wanted) => {
    const watch = tab?.run.value;
    const count = watch?.journalVersion.value ?? 0;
    for (let index = 0; index < count; index += 1) {
      const event = watch?.journal.at(index);
      if (event?.kind === "left" && event.path === wanted) return true;
    }
    return false;
  }, path);
}

/** Does a command with an argument, as buttons elsewhere in the page do; it has to be possible. */
export async function perform<Id extends CommandId>(
  app: App,
  command: Id,
  argument: CommandArguments[Id],
): Promise<void> {
  await app.until((context, call) => window.__rafcon.commands.call(call as CommandCall, context), {
    command,
    argument,
  });
}
