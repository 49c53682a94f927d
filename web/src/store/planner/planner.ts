/** Planner of an open machine: its inputs, its state and the plans that it found. Local to this page. */

import { computed, type Signal, signal } from "@preact/signals-core";
import type {
  PlanDomain,
  PlanEnd,
  PlanEvent,
  PlanFinding,
  PlanFound,
} from "../../model/generated/protocol.ts";
import { type PddlWords, typesOfText } from "../../model/pddl.ts";
import type { MachineSession } from "../document/machine_session.ts";
import { kept, type LocalStore } from "../local_store.ts";
import type { Server } from "../page/server.ts";
import { keptInputs, type PlannerInputs, questionOf, requestOf, wordsOf } from "./inputs.ts";

/** State of planning. */
export type Planning =
  | { readonly state: "idle" }
  | { readonly state: "planning"; readonly since_ms: number }
  | { readonly state: Exclude<PlanEvent["event"], "found" | "refused">; readonly end: PlanEnd }
  | { readonly state: "refused"; readonly findings: readonly PlanFinding[] }
  | { readonly state: "unasked"; readonly reason: string };

/** A plan that was inserted into the machine. */
export interface Taken {
  readonly found: PlanFound;
  /** Path of the new state. */
  readonly path: string;
}

export class Planner {
  readonly inputs: Signal<PlannerInputs>;
  /** Planning domain of the skills; null before the server has sent it. */
  readonly domain = signal<PlanDomain | null>(null);
  /** Reason why the skills could not be read. */
  readonly domainFault = signal<string | null>(null);
  readonly planning = signal<Planning>({ state: "idle" });
  /** Latest plan. */
  readonly found = signal<PlanFound | null>(null);
  /** Last plan of the previous request. */
  readonly before = signal<PlanFound | null>(null);
  readonly taken = signal<Taken | null>(null);
  /** True if the latest plan belongs to the current skills, world and goal. */
  readonly isCurrent = computed(
    () => this.#answered.value !== null && this.#answered.value === questionOf(this.inputs.value),
  );
  /** Key of the latest plan, from `questionOf`. */
  readonly #answered = signal<string | null>(null);
  /** Container to insert the plan into. */
  readonly container = signal<string | null>(null);
  readonly #server: Pick<Server, "request" | "lines">;
  readonly #store: LocalStore;
  readonly #key: string;
  readonly #now: () => number;
  #control: AbortController | null = null;
  #pool = "";

  constructor(
    server: Pick<Server, "request" | "lines">,
    store: LocalStore,
    key: string,
    now: () => number = Date.now,
  ) {
    this.#server = server;
    this.#store = store;
    this.#key = `rafcon.planner.${key}`;
    this.#now = now;
    this.inputs = signal(keptInputs(kept(store, this.#key)));
  }

  change(changed: Partial<PlannerInputs>): void {
    this.inputs.value = { ...this.inputs.peek(), ...changed };
    this.#store.put(this.#key, this.inputs.peek());
    if (changed.libraries || changed.types !== undefined) void this.readSkills();
  }

  /** Requests the planning domain of the skills. Responses to older requests are ignored. */
  async readSkills(): Promise<void> {
    const { libraries, types } = this.inputs.peek();
    const pool = { libraries: [...libraries], types: typesOfText(types) };
    const asked = JSON.stringify(pool);
    this.#pool = asked;
    this.domainFault.value = null;
    if (libraries.length === 0) {
      this.domain.value = null;
      return;
    }
    try {
      const domain = await this.#server.request<PlanDomain>("POST", "/plans/domain", pool);
      if (this.#pool === asked) {
        this.domain.value = domain;
        knownWords.value = wordsOf(domain, this.inputs.peek());
      }
    } catch (error) {
      if (this.#pool === asked) this.domainFault.value = wordsOfError(error);
    }
  }

  /** Requests a plan; resolves once the planner is done. */
  async plan(): Promise<void> {
    this.cancel();
    const control = new AbortController();
    this.#control = control;
    const before = this.found.peek();
    const since_ms = this.#now();
    this.planning.value = { state: "planning", since_ms };
    let isFirst = true;
    const question = questionOf(this.inputs.peek());
    const tell = (event: PlanEvent) => {
      if (this.#control !== control) return;
      if (event.event === "found") {
        const { event: _, ...found } = event;
        if (isFirst) this.before.value = before;
        isFirst = false;
        this.found.value = found;
        this.#answered.value = question;
      } else if (event.event === "refused") {
        this.planning.value = { state: "refused", findings: event.findings };
      } else {
        const { event: state, ...end } = event;
        this.planning.value = { state, end };
      }
    };
    try {
      await this.#server.lines("/plans", requestOf(this.inputs.peek()), tell, control.signal);
      if (this.#isOn(control)) this.#unasked("The server ended without a word: try again.");
    } catch (error) {
      if (this.#control === control) this.#unasked(wordsOfError(error));
    }
    if (this.#control === control) this.#control = null;
  }

  /** Cancels planning; the server stops the engine. Plans found before are kept. */
  cancel(): void {
    const control = this.#control;
    if (!control) return;
    this.#control = null;
    control.abort();
    const planning = this.planning.peek();
    if (planning.state !== "planning") return;
    const after_ms = this.#now() - planning.since_ms;
    this.planning.value = { state: "cancelled", end: { reason: "cancelled", after_ms } };
  }

  /** Discards the plans. */
  dismiss(): void {
    this.found.value = null;
    this.before.value = null;
    if (!this.#control) this.planning.value = { state: "idle" };
  }

  #isOn(control: AbortController): boolean {
    return this.#control === control && this.planning.peek().state === "planning";
  }

  #unasked(reason: string): void {
    this.planning.value = { state: "unasked", reason };
  }
}

function wordsOfError(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** Predicates and types of the last pool that was read, offered for other skills, too. */
export const knownWords = signal<PddlWords>({ signatures: [], objects: [], types: {} });

const PLANNERS = new WeakMap<MachineSession, Planner>();

/** Planner of a machine. It is reused while the machine is open in this page. */
export function plannerOf(
  session: MachineSession,
  server: Pick<Server, "request" | "lines">,
  store: LocalStore,
): Planner {
  const known = PLANNERS.get(session);
  if (known) return known;
  const file = session.status.peek()?.summary.file;
  const planner = new Planner(server, store, file ? `${file.project}/${file.path}` : session.id);
  PLANNERS.set(session, planner);
  if (planner.inputs.peek().libraries.length > 0) void planner.readSkills();
  return planner;
}
