/** The session for all components of the shell. */

import { computed } from "@preact/signals-core";
import { createContext, useContext, useMemo } from "react";
import { useSignal } from "../ui/signals.ts";
import type { AppSession } from "./session.ts";

const Session = createContext<AppSession | null>(null);

export const SessionProvider = Session.Provider;

export function useSession(): AppSession {
  const session = useContext(Session);
  if (!session) throw new Error("this stands outside of the page");
  return session;
}

/** What a function of signals gives, drawn again when that is another value; `deps` are what else it depends on. */
export function useDerived<T>(read: () => T, deps: readonly unknown[]): T {
  // biome-ignore lint/correctness/useExhaustiveDependencies: the caller says them
  return useSignal(useMemo(() => computed(read), deps));
}
