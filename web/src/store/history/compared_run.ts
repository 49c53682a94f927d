/** With which other run a run is compared. */

import { signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import type { Watch } from "./run.ts";

/** The id of the other run; null if it is compared with none. */
export const comparedRun = perOwner((_watch: Watch) => signal<string | null>(null));
