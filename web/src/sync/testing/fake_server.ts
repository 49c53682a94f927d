/** A server of a few lines, for tests: it makes the edits that can be predicted, refuses all others, and says what a test lets
 * through, when the test lets it through. */

import { signal } from "@preact/signals-core";
import type {
  Change,
  Document,
  Edit,
  EditMachine,
  MachineFile,
  MachineSummary,
  Refusal,
  Revision,
  RunSummary,
  StateDocument,
  ToClient,
  ToServer,
} from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import { OptimisticDocument } from "../../store/document/optimistic_document.ts";
import { predictedWrites } from "../../store/document/predict/predict.ts";
import {
  type AnswerFrame,
  type Follower,
  type Link,
  RefusalError,
  type Server,
} from "../../store/page/server.ts";

const CLOSED: Refusal = { code: "no_such_machine", message: "no machine is open" };
const SESSION = {
  user: "anna",
  role: "engineer",
  rights: [],
  version: "0",
  expires_ms: null,
} as const;

export const MACHINE: MachineSummary = {
  id: "m",
  file: { project: "p", path: "machine" },
  name: "Machine",
  revision: 1,
  saved_revision: 1,
  is_changed: false,
  disk: "same",
  is_recovered: false,
  set_aside: 0,
};

export class FakeServer implements Server {
  readonly link = signal<Link>({
    state: "up",
    session: { ...SESSION, rights: [] },
    connection: 1,
  });
  readonly pulse = signal(null);
  readonly asked: string[] = [];
  readonly sent: unknown[] = [];
  /** Documents of libraries by the route that gives them. */
  readonly libraries = new Map<string, Document>();
  /** The runs of the server; all went by the machine. */
  runs: readonly RunSummary[] = [];
  readonly model: OptimisticDocument;
  revision = 1;
  isOpen = true;
  /** Whether each folder is a machine of its own; else all are one. */
  hasMany = false;
  readonly #revisions: Revision[] = [];
  readonly #made = new Map<string, number>();
  readonly #followers = new Map<Follower, { next: number }>();
  readonly #statusFollowers = new Set<Follower>();
  readonly #waiting: EditMachine[] = [];
  readonly #listeners = new Set<(frame: AnswerFrame) => void>();
  #answers: (() => void)[] = [];

  constructor(document: Document) {
    this.model = new OptimisticDocument(document, () => undefined);
  }

  document(): Document {
    const states = [...this.model.paths()].flatMap((path) => this.model.state(path) ?? []);
    return { header: this.model.header, states };
  }

  request: Server["request"] = async <T>(
    method: string,
    path: string,
    body?: unknown,
  ): Promise<T> => {
    this.asked.push(`${method} ${path}`);
    if (path.startsWith("/libraries/")) return this.#library(path) as T;
    if (path === "/runs") return this.runs as T;
    if (/^\/runs\/.*\/machine/.test(path)) return this.document() as T;
    if (path === "/machines/open") this.isOpen = true;
    const { file } = (body ?? {}) as { file?: MachineFile };
    if (this.hasMany && file) return { ...MACHINE, id: file.path, file } as T;
    if (path === "/machines/open") return { ...MACHINE, revision: this.revision } as T;
    if (!this.isOpen) throw new RefusalError(CLOSED, 404);
    if (path.endsWith("/document")) {
      return { revision: this.revision, document: this.document() } as T;
    }
    if (path.endsWith("/steps")) return { start: 1, steps: [] } as T;
    return [] as T;
  };

  lines: Server["lines"] = async () => {
    throw new RefusalError(CLOSED, 404);
  };

  follow: Server["follow"] = (follower) => {
    const topic = follower.topic();
    if (topic.topic === "machine_history") this.#followers.set(follower, { next: topic.from });
    if (topic.topic === "machine_status") this.#statusFollowers.add(follower);
    return () => {
      this.#followers.delete(follower);
      this.#statusFollowers.delete(follower);
    };
  };

  onAnswer: Server["onAnswer"] = (listener) => {
    this.#listeners.add(listener);
    return () => void this.#listeners.delete(listener);
  };

  say(frame: ToServer): void {
    this.sent.push(frame);
    if (frame.frame === "edit") this.#waiting.push(frame.edit);
  }

  retry(): void {}

  /** Takes the next edit that has arrived, and makes or refuses it. Its answer waits. */
  take(): void {
    const next = this.#waiting.shift();
    if (!next) return;
    const { id, edit } = next;
    if (!this.isOpen) this.#answers.push(() => this.#refuse(id, CLOSED));
    else {
      const revision = this.#made.get(id) ?? this.make(id, edit);
      const why = { code: "rule", message: "it breaks a rule" };
      this.#answers.push(() => {
        if (revision === null) this.#refuse(id, why);
        else this.#answer({ frame: "edited", id, revision });
      });
    }
  }

  #refuse(id: string, refusal: Refusal): void {
    this.#answer({ frame: "refused", id, refusal });
  }

  #answer(frame: AnswerFrame): void {
    for (const listener of this.#listeners) listener(frame);
  }

  /** Somebody makes an edit; gives its revision, null if it is refused. */
  make(id: string, edit: Edit): number | null {
    const writes = predictedWrites(this.model, edit);
    if (!writes) return null;
    const before = this.document();
    this.model.transact(() => this.model.applyOptimistic(writes));
    this.revision += 1;
    this.#made.set(id, this.revision);
    const changes = changesBetween(before, this.document());
    const { revision } = this;
    const about = { id, author: "ben", name: "Step", at_ms: 0, kind: "edit" } as const;
    this.#revisions.push({ revision, ...about, changes });
    return revision;
  }

  /** The oldest answer arrives. */
  answer(): void {
    this.#answers.shift()?.();
  }

  /** The next revisions arrive, at most so many. */
  tell(count: number): void {
    for (const [follower, at] of this.#followers) {
      const revisions = this.#revisions.filter(({ revision }) => revision >= at.next);
      const batch = revisions.slice(0, count);
      if (batch.length === 0) continue;
      at.next += batch.length;
      follower.frame({ frame: "revisions", subscription: 1, revisions: batch });
    }
  }

  /** Tells a follower of the history something else. */
  news(frame: ToClient): void {
    for (const follower of [...this.#followers.keys()]) {
      this.#followers.delete(follower);
      follower.frame(frame);
    }
  }

  /** Sends the status of the machine. */
  sendStatus(summary: MachineSummary): void {
    const status = { summary, people: [] };
    for (const follower of [...this.#statusFollowers]) {
      follower.frame({ frame: "machine_status", subscription: 2, status });
    }
  }

  get isIdle(): boolean {
    return this.#waiting.length === 0 && this.#answers.length === 0;
  }

  #library(path: string): Document {
    const found = this.libraries.get(path);
    if (found) return found;
    throw new RefusalError({ code: "no_library", message: "there is no such library" }, 404);
  }
}

function changesBetween(before: Document, after: Document): Change[] {
  const [old, now] = [byPath(before), byPath(after)];
  const gone = [...old.keys()].filter((path) => !now.has(path));
  const removed = gone.map((path): Change => ({ change: "state_removed", path }));
  const header: Change = { change: "header", header: after.header };
  return [
    ...removed,
    ...after.states.flatMap((state) => changesOf(old.get(state.path), state)),
    header,
  ];
}

function changesOf(old: StateDocument | undefined, state: StateDocument): Change[] {
  if (isSame(old, state)) return [];
  const { path, transitions = [], data_flows = [], ...alone } = state;
  const changes: Change[] = [{ change: "state", state: { path, ...alone } }];
  const ids = (one: readonly { id: number }[], other: readonly { id: number }[] = []) =>
    new Set([...one, ...other].map(({ id }) => id));
  for (const id of ids(transitions, old?.transitions)) {
    const transition = transitions.find((each) => each.id === id);
    changes.push({ change: "transition", path, id, ...(transition ? { transition } : {}) });
  }
  for (const id of ids(data_flows, old?.data_flows)) {
    const data_flow = data_flows.find((each) => each.id === id);
    changes.push({ change: "data_flow", path, id, ...(data_flow ? { data_flow } : {}) });
  }
  return changes;
}

function byPath(document: Document): ReadonlyMap<string, StateDocument> {
  return new Map(document.states.map((state) => [state.path, state]));
}
