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

/** Starts of runs. A start of unknown fate is repeated with its id: another id would start a second run. */
export class StartRequests {
  readonly #ports: StartPorts;
  /** Ids of starts of unknown fate, by path and body. */
  readonly #ids = new Map<string, string>();

  constructor(ports: StartPorts) {
    this.#ports = ports;
  }

  async start<T>(path: string, body: object): Promise<T> {
    const key = JSON.stringify([path, body]);
    const id = this.#ids.get(key) ?? this.#ports.newId();
    this.#ids.set(key, id);
    try {
      const started = await requestUntilAnswered<T>(this.#ports, path, { ...body, id });
      this.#ids.delete(key);
      return started;
    } catch (error) {
      const isUnknown = error instanceof RefusalError && isUnknownFate(error);
      if (!isUnknown) this.#ids.delete(key);
      throw error;
    }
  }
}

export interface StartPorts {
  readonly server: Pick<Server, "request">;
  readonly clock: Clock;
  readonly newId: () => string;
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
