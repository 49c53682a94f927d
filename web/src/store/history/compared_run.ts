/** The other run of a comparison. */

import { signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import type { Watch } from "./run.ts";

/** Id of the other run; null without a comparison. */
export const comparedRun = perOwner((_watch: Watch) => signal<string | null>(null));
