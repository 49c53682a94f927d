/** Label of a clock or duration that has stopped because nothing arrives: the age of its data. */

import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { truthAge } from "../../store/run/age.ts";
import { silence } from "../../store/run/data_end.ts";
import { useComputed } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { agePhrase } from "./age.ts";

/** Such as `, 27 s ago`; empty while data arrives. */
export function AsOf({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const text = useComputed(() => {
    const now_ms = clock1s.value;
    const { isOld, age_ms } = truthAge(page, watch, now_ms);
    const ago_ms = isOld ? age_ms : silence(page, watch, now_ms);
    return ago_ms === null ? "" : `, ${agePhrase(ago_ms)} ago`;
  }, [page, watch]);
  return <>{text}</>;
}
