import { expect, test } from "vitest";
import { type Follower, RefusalError, type Server } from "../store/page/server.ts";
import { MachineFollower } from "./machine_follower.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { MACHINE } from "./testing/fake_server.ts";

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

test("a machine that was closed while it was asked for is opened again", async () => {
  const asked: string[] = [];
  const followers: Follower[] = [];
  const waiting: ((open: boolean) => void)[] = [];
  const request = (method: string, path: string) => {
    asked.push(`${method} ${path}`);
    if (path === "/machines/open") return Promise.resolve({ ...MACHINE, id: "again" });
    return new Promise((answered, failed) => {
      waiting.push((isOpen) => {
        const gone = new RefusalError({ code: "no_such_machine", message: "closed" }, 404);
        if (isOpen) answered({ revision: 3, document: {} });
        else failed(gone);
      });
    });
  };
  const follow = (follower: Follower) => {
    followers.push(follower);
    return () => {};
  };
  const calls: string[] = [];
  const follower = new MachineFollower(
    MACHINE,
    { request, follow } as unknown as Server,
    new FakeClock(),
    {
      revision: () => 1,
      revisions: () => {},
      status: () => {},
      whole: ({ revision }) => calls.push(`whole ${revision}`),
      gone: (reason) => calls.push(`gone: ${reason}`),
    },
  );
  followers[0]?.frame({ frame: "reset", subscription: 1 } as never);
  const reopened = follower.reopen();
  waiting.shift()?.(false);
  await settle();
  waiting.shift()?.(true);
  expect(await reopened).toBe(true);
  expect(calls).toEqual(["whole 3"]);
  expect(asked).toEqual([
    "GET /machines/m/document",
    "POST /machines/open",
    "GET /machines/again/document",
  ]);
});
