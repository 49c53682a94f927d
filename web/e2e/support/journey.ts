/** A journey: one person, or several, with browsers of their own, at one real server. A journey that fails leaves pictures. */

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import type { Browser, BrowserContextOptions } from "playwright-core";
import { test } from "vitest";
import type { Role } from "../../src/model/generated/protocol.ts";
import { App } from "./app.ts";
import { launch } from "./chromium.ts";
import { WAIT_MS } from "./patience.ts";
import { examples, newPlace, type Place, RESULTS } from "./places.ts";
import { Server } from "./server.ts";
import { beginStation } from "./station.ts";

export interface Setting {
  /** The machines of the project, by name: folders to copy. */
  readonly machines?: Readonly<Record<string, string>>;
  /** Library roots by name: folders to copy. Those of the examples, if none are named. */
  readonly libraries?: Readonly<Record<string, string>>;
  /** The machine that is open when the journey begins. */
  readonly open?: string;
  readonly browser?: BrowserContextOptions;
  /** The page is that of a station, and the machines are on a robot far away, `scout`. */
  readonly isStation?: boolean;
  /** More words for the command line of the server. */
  readonly serve?: readonly string[];
  /** What the server finds on its path beside what is there for everybody. */
  readonly programs?: () => readonly string[];
}

/** What a journey has at hand. */
export interface Hands {
  readonly app: App;
  readonly server: Server;
  /** Where runs run: far away if the server is a station, else the server itself. */
  readonly robot: Server;
  /** One more person with a name in a browser of their own: an engineer, if nothing else is said. */
  readonly colleague: (name: string, role?: Role) => Promise<App>;
  /** One more tab of the same browser. */
  readonly tab: (app: App) => Promise<App>;
}

let browser: Promise<Browser> | null = null;

/** The browser of all journeys of this process, which ends with it. */
async function theBrowser(): Promise<Browser> {
  browser ??= launch();
  const there = await browser;
  if (there.isConnected()) return there;
  browser = launch();
  return browser;
}

/** Goes the journey from a fresh server and a fresh browser profile. */
export function journey(name: string, setting: Setting, go: (hands: Hands) => Promise<void>): void {
  test(name, async () => {
    const [server, robot] = await begin(setting);
    const people: App[] = [];
    try {
      await go({ ...(await hands(server, people, setting)), robot });
    } catch (error) {
      await pictures(name, people);
      throw error;
    } finally {
      await Promise.all(people.map((app) => app.sheet.context().close()));
      await server.dispose();
      if (robot !== server) await robot.dispose();
    }
  });
}

/** The server of the page, and where runs run. */
async function begin(setting: Setting): Promise<readonly [Server, Server]> {
  const place = placeOf(setting);
  if (!setting.isStation) {
    const server = await Server.start(place, "serve", setting.serve);
    return [server, server];
  }
  return beginStation(place);
}

function placeOf({ open, machines, libraries, programs }: Setting): Place {
  const example = open && !machines?.[open] ? [open] : [];
  const place = newPlace({ ...examples(...example), ...machines }, libraries);
  return programs ? { ...place, programs: programs() } : place;
}

const PASSWORD = "correct horse";

async function hands(
  server: Server,
  people: App[],
  setting: Setting,
): Promise<Omit<Hands, "robot">> {
  const fresh = async () => {
    const context = await (await theBrowser()).newContext({
      viewport: { width: 1600, height: 1000 },
      reducedMotion: "reduce",
      permissions: ["clipboard-read", "clipboard-write"],
      ...setting.browser,
    });
    context.setDefaultTimeout(WAIT_MS);
    await context.addInitScript("window.__rafcon = null");
    return known(new App(await context.newPage(), server));
  };
  const known = (app: App) => {
    people.push(app);
    return app;
  };
  const colleague = async (name: string, role: Role = "engineer") => {
    await server.ask("POST", "/users", { name, role, password: PASSWORD });
    const app = await fresh();
    await app.logIn(name, PASSWORD);
    return app;
  };
  const tab = async (app: App) => {
    const other = known(new App(await app.sheet.context().newPage(), server));
    await other.enter();
    return other;
  };
  const app = await fresh();
  await app.enter();
  if (setting.open) await app.open(setting.open);
  return { app, server, colleague, tab };
}

async function pictures(name: string, people: readonly App[]): Promise<void> {
  mkdirSync(RESULTS, { recursive: true });
  const file = name.replaceAll(/[^a-z0-9]+/gi, "-").slice(0, 80);
  for (const [number, { sheet }] of people.entries()) {
    await sheet.screenshot({ path: join(RESULTS, `${file}-${number}.png`) }).catch(() => {});
  }
}
