import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Command } from "../model/generated/protocol.ts";
import type { Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { CommandOutbox } from "./command_outbox.ts";

/** The expiry with which a command is sent, by a clock that stands at 1000 ms and a server 500 ms ahead. */
async function expiryOf(command: Command): Promise<number | null> {
  const sent: { readonly expiry: number | null }[] = [];
  const request = (_method: string, _path: string, body: never) => {
    sent.push(body);
    return Promise.resolve({ id: "1", answer: { answer: "applied" } });
  };
  const server = { pulse: signal({ ahead_ms: 500 }), request } as unknown as Server;
  const clock = { now: () => 1000, after: () => () => {} } as unknown as Clock;
  const outbox = new CommandOutbox({
    server,
    clock,
    newId: () => "1",
    path: "/",
    decidedOn: () => 0,
  });
  await outbox.send(command);
  return sent[0]?.expiry ?? null;
}

test("a command is wanted for ten seconds by the server's clock, and a stop whenever it arrives", async () => {
  expect(await expiryOf({ type: "pause" })).toBe(11_500);
  expect(await expiryOf({ type: "stop" })).toBeNull();
  expect(await expiryOf({ type: "kill" })).toBeNull();
});
