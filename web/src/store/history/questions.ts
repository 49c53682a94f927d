/** Questions of states to people: open ones, the times when they were asked, and the results of closed ones. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import type { Closing, JsonValue, Question } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { type Journal, OTHER } from "./journal.ts";
import type { Watch } from "./run.ts";

/** A closed question. */
export interface Closed {
  readonly question: Question;
  readonly sequence: number;
  readonly t_ns: number;
  readonly how: Closing;
  readonly answer: JsonValue | null;
  /** Author of the answer; empty if nobody answered. */
  readonly author: string;
}

interface AskedQuestions {
  /** Times when open questions were asked, by id: ns since the start of the run. */
  readonly since_ns: ReadonlyMap<number, number>;
  /** Recently closed questions, the newest first. */
  readonly closed: readonly Closed[];
}

/** Capacity of the closed questions. */
const CLOSED_MAX = 20;

type QuestionsWatch = Pick<Watch, "journal" | "journalVersion">;

/** Open questions at present, even if a past moment is shown, because people answer in the present. */
export function openQuestions(watch: Pick<Watch, "now">): readonly Question[] {
  const now = watch.now.value;
  return now?.run.phase === "live" ? (now.snapshot?.questions ?? []) : [];
}

/** Times and results of questions, collected as the journal grows. */
export const askedQuestions = perOwner((watch: QuestionsWatch): ReadonlySignal<AskedQuestions> => {
  return computed(() => {
    watch.journalVersion.value;
    return walkerOf(watch.journal).found(watch.journal);
  });
});

const walkerOf = perOwner((_journal: Journal) => new Walker());

/** Author of the answer to a question; null if unknown. Reads signals. */
export function answeredBy(watch: QuestionsWatch, question: number): string | null {
  const end = askedQuestions(watch).value.closed.find((each) => each.question.id === question);
  return end?.how === "answered" && end.author !== "" ? end.author : null;
}

class Walker {
  #asked: AskedQuestions = { since_ns: new Map(), closed: [] };
  readonly #open = new Map<number, Question>();
  #next = 0;

  /** Returns a new object only after a change. */
  found(journal: Watch["journal"]): AskedQuestions {
    for (; this.#next < journal.length; this.#next += 1) {
      if (journal.kind(this.#next) === OTHER) this.#look(journal, this.#next);
    }
    return this.#asked;
  }

  #look(journal: Watch["journal"], index: number): void {
    const event = journal.other(index);
    const { since_ns, closed } = this.#asked;
    if (event?.type === "asked") {
      this.#open.set(event.question.id, event.question);
      const since = new Map(since_ns).set(event.question.id, journal.t_ns(index));
      this.#asked = { since_ns: since, closed };
    } else if (event?.type === "closed") {
      const question = this.#open.get(event.id);
      if (!question) return;
      this.#open.delete(event.id);
      const since = new Map(since_ns);
      since.delete(event.id);
      const { how, answer, author } = event;
      const end = { sequence: journal.sequence(index), t_ns: journal.t_ns(index) };
      const ended = { question, ...end, how, answer, author };
      this.#asked = { since_ns: since, closed: [ended, ...closed].slice(0, CLOSED_MAX) };
    }
  }
}
