/** Requests below `/api/v1`: what they are answered, or why they were refused. */

import type { Refusal } from "../model/generated/protocol.ts";
import { RefusalError, type Server } from "../store/server.ts";

/** Where the server is, and by what it lets in. In its own page both are empty: the cookie goes along. */
export interface Address {
  /** `http://127.0.0.1:4747`, or nothing for the page's own server. */
  readonly url: string;
  readonly token?: string;
}

/** Who is told of each answer's status; 0 if there was none. */
export type Heard = (method: string, path: string, status: number) => void;

/** Asks the server. */
export function requests(address: Address, heard: Heard): Server["request"] {
  const headers: Record<string, string> = { "Content-Type": "application/json" };
  if (address.token) headers["Authorization"] = `Bearer ${address.token}`;
  return async <T>(method: string, path: string, body?: unknown): Promise<T> => {
    const sent = body === undefined ? {} : { body: JSON.stringify(body) };
    let answer: Response;
    try {
      answer = await fetch(`${address.url}/api/v1${path}`, { method, headers, ...sent });
    } catch {
      heard(method, path, 0);
      throw new RefusalError(NO_ANSWER, 0);
    }
    heard(method, path, answer.status);
    const text = await answer.text();
    if (!answer.ok) throw new RefusalError(refusal(text, answer.status), answer.status);
    return (text === "" ? null : JSON.parse(text)) as T;
  };
}

const NO_ANSWER: Refusal = {
  code: "no_answer",
  message: "the server does not answer: it is asked again once it is there",
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
  return { code: "unreadable", message: `the server answered with status ${status}: try it again` };
}
