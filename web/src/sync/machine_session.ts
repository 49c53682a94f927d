/** An open machine in the page: shows edits before they are answered, applies the changes of the server, and reports the fate of each
 * edit. */

import { batch, computed, type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import type {
  Done,
  Edit,
  MachineDocument,
  MachineProblem,
  MachineStatus,
  MachineSteps,
  MachineSummary,
  Presence,
  Revision,
} from "../model/generated/protocol.ts";
import { type LibraryKey, libraryKey } from "../store/document/graft.ts";
import type {
  EditAnswer,
  JumpAnswer,
  MachineSession,
  PendingEdit,
} from "../store/document/machine_session.ts";
import { GoneStates } from "../store/document/names_in.ts";
import { OptimisticDocument, type TouchedPaths } from "../store/document/optimistic_document.ts";
import { predictedWrites } from "../store/document/predict/predict.ts";
import { type StepChange, StepChanges, stepChangeOf } from "../store/document/step_change.ts";
import type { Notice, Page } from "../store/page/page.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { type EditOnItsWay, EditOutbox } from "./edit_outbox.ts";
import type { LibraryCache } from "./library_cache.ts";
import { MachineFollower } from "./machine_follower.ts";
import { ProposedLayout } from "./proposed_layout.ts";
import type { ReturnNews } from "./return_news.ts";

export interface OpenMachineSessionPorts {
  readonly server: Server;
  readonly libraryCache: LibraryCache;
  readonly clock: Clock;
  readonly newId: () => string;
  readonly tell: Page["tell"];
  readonly returnNews: ReturnNews;
}

/** Longest name of a step, in characters. */
const NAME_LENGTH_MAX = 200;
/** Capacity of the steps. Beyond it, the oldest are dropped. */
const STEPS_MAX = 10_000;
/** Pause without changes before problems are requested, in ms. */
const SETTLED_MS = 300;

export class OpenMachineSession implements MachineSession {
  readonly fixed = null;
  readonly machine: OptimisticDocument;
  readonly version: Signal<number>;
  readonly revision: Signal<number>;
  readonly status: Signal<MachineStatus | null>;
  readonly people: ReadonlySignal<readonly Presence[]>;
  readonly pending = signal<readonly PendingEdit[]>([]);
  readonly steps: Signal<MachineSteps>;
  readonly problems = signal<readonly MachineProblem[]>([]);
  readonly isChecked = signal(false);
  readonly proposal = new ProposedLayout({
    machine: () => {
      this.version.value;
      return this.machine;
    },
    make: (name, edit) => this.#make(name, edit),
    renew: () => this.#renew(() => {}),
  });
  readonly #ports: OpenMachineSessionPorts;
  readonly #outbox: EditOutbox;
  readonly #stepChanges = new StepChanges();
  readonly #gone = new GoneStates();
  /** Libraries whose content was refused, which was reported. */
  readonly #withoutContent = new Set<LibraryKey>();
  readonly #listeners = new Set<(touched: TouchedPaths) => void>();
  readonly #follower: MachineFollower;
  readonly #deaf: () => void;
  /** Counts changes and checks: only the last check after the last change describes the present machine. */
  #checksBegun = 0;
  #unsettled: () => void = () => {};
  /** The last received `is_recovered`. A bar shows the edits that a machine is opened with. */
  #wasRecovered: boolean;

  constructor(
    summary: MachineSummary,
    { revision, document }: MachineDocument,
    ports: OpenMachineSessionPorts,
  ) {
    this.#ports = ports;
    this.#wasRecovered = summary.is_recovered;
    this.machine = new OptimisticDocument(document, (key) => ports.libraryCache.get(key));
    this.version = signal(this.machine.version);
    this.revision = signal(revision);
    this.status = signal<MachineStatus | null>({ summary, people: [] });
    this.steps = signal({ start: revision, steps: [] });
    this.people = computed(() => this.#others());
    const stops = [
      ports.libraryCache.onArrival(() => this.#libraryChanged()),
      ports.libraryCache.onLook(() => this.#soonProblems()),
    ];
    this.#deaf = () => {
      for (const stop of stops) stop();
    };
    this.#follower = new MachineFollower(summary, ports.server, ports.clock, {
      revision: () => this.revision.peek(),
      revisions: (revisions) => this.#advance(revisions),
      status: (status) => this.#receiveStatus(status),
      whole: (whole) => this.#reset(whole),
      gone: (reason) => this.#tell("error", `it is no longer open: ${reason}`),
    });
    this.#outbox = new EditOutbox({
      ...ports,
      machine: () => this.id,
      onAnswer: (made) => {
        if (made <= this.revision.peek()) this.#renew(() => this.#settle(null));
      },
      onRefusal: (edit, error) => void this.#refused(edit, error),
    });
    void this.#look();
  }

  get id(): string {
    return this.#follower.id;
  }

  onChange(listener: (touched: TouchedPaths) => void): () => void {
    this.#listeners.add(listener);
    return () => void this.#listeners.delete(listener);
  }

  edit(name: string, edit: Edit): Promise<EditAnswer> {
    void this.proposal.keep();
    return this.#make(name, edit);
  }

  #make(name: string, edit: Edit): Promise<EditAnswer> {
    const short = [...name].slice(0, NAME_LENGTH_MAX).join("");
    const base = this.revision.peek();
    return this.#ask(short, edit, (id, machine) => {
      return { frame: "edit", machine, edit: { id, base, name: short, edit } };
    });
  }

  undo(): Promise<EditAnswer> {
    return this.#ask("Undo", null, (id, machine) => ({ frame: "undo", machine, undo: { id } }));
  }

  redo(): Promise<EditAnswer> {
    return this.#ask("Redo", null, (id, machine) => ({ frame: "redo", machine, redo: { id } }));
  }

  named(text: string): string {
    return this.#gone.named(text, (path) => this.machine.state(path)?.name);
  }

  stepChange(revision: number): StepChange | undefined {
    return this.#stepChanges.get(revision);
  }

  async jump(revision: number, overOthers: boolean): Promise<JumpAnswer> {
    const body = { id: this.#ports.newId(), revision, over_others: overOthers };
    const path = `${this.#follower.path}/jump`;
    try {
      return await this.#ports.server.request<Done>("POST", path, body);
    } catch (error) {
      return { refused: messageOf(error), code: codeOf(error) };
    }
  }

  async loadLibrary(path: string): Promise<void> {
    const library = this.machine.state(path)?.library;
    if (!library) return;
    const key = libraryKey(library);
    try {
      await this.#ports.libraryCache.load(key);
      this.#withoutContent.delete(key);
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      if (error.status === 0 || this.#withoutContent.has(key)) return;
      this.#withoutContent.add(key);
      this.#tell("warning", `the content of ${key} cannot be shown: ${error.message}`, path);
    }
  }

  close(): void {
    this.#follower.end();
    this.#outbox.close();
    this.#deaf();
    this.#unsettled();
    this.#listeners.clear();
  }

  #others(): readonly Presence[] {
    const link = this.#ports.server.link.value;
    const own = link.state === "up" ? link.connection : null;
    return (this.status.value?.people ?? []).filter(({ connection }) => connection !== own);
  }

  get #name(): string {
    return this.machine.state(this.machine.root)?.name ?? this.id;
  }

  #tell(level: Notice["level"], text: string, path = this.machine.root): void {
    const name = this.#name;
    const about = { machine: this.id, element: { kind: "state", path } } as const;
    this.#ports.tell({ level, text: `${name}: ${text}`, about });
  }

  /** Shows the edit immediately, sends it, and returns its fate. */
  #ask(
    name: string,
    edit: Edit | null,
    frame: (id: string, machine: string) => ReturnType<EditOnItsWay["frame"]>,
  ): Promise<EditAnswer> {
    const id = this.#ports.newId();
    const asked = { id, name, since_ms: this.#ports.clock.now(), edit };
    const answer = this.#outbox.put({ ...asked, frame: (machine) => frame(id, machine) });
    this.#change(() => {
      if (edit) this.#applyOptimistic(edit);
    });
    return answer;
  }

  async #refused({ id, name, edit }: EditOnItsWay, error: RefusalError): Promise<void> {
    const wasClosed = error.code === "no_such_machine";
    if (wasClosed && !this.#follower.isOver && (await this.#follower.reopen())) {
      this.#outbox.again(id);
      return;
    }
    const reason = `${wasClosed ? "the edit is lost: " : ""}${error.message}`;
    this.#renew(() => this.#outbox.refuse(id, reason));
    this.#tell("warning", `“${name}” was not applied: ${this.named(reason)}`, placeOf(edit));
  }

  #applyOptimistic(edit: Edit): void {
    this.machine.applyOptimistic(predictedWrites(this.machine, edit) ?? []);
  }

  /** Does the work on the confirmed machine, and shows what is on its way upon it again. */
  #renew(work: () => void): void {
    this.#change(() => {
      this.machine.rollback();
      work();
      const proposed = this.proposal.upon(this.machine);
      if (proposed) this.#applyOptimistic(proposed);
      for (const { edit } of this.#outbox.edits) if (edit) this.#applyOptimistic(edit);
    });
  }

  #change(work: () => void): void {
    const touched = this.machine.transact(work);
    batch(() => {
      this.pending.value = this.#outbox.edits;
      if (touched?.size !== 0) this.#tellChange(touched);
    });
  }

  #tellChange(touched: TouchedPaths): void {
    for (const listener of this.#listeners) listener(touched);
    this.version.value = this.machine.version;
  }

  #libraryChanged(): void {
    this.machine.libraryChanged();
    batch(() => this.#tellChange(null));
    this.#soonProblems();
  }

  #receiveStatus(status: MachineStatus): void {
    this.status.value = status;
    const isRecovered = status.summary.is_recovered;
    if (isRecovered && !this.#wasRecovered) this.#ports.returnNews.restored(this.#name);
    this.#wasRecovered = isRecovered;
  }

  #advance(revisions: readonly Revision[]): void {
    const fresh = revisions.filter(({ revision }) => revision > this.revision.peek());
    batch(() => {
      this.#renew(() => {
        for (const { revision, id, author, changes } of fresh) {
          const earlier = this.machine.confirm(changes);
          for (const [path, state] of earlier) {
            if (state && !this.machine.state(path)) this.#gone.note(path, state.name, author);
          }
          this.#stepChanges.put(revision, stepChangeOf(earlier, this.machine));
          this.revision.value = revision;
          this.#settle(id);
        }
      });
      const steps = fresh.map(({ changes: _, ...step }) => ({ ...step, is_kept: true }));
      const before = this.steps.peek();
      this.steps.value = { ...before, steps: [...before.steps, ...steps].slice(-STEPS_MAX) };
    });
    this.#soonProblems();
  }

  #settle(id: string | null): void {
    this.#outbox.arrived(this.revision.peek(), id);
  }

  #reset({ revision, document }: MachineDocument): void {
    const isOther = revision !== this.revision.peek();
    this.revision.value = revision;
    this.#renew(() => {
      this.machine.reset(document);
      this.#settle(null);
    });
    batch(() => this.#tellChange(null));
    if (isOther) this.#ports.returnNews.reloaded(this.#name);
    void this.#look();
  }

  /** Requests data that the server does not send by itself. */
  async #look(): Promise<void> {
    this.#soonProblems();
    const steps = await this.#get<MachineSteps>("steps");
    if (!steps) return;
    const last = steps.steps.at(-1)?.revision ?? steps.start;
    const newer = this.steps.peek().steps.filter(({ revision }) => revision > last);
    this.steps.value = { ...steps, steps: [...steps.steps, ...newer] };
  }

  #soonProblems(): void {
    this.isChecked.value = false;
    this.#checksBegun += 1;
    this.#unsettled();
    this.#unsettled = this.#ports.clock.after(SETTLED_MS, () => void this.check());
  }

  async check(): Promise<readonly MachineProblem[] | null> {
    this.#checksBegun += 1;
    const mine = this.#checksBegun;
    const problems = await this.#get<readonly MachineProblem[]>("problems");
    // Later changes are checked again.
    if (problems && mine === this.#checksBegun) {
      batch(() => {
        this.problems.value = problems;
        this.isChecked.value = true;
      });
    }
    return problems;
  }

  /** Null if it cannot be had now: it is asked for again after the next change. */
  async #get<T>(what: string): Promise<T | null> {
    try {
      return await this.#ports.server.request<T>("GET", `${this.#follower.path}/${what}`);
    } catch (error) {
      if (error instanceof RefusalError) return null;
      throw error;
    }
  }
}

/** The state that an edit is about, or its first part that is about one. */
function placeOf(edit: Edit | null | undefined): string | undefined {
  if (!edit) return undefined;
  if (edit.edit === "batch") return edit.edits.map(placeOf).find((path) => path !== undefined);
  return "path" in edit ? edit.path : undefined;
}

function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

function codeOf(error: unknown): string {
  return error instanceof RefusalError ? error.code : "failed";
}
