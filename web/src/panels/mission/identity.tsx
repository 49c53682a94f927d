/** Name of the user, the user's rights, and other users who are present. */

import { Eye, UserRound } from "lucide-react";
import { sessionOfPage } from "../../store/run/running.ts";
import { useComputed } from "../../ui/signals.ts";
import { useActiveTab, useHost } from "../context.tsx";

const MAY: Readonly<Record<string, string>> = {
  viewer: "you can view everything but not command runs",
  operator: "you can start and command runs, and answer questions",
  engineer: "you can command runs and change machines",
  admin: "you can do everything",
};

export function Identity() {
  const { page } = useHost().context();
  const session = useComputed(() => sessionOfPage(page), [page]);
  const tab = useActiveTab();
  const others = useComputed(
    () => [...new Set(tab?.session.people.value.map(({ user }) => user) ?? [])].join(", "),
    [tab],
  );
  return (
    <p className="mission-identity">
      {session && (
        <span className="mission-fact">
          <UserRound size={14} aria-hidden />
          <span>
            You are <strong>{session.user}</strong>: {session.role}
            <span className="mission-may"> – {MAY[session.role]}</span>
          </span>
        </span>
      )}
      {others !== "" && (
        <span className="mission-fact">
          <Eye size={14} aria-hidden />
          <span>Also here: {others}</span>
        </span>
      )}
    </p>
  );
}
