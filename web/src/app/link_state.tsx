/** State of the connection, age of the shown data, and the user. */

import { agePhrase } from "../panels/parts/age.ts";
import { useSignal } from "../ui/signals.ts";
import { useNow } from "./bars.tsx";
import { useSession } from "./session_context.tsx";

export function LinkState() {
  const { page } = useSession();
  const link = useSignal(page.server.link);
  const pulse = useSignal(page.server.pulse);
  const now_ms = useNow(link.state !== "up");
  if (link.state === "up") {
    const { user, role } = link.session;
    const delay = pulse?.delay_ms == null ? "" : `, ${Math.round(pulse.delay_ms)} ms`;
    return (
      <span
        className="link link-up"
        role="status"
        title={`Connected${delay}. You are ${user}: ${role}.`}
      >
        <span className="link-dot" aria-hidden />
        <span className="link-user">{user}</span>
        <span className="link-role">{role}</span>
      </span>
    );
  }
  const since_ms = link.state === "down" ? link.since_ms : now_ms;
  const text = link.state === "down" ? `offline for ${agePhrase(now_ms - since_ms)}` : "connecting";
  return (
    <span className="link link-down" role="status">
      <span className="link-dot" aria-hidden />
      {text}
    </span>
  );
}
