/** Edits of this page that the confirmed machine does not have yet. Knows which of them are answered by what; never what they
 * look like. */

import type { Edit } from "../model/generated/protocol.ts";
import type { EditAnswer, PendingEdit } from "../store/document/machine_session.ts";

/** An edit, an undo (without one) or a redo on its way. */
interface OnItsWay extends PendingEdit {
  readonly edit: Edit | null;
  readonly settle: (answer: EditAnswer) => void;
  /** The revision that it made, if that is known and not here yet. */
  readonly made: number | null;
}

export class Pending {
  #all: readonly OnItsWay[] = [];

  get all(): readonly OnItsWay[] {
    return this.#all;
  }

  add(edit: OnItsWay): void {
    this.#all = [...this.#all, edit];
  }

  /** The answer came, perhaps before what it made. */
  answered(id: string, made: number): void {
    this.#all = this.#all.map((edit) => (edit.id === id ? { ...edit, made } : edit));
  }

  refused(id: string, reason: string): void {
    this.#settle((edit) => (edit.id === id ? { refused: reason } : null));
  }

  /** A revision is here. */
  revision(revision: number, id: string | null): void {
    this.#settle((edit) => {
      if (edit.id === id) return { revision };
      return edit.made !== null && edit.made <= revision ? { revision: edit.made } : null;
    });
  }

  #settle(answerOf: (edit: OnItsWay) => EditAnswer | null): void {
    const kept: OnItsWay[] = [];
    const settled: [OnItsWay, EditAnswer][] = [];
    for (const edit of this.#all) {
      const answer = answerOf(edit);
      if (answer) settled.push([edit, answer]);
      else kept.push(edit);
    }
    if (settled.length === 0) return;
    this.#all = kept;
    for (const [edit, answer] of settled) edit.settle(answer);
  }
}
