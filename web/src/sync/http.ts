/** Requests below `/api/v1`: what they are answered, or why they were refused. */

import type { Refusal } from "../model/generated/protocol.ts";
import { REPEATED, RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

/** Address of the server and a token. Both are empty in the server's own page, which has a cookie. */
export interface Address {
  /** `http://127.0.0.1:4747`, or nothing for the page's own server. */
  readonly url: string;
  readonly token?: string;
}

/** Dependencies of requests on the connection. */
interface RequestPorts {
  readonly clock: Clock;
  /** Timeout of a request, in ms. */
  readonly limit_ms: (isRepeated: boolean, bytes: number) => number;
  /** Called for each piece of an answer that comes. */
  readonly alive: () => void;
  /** Called with the status of each answer; 0 if there was none. */
  readonly onResponse: (method: string, path: string, status: number) => void;
}

export interface Requests {
  readonly request: Server["request"];
  readonly lines: Server["lines"];
  /** Gives up requests that are repeated and have no answer yet: what they were sent over was silent. */
  readonly askAgain: () => void;
}

/** Asks the server. */
export function requests(address: Address, ports: RequestPorts): Requests {
  const headers: Record<string, string> = { "Content-Type": "application/json" };
  if (address.token) headers["Authorization"] = `Bearer ${address.token}`;
  const repeated = new Set<AbortController>();

  const ask = async (method: string, path: string, text: string | null, isRepeated: boolean) => {
    const control = new AbortController();
    if (isRepeated) repeated.add(control);
    const timeout = new IdleTimeout(ports.clock, () => control.abort());
    let status = 0;
    try {
      timeout.begin(ports.limit_ms(isRepeated, text?.length ?? 0));
      const init = {
        method,
        headers,
        signal: control.signal,
        ...(text === null ? {} : { body: text }),
      };
      const answer = await fetch(`${address.url}/api/v1${path}`, init);
      repeated.delete(control);
      const found = await read(answer, () => {
        ports.alive();
        timeout.begin(ports.limit_ms(isRepeated, 0));
      });
      status = answer.status;
      return { status, text: found };
    } catch {
      throw new RefusalError(NO_ANSWER, 0);
    } finally {
      timeout.end();
      repeated.delete(control);
      ports.onResponse(method, path, status);
    }
  };

  const lines: Server["lines"] = async (path, body, tell, signal) => {
    let status = 0;
    let refused = "";
    try {
      const init = { method: "POST", headers, signal, body: JSON.stringify(body) };
      const answer = await fetch(`${address.url}/api/v1${path}`, init);
      status = answer.status;
      ports.alive();
      if (!answer.ok) refused = await answer.text();
      else await readLines(answer, ports.alive, tell);
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof SyntaxError) throw new RefusalError(refusal("", status), status);
      throw new RefusalError(BROKEN, 0);
    } finally {
      ports.onResponse("POST", path, status);
    }
    if (status < 200 || status > 299) throw new RefusalError(refusal(refused, status), status);
  };

  return {
    lines,
    askAgain: () => {
      for (const control of repeated) control.abort();
    },
    request: async <T>(method: string, path: string, body?: unknown, patience?: string) => {
      const sent = body === undefined ? null : JSON.stringify(body);
      const { status, text } = await ask(method, path, sent, patience === REPEATED);
      if (status < 200 || status > 299) throw new RefusalError(refusal(text, status), status);
      return (text === "" ? null : JSON.parse(text)) as T;
    },
  };
}

/** One limit of time that begins again with each piece. */
class IdleTimeout {
  readonly #clock: Clock;
  readonly #over: () => void;
  end: () => void = () => {};

  constructor(clock: Clock, over: () => void) {
    this.#clock = clock;
    this.#over = over;
  }

  begin(limit_ms: number): void {
    this.end();
    this.end = this.#clock.after(limit_ms, this.#over);
  }
}

/** The whole text of an answer, piece by piece. */
async function read(answer: Response, came: () => void): Promise<string> {
  came();
  const reader = answer.body?.getReader();
  if (!reader) return answer.text();
  const decoder = new TextDecoder();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return text + decoder.decode();
    came();
    text += decoder.decode(value, { stream: true });
  }
}

/** Tells each line of an answer once it is whole. */
async function readLines<T>(answer: Response, came: () => void, tell: (line: T) => void) {
  const reader = answer.body?.getReader();
  const decoder = new TextDecoder();
  let rest = "";
  for (;;) {
    const piece = await reader?.read();
    if (!piece || piece.done) break;
    came();
    const whole = (rest + decoder.decode(piece.value, { stream: true })).split("\n");
    rest = whole.pop() ?? "";
    for (const line of whole) if (line !== "") tell(JSON.parse(line) as T);
  }
  if (rest !== "") tell(JSON.parse(rest) as T);
}

const BROKEN: Refusal = {
  code: "no_answer",
  message: "the connection to the server was lost meanwhile: try again",
};

const NO_ANSWER: Refusal = {
  code: "no_answer",
  message: "the server does not respond: the page repeats the request when the server is back",
};

function refusal(text: string, status: number): Refusal {
  try {
    const found = JSON.parse(text) as Partial<Refusal>;
    if (typeof found.code === "string" && typeof found.message === "string") {
      return { code: found.code, message: found.message };
    }
  } catch {
    // A proxy's page, not the server's words.
  }
  return { code: "unreadable", message: `the server answered with status ${status}: try again` };
}
