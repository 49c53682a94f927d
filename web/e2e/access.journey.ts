import { readFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const AXE = readFileSync(join(process.cwd(), "node_modules/axe-core/axe.min.js"), "utf8");

interface Finding {
  readonly id: string;
  readonly help: string;
  readonly nodes: readonly {
    readonly target: readonly unknown[];
    readonly failureSummary?: string;
  }[];
}

/** What axe finds wrong with the page as it stands, in words. */
async function findings(app: App): Promise<readonly string[]> {
  await app.sheet.evaluate(AXE);
  const found = await app.sheet.evaluate(async () => {
    const { axe } = window as unknown as { axe: { run: () => Promise<{ violations: unknown }> } };
    return (await axe.run()).violations;
  });
  return (found as readonly Finding[]).map(({ id, help, nodes }) => {
    const places = nodes.map(
      ({ target, failureSummary }) => `${target.join(" ")}: ${failureSummary}`,
    );
    return `${id} (${help}): ${places.join("; ")}`;
  });
}

for (const colorScheme of ["light", "dark"] as const) {
  journey(
    `nobody is shut out of the ${colorScheme} page`,
    { open: "hierarchy_and_data", browser: { colorScheme } },
    async ({ app }) => {
      expect(await findings(app)).toEqual([]);
      await app.select("PACKER/LABELS");
      for (const panel of ["Libraries", "Tree", "Search", "Log", "Edits", "Differences"]) {
        await app.panel(panel);
        expect(await findings(app), panel).toEqual([]);
      }
      await app.command("Settings…");
      expect(await findings(app), "settings").toEqual([]);
    },
  );
}

journey("no one is shut out of the login", {}, async ({ app, server }) => {
  await app.sheet.context().clearCookies();
  await app.sheet.goto(server.url);
  await app.sheet.getByLabel("Password").waitFor();
  expect(await findings(app)).toEqual([]);
});

journey(
  "the page loads nothing from elsewhere and breaks none of its rules",
  {
    open: "library_reuse",
  },
  async ({ app, server, tab }) => {
    const other = await tab(app);
    const asked: string[] = [];
    const errors: string[] = [];
    other.sheet.on("request", (request) => asked.push(request.url()));
    other.sheet.on(
      "console",
      (message) => message.type() === "error" && errors.push(message.text()),
    );
    other.sheet.on("pageerror", (error) => errors.push(error.message));
    await other.sheet.reload();
    await other.connected();
    await other.open("library_reuse");
    await other.press("Control+Shift+l");
    await other.settled();
    const foreign = asked.filter(
      (url) => !url.startsWith(server.url) && !url.startsWith("data:") && !url.startsWith("blob:"),
    );
    expect([foreign, errors]).toEqual([[], []]);
  },
);
