/** An automatic layout that is shown and not made, of a machine without a drawing: the next edit or save makes it first. */

import { computed, type ReadonlySignal, signal } from "@preact/signals-core";
import type { Edit } from "../model/generated/protocol.ts";
import type { Machine } from "../model/machine.ts";
import { isUndrawn } from "../model/undrawn.ts";
import type {
  EditAnswer,
  LayoutProposal,
  ProposedEdit,
} from "../store/document/machine_session.ts";

interface ProposedLayoutPorts {
  /** The machine as it is shown; asked again with each change. */
  readonly machine: () => Machine;
  /** Makes the edit. */
  readonly make: (name: string, edit: Edit) => Promise<EditAnswer>;
  /** Shows the machine anew, with the proposal as it is now. */
  readonly renew: () => void;
}

export class ProposedLayout implements LayoutProposal {
  readonly #shown = signal<ProposedEdit | null>(null);
  readonly isDue: ReadonlySignal<boolean>;
  readonly #ports: ProposedLayoutPorts;

  constructor(ports: ProposedLayoutPorts) {
    this.#ports = ports;
    this.isDue = computed(() => this.#shown.value === null && isUndrawn(ports.machine()));
  }

  get shown(): ReadonlySignal<ProposedEdit | null> {
    return this.#shown;
  }

  show(plan: ProposedEdit): void {
    this.#shown.value = plan;
    this.#ports.renew();
  }

  async keep(): Promise<void> {
    const plan = this.#shown.peek();
    this.#shown.value = null;
    if (plan) await this.#ports.make(plan.name, plan.edit);
  }

  /** Edit shown on top of the confirmed machine; none once the machine has a drawing. */
  upon(machine: Machine): Edit | null {
    const plan = this.#shown.peek();
    if (plan && !isUndrawn(machine)) this.#shown.value = null;
    return this.#shown.peek()?.edit ?? null;
  }
}
