/** The machine that a run uses, stored with the run and read-only. It changes when the run uses another one, or when a moment with another
 * one is shown. */

import { batch, effect, signal } from "@preact/signals-core";
import type {
  Document,
  MachineProblem,
  MachineStatus,
  MachineSteps,
} from "../model/generated/protocol.ts";
import { type LibraryKey, libraryKey } from "../store/document/graft.ts";
import type { MachineSession, PendingEdit } from "../store/document/machine_session.ts";
import { withNames } from "../store/document/names_in.ts";
import { OptimisticDocument, type TouchedPaths } from "../store/document/optimistic_document.ts";
import { type Journal, OTHER } from "../store/history/journal.ts";
import type { Runs, Watch } from "../store/history/run.ts";
import { LatestRequest } from "../store/page/latest_request.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { LibraryCache } from "./library_cache.ts";

interface Ports {
  readonly server: Server;
  readonly clock: Clock;
}

/** The id of the session of a run's machine. */
export function runSessionId(run: string): string {
  return `run ${run}`;
}

const FIXED = "This is the machine that the run used. Edit the machine itself in its project.";
const REFUSED = { refused: FIXED };

export class RunMachineSession implements MachineSession {
  readonly id: string;
  readonly fixed = FIXED;
  readonly machine: OptimisticDocument;
  readonly version = signal(0);
  readonly revision = signal(0);
  readonly status = signal<MachineStatus | null>(null);
  readonly people = signal([]);
  readonly pending = signal<readonly PendingEdit[]>([]);
  readonly steps = signal<MachineSteps>({ start: 0, steps: [] });
  readonly problems = signal<readonly MachineProblem[]>([]);
  readonly isChecked = signal(false);
  readonly check = () => Promise.resolve(null);
  readonly #libraryCache: LibraryCache;
  readonly #listeners = new Set<(touched: TouchedPaths) => void>();
  readonly #stops: (() => void)[];
  #root: string | null = null;
  /** True if `#root` is the first one that the history names. */
  #isFirst = true;
  /** The machine that the run used last by its history, and the read part of the history. */
  #last: string | null = null;
  #read = 0;
  #journal: Journal | null = null;

  /** Gets the machine that the run began with. Throws a `RefusalError`. */
  static async enter(watch: Watch, runs: Runs, ports: Ports) {
    const document = await runs.get<Document>(watch.id, "machine");
    return new RunMachineSession(watch, runs, ports, document);
  }

  private constructor(watch: Watch, runs: Runs, ports: Ports, document: Document) {
    this.id = runSessionId(watch.id);
    const run = encodeURIComponent(watch.id);
    this.#libraryCache = new LibraryCache(ports.server.request, (key: LibraryKey) => {
      const root = this.#root === null ? "" : `&root=${encodeURIComponent(this.#root)}`;
      return `/runs/${run}/machine?library=${encodeURIComponent(key)}${root}`;
    });
    this.machine = new OptimisticDocument(document, (key) => this.#libraryCache.get(key));
    const request = new LatestRequest<string, Document>({
      ask: (root) => this.#fetch(runs, watch.id, root),
      take: (fetched) => {
        this.machine.reset(fetched);
        this.#notify();
      },
      after: ports.clock.after,
    });
    const follow = effect(() => {
      const root = this.#wanted(watch);
      if (root === null || root === this.#root) return;
      this.#isFirst = this.#root === null;
      this.#root = root;
      request.want(root);
    });
    const arrived = this.#libraryCache.onArrival(() => this.#libraryChanged());
    this.#stops = [arrived, follow, () => request.close()];
  }

  onChange(listener: (touched: TouchedPaths) => void): () => void {
    this.#listeners.add(listener);
    return () => void this.#listeners.delete(listener);
  }

  readonly edit = () => Promise.resolve(REFUSED);
  readonly undo = () => Promise.resolve(REFUSED);
  readonly redo = () => Promise.resolve(REFUSED);
  readonly jump = () => Promise.resolve({ ...REFUSED, code: "fixed" });
  readonly stepChange = () => undefined;
  readonly named = (text: string) => withNames(text, (path) => this.machine.state(path)?.name);

  async loadLibrary(path: string): Promise<void> {
    const library = this.machine.state(path)?.library;
    if (!library) return;
    try {
      await this.#libraryCache.load(libraryKey(library));
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
    }
  }

  close(): void {
    for (const stop of this.#stops) stop();
    this.#listeners.clear();
  }

  /** Machine of the moment or of the end; null while it is unknown. */
  #wanted({ playhead, playheadSnapshot: snapshot, journal, journalVersion }: Watch): string | null {
    journalVersion.value;
    const picture = snapshot.value?.picture ?? null;
    if (playhead.value !== null) return picture?.root ?? null;
    if (journal !== this.#journal) this.#read = 0;
    this.#journal = journal;
    for (; this.#read < journal.length; this.#read += 1) {
      const event = journal.kind(this.#read) === OTHER ? journal.other(this.#read) : undefined;
      if (event?.type === "root") this.#last = event.hash;
    }
    return this.#last ?? picture?.root ?? null;
  }

  async #fetch(runs: Runs, run: string, root: string): Promise<Document> {
    const document = await runs.get<Document>(run, `machine?root=${encodeURIComponent(root)}`);
    // The libraries of the first machine are those of the run's start.
    if (!this.#isFirst) await this.#libraryCache.refresh();
    return document;
  }

  #libraryChanged(): void {
    this.machine.libraryChanged();
    this.#notify();
  }

  #notify(): void {
    batch(() => {
      for (const listener of this.#listeners) listener(null);
      this.version.value = this.machine.version;
    });
  }
}
