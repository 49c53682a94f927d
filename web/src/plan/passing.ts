/** Values through the ports of a container: the direct data flows without it, and whether their types fit. */

import type { ElementRef } from "../model/element.ts";
import { endInWords, flowEnds, isPort } from "../model/ends.ts";
import { dataFlowsOf, type Machine, portsOf } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import { fits, shortType } from "../model/types.ts";
import { type Refused, refused } from "./plan.ts";

interface Flow {
  readonly from: ElementRef;
  readonly to: ElementRef;
}

/** A value of a type that an `object` port let through, but that does not fit where it goes. */
export function passingRefused(machine: Machine, path: string): Refused | null {
  const parent = parentOf(path);
  if (parent === null) return null;
  const [outer, inner] = [flowsIn(machine, parent), flowsIn(machine, path)];
  for (const [before, behind] of [[outer, inner] as const, [inner, outer] as const]) {
    for (const first of before.filter(({ to }) => to.path === path)) {
      const bad = behind
        .filter(({ from }) => isSame(from, first.to))
        .map((second) => pairRefused(machine, parent, first.from, second.to))
        .find((refusal) => refusal !== null);
      if (bad) return bad;
    }
  }
  return null;
}

function flowsIn(machine: Machine, path: string): readonly Flow[] {
  const state = machine.state(path);
  return (state ? dataFlowsOf(state) : []).flatMap((flow) => flowEnds(machine, path, flow) ?? []);
}

function isSame(one: ElementRef, other: ElementRef): boolean {
  return isPort(one) && isPort(other) && one.path === other.path && one.id === other.id;
}

function pairRefused(
  machine: Machine,
  container: string,
  from: ElementRef,
  to: ElementRef,
): Refused | null {
  const [source, target] = [typeOf(machine, from), typeOf(machine, to)];
  if (source === null || target === null || fits(source, target)) return null;
  const words = (end: ElementRef) => endInWords(machine, container, end);
  return refused(
    `The value of ${words(from)} (${shortType(source)}) would flow directly to ${words(to)} (${shortType(target)}), which does not fit: change one of the types, or use object.`,
  );
}

function typeOf(machine: Machine, element: ElementRef): string | null {
  const state = machine.state(element.path);
  if (!state || !isPort(element)) return null;
  return portsOf(state, element.kind).find(({ id }) => id === element.id)?.data_type ?? null;
}
