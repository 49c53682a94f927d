import fc from "fast-check";
import { expect, test } from "vitest";
import { RefusalError } from "../store/page/server.ts";
import { AGAIN, HELD, Outbox } from "./outbox.ts";
import { FakeClock } from "./testing/fake_clock.ts";

interface Item {
  readonly id: string;
  /** Goes by a request instead of a frame. */
  readonly isAsked: boolean;
  readonly isAlone: boolean;
}

interface Asked {
  readonly answer: (made: number) => void;
  readonly refuse: (status: number) => void;
}

/** An outbox over a network that a test plays: what it sends, and what each item came to, are kept. */
class Played {
  readonly clock = new FakeClock();
  readonly fates = new Map<string, string[]>();
  readonly held = new Set<string>();
  readonly asked = new Map<string, Asked>();
  isUp = true;
  readonly #isStep: boolean;
  readonly outbox: Outbox<Item, number, string>;

  /** `isStep`: an answer only holds an item, as that of an edit whose revision is not here. */
  constructor(isStep: boolean) {
    this.#isStep = isStep;
    this.outbox = new Outbox<Item, number, string>({
      clock: this.clock,
      isUp: () => this.isUp,
      isAlone: ({ isAlone }) => isAlone,
      send: (item) => this.#send(item),
      onAnswer: ({ id }, made) => {
        if (!this.#isStep) return `made ${made}`;
        this.held.add(id);
        return HELD;
      },
      onRefusal: (_, { status }) => (status === 503 ? AGAIN : `refused ${status}`),
    });
  }

  put(item: Item): void {
    this.fates.set(item.id, []);
    void this.outbox.put(item).then((fate) => this.fates.get(item.id)?.push(fate));
  }

  #send({ id, isAsked, isAlone }: Item): Promise<number> | null {
    const before = this.outbox.items.slice(
      0,
      this.outbox.items.findIndex((item) => item.id === id),
    );
    const open = before.filter((item) => !this.held.has(item.id));
    expect(this.isUp, "sent while the connection is down").toBe(true);
    expect(this.outbox.has(id) && !this.held.has(id), "sent after its answer").toBe(true);
    expect(isAlone && open.length > 0, "sent beside others").toBe(false);
    expect(
      open.some((item) => item.isAlone),
      "sent before what goes alone",
    ).toBe(false);
    expect(this.asked.has(id), "asked for twice at once").toBe(false);
    if (!isAsked) return null;
    return new Promise((answered, failed) => {
      const over = (act: () => void) => {
        this.asked.delete(id);
        act();
      };
      this.asked.set(id, {
        answer: (made) => over(() => answered(made)),
        refuse: (status) =>
          over(() => failed(new RefusalError({ code: "no", message: "no" }, status))),
      });
    });
  }
}

const step = fc.record({
  what: fc.constantFrom(
    "put",
    "put",
    "put asked",
    "put alone",
    "answer",
    "answer twice",
    "refuse",
    "later",
    "settle",
    "arrive",
    "down",
    "up",
    "pass",
  ),
  which: fc.nat(9),
});

async function settle(): Promise<void> {
  for (let turn = 0; turn < 5; turn += 1) await Promise.resolve();
}

function act(played: Played, what: string, which: number, id: string): void {
  const { outbox, asked } = played;
  const item = outbox.items[which % Math.max(1, outbox.items.length)];
  if (what.startsWith("put")) {
    const isAlone = what === "put alone";
    played.put({ id, isAlone, isAsked: isAlone || what === "put asked" });
  } else if (what === "down") played.isUp = false;
  else if (what === "up") {
    played.isUp = true;
    outbox.connected();
  } else if (what === "pass") played.clock.pass(300);
  else if (item) answer(played, what, item, asked.get(item.id));
}

function answer({ outbox, held }: Played, what: string, { id }: Item, asked?: Asked): void {
  if (what === "settle") outbox.settle(id, "seen in the history");
  else if (what === "arrive" && held.has(id)) outbox.settle(id, "arrived");
  else if (what === "answer" && asked) asked.answer(1);
  else if (what === "refuse" && asked) asked.refuse(409);
  else if (what === "later" && asked) asked.refuse(503);
  else if (what === "answer" || what === "answer twice") {
    outbox.answered(id, 1);
    if (what === "answer twice") outbox.answered(id, 2);
  } else if (what === "refuse") outbox.refused(id, refusal(409));
  else if (what === "later") outbox.refused(id, refusal(503));
}

function refusal(status: number): RefusalError {
  return new RefusalError({ code: "no", message: "no" }, status);
}

test("whatever is sent, answered, refused, lost and connected in which order, each is settled once", async () => {
  const check = async (
    isStep: boolean,
    steps: readonly { readonly what: string; readonly which: number }[],
  ) => {
    const played = new Played(isStep);
    for (const [index, { what, which }] of steps.entries()) {
      act(played, what, which, `${index}`);
      await settle();
    }
    played.isUp = true;
    played.outbox.connected();
    for (let turn = 0; turn < 200 && played.outbox.items.length > 0; turn += 1) {
      played.clock.pass(500);
      const [first] = played.outbox.items;
      if (first) act(played, played.held.has(first.id) ? "arrive" : "answer", 0, "");
      await settle();
    }
    expect(played.outbox.items).toEqual([]);
    for (const [id, fates] of played.fates) expect(fates, id).toHaveLength(1);
  };
  const steps = fc.array(step, { maxLength: 40 });
  await fc.assert(fc.asyncProperty(fc.boolean(), steps, check), { numRuns: 500 });
});

test("what is sent without an answer goes again over the next connection, in its order", () => {
  const sent: string[] = [];
  const outbox = new Outbox<{ readonly id: string }, number, string>({
    clock: new FakeClock(),
    send: ({ id }) => {
      sent.push(id);
      return null;
    },
    onAnswer: () => "made",
    onRefusal: () => "refused",
  });
  for (const id of ["1", "2", "3"]) void outbox.put({ id });
  outbox.answered("2", 1);
  outbox.connected();
  expect(sent).toEqual(["1", "2", "3", "1", "3"]);
});
