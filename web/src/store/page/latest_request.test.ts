import { expect, test } from "vitest";
import { LatestRequest } from "./latest_request.ts";
import { RefusalError } from "./server.ts";

interface Given {
  readonly keepsEarlier?: boolean;
}

/** Carries out steps, and returns what happened. `want A`, `answer 1`, `refuse 503`, `wait`, `drop`, `close`. */
async function check(steps: readonly string[], { keepsEarlier = false }: Given = {}) {
  const happened: string[] = [];
  const waiting = new Set<() => void>();
  const asked: { answer: (value: string) => void; refuse: (error: Error) => void }[] = [];
  const request = new LatestRequest<string, string>({
    ask: (wish) => {
      happened.push(`ask ${wish}`);
      return new Promise((answer, refuse) => {
        asked.push({ answer, refuse });
      });
    },
    take: (answer, wish) => happened.push(`${wish}: ${answer}`),
    ...(keepsEarlier
      ? { takeEarlier: (answer, wish) => happened.push(`old ${wish}: ${answer}`) }
      : {}),
    refused: ({ status }, wish) => happened.push(`${wish} refused ${status}`),
    after: (_, call) => {
      waiting.add(call);
      return () => void waiting.delete(call);
    },
  });
  for (const step of steps) {
    const [verb, word = ""] = step.split(" ");
    if (verb === "want") request.want(word);
    else if (verb === "answer") asked.at(-1)?.answer(word);
    else if (verb === "refuse")
      asked.at(-1)?.refuse(new RefusalError({ code: "no", message: "no" }, Number(word)));
    else if (verb === "wait") for (const call of waiting) call();
    else if (verb === "drop") request.drop();
    else request.close();
    for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
  }
  return `${happened.join(", ")}${request.isPending ? " …" : ""}`;
}

test("one request at a time is sent, and the newest wish is the next", async () => {
  expect(await check(["want A", "want B", "want C"])).toBe("ask A …");
  expect(await check(["want A", "want B", "want C", "answer 1", "answer 3"])).toBe(
    "ask A, ask C, C: 3",
  );
  expect(await check(["want A", "want A", "answer 1"])).toBe("ask A, A: 1");
});

test("the answer to an earlier wish is dropped, or received apart", async () => {
  const steps = ["want A", "want B", "answer 1"];
  expect(await check(steps, { keepsEarlier: true })).toBe("ask A, old A: 1, ask B …");
  expect(await check(["want A", "drop", "answer 1"])).toBe("ask A");
});

test("a refusal for now is repeated, another one ends the wish", async () => {
  expect(await check(["want A", "refuse 503"])).toBe("ask A, A refused 503 …");
  expect(await check(["want A", "refuse 503", "wait", "answer 1"])).toBe(
    "ask A, A refused 503, ask A, A: 1",
  );
  expect(await check(["want A", "refuse 404", "wait"])).toBe("ask A, A refused 404");
});

test("after a refusal the next request waits, whatever it is for", async () => {
  expect(await check(["want A", "refuse 503", "want B"])).toBe("ask A, A refused 503 …");
  expect(await check(["want A", "refuse 404", "want B", "wait", "answer 2"])).toBe(
    "ask A, A refused 404, ask B, B: 2",
  );
  expect(await check(["want A", "refuse 503", "drop", "wait"])).toBe("ask A, A refused 503");
});

test("after the end nothing is sent or received", async () => {
  expect(await check(["want A", "close", "answer 1", "want B"])).toBe("ask A");
  expect(await check(["want A", "refuse 503", "close", "wait"])).toBe("ask A, A refused 503");
});
