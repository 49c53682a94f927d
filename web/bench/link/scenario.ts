/** What happens in the hour: blackouts, servers that die, operators who come, sleep and take over. Scaled to shorter times. */

import { setTimeout as pass } from "node:timers/promises";
import { launch } from "../../e2e/support/chromium.ts";
import type { RunNow } from "../../src/model/generated/protocol.ts";
import type { Camp, Ground } from "./camp.ts";
import type { Hour, Span } from "./measures.ts";
import type { Operator } from "./operator.ts";
import { pageLive } from "./page.ts";

const DELAY_MS = 2_000;
const DOWN_BITS = 256_000;
/** After a cut, and after a server has begun, so long is not measured as if the link were whole. */
const SETTLE_MS = 10_000;
/** A hold is taken back after so long. */
const HELD_MS = 5_000;
const COMMAND_MS = 10_000;
/** So long before the link changes nobody holds the mission: it would stay held. */
const NO_HOLD_MS = 16_000;
/** The minutes at which the link changes, or who commands. */
const CHANGES = [4, 7, 22, 24, 36, 37.5, 40, 55, 56];
const QUIET_MS = 15_000;
/** A page that takes longer is never live. */
const PAGE_MS = 60_000;

export interface Wanted {
  readonly minutes: number;
}

/** The hour while it happens. */
export class Scenario {
  readonly #camp: Camp;
  readonly #begun = Date.now();
  readonly #scale: number;
  readonly #whole: Span[] = [];
  readonly #oneWay: Span[] = [];
  readonly #cuts: Span[] = [];
  readonly #memory: Record<string, number[]> = {};
  #wholeSince: number | null = null;
  #bytesSince = 0;
  #wholeBytes = 0;
  #commander: Operator | null = null;
  #root = "";
  #failures = 0;
  #commands = 0;

  constructor(camp: Camp, { minutes }: Wanted) {
    [this.#camp, this.#scale] = [camp, minutes / 60];
  }

  /** Waits for a minute of the hour. */
  async #at(minute: number, what: string): Promise<void> {
    const wait = this.#begun + minute * 60_000 * this.#scale - Date.now();
    await pass(Math.max(0, wait));
    process.stderr.write(`${((Date.now() - this.#begun) / 60_000).toFixed(1)} min: ${what}\n`);
    const { robot, grounds } = this.#camp;
    for (const host of [robot, ...grounds.map(({ host }) => host)]) {
      if (host.pid) this.#remember(host.name.replace(" ", "_"), host.memory());
    }
  }

  #remember(name: string, mb: number): void {
    this.#memory[name] ??= [];
    this.#memory[name].push(mb);
  }

  /** From now on the link is whole, once it has settled. */
  async #isWhole(): Promise<void> {
    await pass(SETTLE_MS);
    [this.#wholeSince, this.#bytesSince] = [Date.now(), await this.#camp.sent()];
  }

  /** It is not, from now on. */
  async #isNotWhole(): Promise<void> {
    if (this.#wholeSince === null) return;
    this.#whole.push({ from: this.#wholeSince, to: Date.now() });
    this.#wholeBytes += (await this.#camp.sent()) - this.#bytesSince;
    this.#wholeSince = null;
  }

  /** Somebody commands all the time: breakpoints that hold nothing, and while the link is whole now and then a hold. */
  async #command(over: AbortSignal): Promise<void> {
    while (!over.aborted) {
      await pass(COMMAND_MS);
      const operator = this.#commander;
      this.#commands += 1;
      if (!operator || over.aborted) continue;
      if (this.#commands % 2 === 0 && this.#isCalm()) {
        operator.command({ type: "pause" });
        await pass(HELD_MS);
        operator.command({ type: "resume", branch: null });
      } else {
        this.#decide(operator);
      }
    }
  }

  /** Whether the link is whole, and stays so long enough for a hold. */
  #isCalm(): boolean {
    const minute = (Date.now() - this.#begun) / 60_000 / this.#scale;
    const next = CHANGES.find((change) => change > minute) ?? minute;
    return this.#wholeSince !== null && (next - minute) * 60_000 * this.#scale > NO_HOLD_MS;
  }

  /** A command without consequences: a breakpoint that is never reached. */
  #decide(operator: Operator): void {
    const breakpoint = {
      id: this.#commands % 100,
      path: this.#root,
      when: "before",
      condition: null,
      hit_count: 1_000_000,
      scope: "branch",
      unattended: "hold",
      enabled: true,
    } as const;
    operator.command({ type: "set_breakpoint", breakpoint });
  }

  async play(): Promise<Hour> {
    const { robot, ground, grounds } = this.#camp;
    const far = grounds[1] ?? ground;
    const observer = this.#camp.operator("observer", robot);
    const anna = this.#camp.operator("anna", ground.host);
    const bert = this.#camp.operator("bert", far.host);
    await this.#camp.until(ground.host, ({ snapshot }) => snapshot !== null, 120_000);
    const { snapshot } = await robot.ask<RunNow>("GET", `/runs/${this.#camp.run}`);
    this.#root = snapshot?.active[0]?.path ?? "";
    const over = new AbortController();
    const commanding = this.#command(over.signal);
    this.#commander = anna;
    await this.#isWhole();
    const page_live_ms = await this.#pageAtSlowLink(ground);
    await this.#firstCut(anna);
    await this.#withoutUpLink(7, 22);
    await this.#passAuthority(anna, bert);
    const carl = await this.#secondCut(ground);
    await this.#sleep(bert);
    const late = await this.#withoutUpLink(40, 55, grounds[2]);
    const quiet = await this.#quiet(bert);
    over.abort();
    await commanding;
    await this.#end(bert);
    const operators = await Promise.all([anna, bert, carl].map((one) => one.notes()));
    const noted = await observer.notes();
    for (const one of [observer, anna, bert, carl]) one.end();
    return {
      delay_ms: DELAY_MS,
      bits_per_s: DOWN_BITS,
      whole: this.#whole,
      oneWay: this.#oneWay,
      cuts: this.#cuts,
      quiet,
      wholeBytes: this.#wholeBytes,
      page_live_ms,
      late,
      robotJournal: this.#camp.history(robot),
      replicas: grounds.map(({ host }) => this.#camp.history(host)),
      observer: noted,
      operators,
      memory: this.#memory,
      failures: this.#failures,
    };
  }

  async #pageAtSlowLink(ground: Ground): Promise<number> {
    await this.#at(1, "a page is opened at the station, behind it 64 kbit/s");
    await this.#camp.link("down 64000");
    // A browser that hangs holds up nothing.
    const never = pass(PAGE_MS, Number.POSITIVE_INFINITY, { ref: false });
    try {
      return await Promise.race([this.#visit(ground), never]);
    } finally {
      await this.#camp.link(`down ${DOWN_BITS}`);
    }
  }

  async #visit(ground: Ground): Promise<number> {
    const browser = await launch();
    try {
      return await pageLive(browser, ground.host, this.#camp.run);
    } catch (error) {
      process.stderr.write(`the page was not live: ${error}\n`);
      return Number.POSITIVE_INFINITY;
    } finally {
      browser.close().catch(() => undefined);
    }
  }

  /** A blackout that begins while a command is on its way; the robot's server dies in it. */
  async #firstCut(operator: Operator): Promise<void> {
    await this.#at(4, "blackout, with a command on its way");
    this.#decide(operator);
    await pass(1_000);
    await this.#isNotWhole();
    const from = Date.now();
    await this.#camp.link("cut");
    await this.#at(4.4, "the robot's server dies");
    await this.#camp.robot.kill();
    await this.#at(4.7, "and begins again");
    await this.#camp.robot.begin();
    await this.#at(5.5, "the link is back");
    await this.#camp.link("mend");
    this.#cuts.push({ from, to: Date.now() });
    await this.#isWhole();
  }

  /** Only the robot is heard. A station without a replica may come in that time: from when it was there to when it was live. */
  async #withoutUpLink(from: number, to: number, late?: Ground): Promise<Span | null> {
    await this.#at(from, "no up-link");
    await this.#isNotWhole();
    await this.#camp.link("cut up");
    await pass(SETTLE_MS);
    const begun = Date.now();
    const joined = late ? await this.#joinLate((from + to) / 2, late) : null;
    await this.#at(to, "the up-link is back");
    this.#oneWay.push({ from: begun, to: Date.now() });
    await this.#camp.link("mend up");
    await this.#isWhole();
    return joined;
  }

  async #joinLate(minute: number, { host }: Ground): Promise<Span> {
    await this.#at(minute, "a station comes that has nothing");
    await host.begin();
    const from = Date.now();
    const { snapshot } = await this.#camp.robot.ask<RunNow>("GET", `/runs/${this.#camp.run}`);
    const head = snapshot?.sequence ?? 0;
    await this.#camp.until(host, (now) => (now.snapshot?.sequence ?? 0) >= head, 120_000);
    return { from, to: Date.now() };
  }

  /** From one operator to another, by consent. */
  async #passAuthority(from: Operator, to: Operator): Promise<void> {
    await this.#at(22.5, `${from.name} hands over to ${to.name}`);
    try {
      await this.#camp.passControl(from, to);
      this.#commander = to;
    } catch (error) {
      // The hour goes on; who reads the figures is told.
      process.stderr.write(`control was not passed: ${error}\n`);
      this.#failures += 1;
    }
  }

  /** The long blackout: what is sent up meanwhile comes afterwards. The station dies in it, and an operator comes. */
  async #secondCut({ host }: Ground): Promise<Operator> {
    await this.#at(24, "the long blackout");
    await this.#isNotWhole();
    const from = Date.now();
    await this.#camp.link("cut down");
    await this.#camp.link("hold up");
    await this.#at(28, "the station dies");
    await host.kill();
    await this.#at(29, "and begins again");
    await host.begin();
    await this.#at(31, "an operator comes");
    const carl = this.#camp.operator("carl", host);
    await this.#at(36, "the link is back");
    await this.#camp.link("mend");
    this.#cuts.push({ from, to: Date.now() });
    await this.#isWhole();
    return carl;
  }

  async #sleep(operator: Operator): Promise<void> {
    await this.#at(37.5, `${operator.name} sleeps`);
    const commander = this.#commander;
    this.#commander = null;
    operator.sleep();
    await this.#at(39, `${operator.name} wakes`);
    operator.wake();
    this.#commander = commander;
  }

  /** Nothing happens for a while. */
  async #quiet(operator: Operator): Promise<Hour["quiet"]> {
    await this.#at(56, "the mission is held");
    this.#commander = null;
    await pass(HELD_MS);
    await this.#isNotWhole();
    operator.command({ type: "pause" });
    await pass(SETTLE_MS);
    const [from, before] = [Date.now(), await this.#camp.sent()];
    // However short the hour is.
    await pass(QUIET_MS);
    await this.#at(58, "and goes on");
    const quiet = { from, to: Date.now(), bytes: (await this.#camp.sent()) - before };
    operator.command({ type: "resume", branch: null });
    return quiet;
  }

  async #end(operator: Operator): Promise<void> {
    await this.#at(59, "the mission is stopped");
    for (const { host } of this.#camp.grounds) process.stderr.write(host.say(["link"]));
    operator.command({ type: "stop" }, null);
    for (const { host } of this.#camp.grounds) {
      const isOver = await this.#camp.until(host, ({ run }) => run.phase === "finished", 120_000);
      if (!isOver) process.stderr.write(`${host.name} does not know the end of the run\n`);
    }
    await pass(1_000);
  }
}
