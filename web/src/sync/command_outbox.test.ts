import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Command, LinkHealth } from "../model/generated/protocol.ts";
import type { Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { CommandOutbox, lifetimeOverLink_ms } from "./command_outbox.ts";

/** The expiry with which a command is sent, by a clock that stands at 1000 ms and a server 500 ms ahead. */
async function expiryOf(command: Command, link_ms: number | null = null): Promise<number | null> {
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
    linkLifetime_ms: () => link_ms,
  });
  await outbox.send(command);
  return sent[0]?.expiry ?? null;
}

test("over a link a long command is wanted longer, so that all of it can arrive", () => {
  const link = { lifetime_ms: 22_000, command_bytes_per_s: 100 } as LinkHealth;
  expect(lifetimeOverLink_ms(link, 5_000, 0)).toBe(122_000);
  expect(lifetimeOverLink_ms({ ...link, command_bytes_per_s: null }, 5_000, 0)).toBe(22_000);
  expect(lifetimeOverLink_ms({ ...link, lifetime_ms: null }, 5_000, 0)).toBeNull();
});

test("outside of planned contacts a lifetime counts from the begin of the next one", () => {
  const contact = { begin_ms: 100_000, end_ms: 200_000, profile: "deep" };
  const link = { lifetime_ms: 22_000, command_bytes_per_s: null, contact } as LinkHealth;
  expect(lifetimeOverLink_ms(link, 0, 40_000)).toBe(82_024);
  expect(lifetimeOverLink_ms(link, 0, 150_000)).toBe(22_000);
});

test("over a link a command is wanted as long as the station says", async () => {
  expect(await expiryOf({ type: "pause" }, 42_000)).toBe(43_500);
  expect(await expiryOf({ type: "stop" }, 42_000)).toBeNull();
});

test("an unknown fate is asked for until it is known", async () => {
  const answers = ["unknown", "unknown", "applied"];
  const asked: number[] = [];
  let now_ms = 1_000;
  const request = async () => {
    asked.push(now_ms);
    return { id: "1", answer: answers.shift(), reason: "the robot is silent" };
  };
  const server = { pulse: signal({ ahead_ms: 0 }), request } as unknown as Server;
  const after = (pause_ms: number, then: () => void) => {
    now_ms += pause_ms;
    queueMicrotask(then);
    return () => {};
  };
  const clock = { now: () => now_ms, after } as unknown as Clock;
  const ports = { server, clock, newId: () => "1", path: "/", decidedOn: () => 0 };
  const sent = await new CommandOutbox(ports).send({ type: "pause" });
  expect(sent.answer).toEqual({ answer: "applied", reason: "the robot is silent" });
  expect(asked).toEqual([1_000, 6_000, 11_000]);
});

test("a command is wanted for ten seconds by the server's clock, and a stop whenever it arrives", async () => {
  expect(await expiryOf({ type: "pause" })).toBe(11_500);
  expect(await expiryOf({ type: "stop" })).toBeNull();
  expect(await expiryOf({ type: "kill" })).toBeNull();
});
