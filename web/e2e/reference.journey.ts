import { join } from "node:path";
import { expect, test } from "vitest";
import type { MachineDocument, MachineSummary } from "../src/model/generated/protocol.ts";
import { newPlace } from "./support/places.ts";
import { asName, loadInReference, share, shipped, shippedLibraries } from "./support/reference.ts";
import { Server } from "./support/server.ts";

/** Opens a machine of the project, moves its first state (its root, where there is no other), and saves it. */
async function editAndSave(server: Server, project: string, path: string) {
  const file = { project, path };
  const { id } = await server.ask<MachineSummary>("POST", "/machines/open", { file });
  const { revision, document } = await server.ask<MachineDocument>(
    "GET",
    `/machines/${id}/document`,
  );
  const [root, child] = document.states;
  const at = child?.path ?? root?.path ?? "";
  const position: [number, number] = [31.5, 42.25];
  const edit = { edit: "set_position", path: at, element: "state", position };
  await server.ask("POST", `/machines/${id}/edits`, {
    id: "e1",
    base: revision,
    name: "Move",
    edit,
  });
  await server.ask("POST", `/machines/${id}/save`, {});
  return { at, position, states: document.states.length };
}

test("every machine that the reference ships is opened, edited, saved, and loads in the reference's own core", async () => {
  const paths = shipped();
  expect(paths.length).toBeGreaterThan(30);
  const machines = Object.fromEntries(paths.map((path) => [asName(path), join(share(), path)]));
  const server = await Server.start(newPlace(machines, shippedLibraries()));
  try {
    const [project] = await server.ask<{ id: string }[]>("GET", "/projects");
    const moved: Record<string, Awaited<ReturnType<typeof editAndSave>>> = {};
    for (const name of Object.keys(machines)) {
      moved[join(server.place.project, name)] = await editAndSave(server, project?.id ?? "", name);
    }
    const loaded = loadInReference(Object.keys(moved), server.place.libraries);
    for (const [folder, { at, position, states }] of Object.entries(moved)) {
      expect(loaded[folder]?.positions[at], folder).toEqual(position);
      expect(loaded[folder]?.states, folder).toBe(states);
    }
  } finally {
    await server.dispose();
  }
});
