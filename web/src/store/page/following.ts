/** Whether the canvas of a tab goes along with what runs. */

import { signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import type { SessionView } from "./view.ts";

export const followedSignal = perOwner((_view: SessionView) => signal(false));
