/** A request with an id of its own, which is carried out once: sent again for as long as its answer may have been lost. */

import { REPEATED, RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { AGAIN, Outbox } from "./outbox.ts";

/** Time in which a request is repeated, in ms. */
const PATIENCE_MS = 60_000;

/** Asks until there is an answer. Throws a `RefusalError`: that of the server, or, after a minute, that nobody knows. */
export function requestUntilAnswered<T>(
  { server, clock }: { readonly server: Pick<Server, "request">; readonly clock: Clock },
  path: string,
  body: { readonly id: string },
): Promise<T> {
  const end_ms = clock.now() + PATIENCE_MS;
  const outbox = new Outbox<{ readonly id: string }, T, T>({
    clock,
    send: () => server.request<T>("POST", path, body, REPEATED),
    onAnswer: (_, answer) => answer,
    onRefusal: (_, error) => {
      if (!isLost(error)) throw error;
      if (clock.now() >= end_ms) throw unknown(error);
      return AGAIN;
    },
  });
  return outbox.put(body);
}

/** True if nobody knows whether the request was carried out. */
export function isUnknownFate({ status, code }: RefusalError): boolean {
  return status === 0 || code === "fate_unknown";
}

/** True if it may have been carried out nevertheless. */
function isLost({ status, code }: RefusalError): boolean {
  return status === 0 || status === 429 || code === "not_finished";
}

function unknown({ message, code }: RefusalError): RefusalError {
  const text = `it is unknown whether it was carried out: ${message}. Check the list of runs before you try again.`;
  return new RefusalError({ code, message: text }, 0);
}
