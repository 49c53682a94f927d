/** The session for all components of the shell. */

import { createContext, useContext } from "react";
import type { AppSession } from "./session.ts";

const Session = createContext<AppSession | null>(null);

export const SessionProvider = Session.Provider;

export function useSession(): AppSession {
  const session = useContext(Session);
  if (!session) throw new Error("a component uses the session outside of SessionProvider");
  return session;
}
