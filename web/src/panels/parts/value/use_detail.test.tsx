// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import type { Runs } from "../../../store/history/run.ts";
import { draw, mount, settled, unmount } from "../../../ui/testing/mounted.tsx";
import { useDetail } from "./use_detail.ts";

afterEach(unmount);

/** A server whose answers come when they are let go. */
function server() {
  const answers = new Map<string, (detail: object) => void>();
  const get = (_: string, what: string) =>
    new Promise((resolve) => answers.set(what.replace("events/", ""), resolve));
  const runs = { get } as unknown as Runs;
  const answer = async (sequence: number) => {
    answers.get(String(sequence))?.({ sequence });
    await settled();
  };
  return { runs, answer };
}

function Shown({ runs, run, sequence }: { runs: Runs; run: string; sequence: number }) {
  return <output>{useDetail(runs, run, sequence).detail?.sequence ?? "none"}</output>;
}

test("values that change faster than they are told are told all the same", async () => {
  const { runs, answer } = server();
  const place = mount(<Shown runs={runs} run="fast" sequence={1} />);
  draw(<Shown runs={runs} run="fast" sequence={2} />);
  draw(<Shown runs={runs} run="fast" sequence={3} />);
  await answer(1);
  expect(place.textContent).toBe("1");
  await answer(2);
  expect(place.textContent).toBe("2");
});

test("an answer that comes too late takes nothing back", async () => {
  const { runs, answer } = server();
  const place = mount(<Shown runs={runs} run="late" sequence={1} />);
  draw(<Shown runs={runs} run="late" sequence={2} />);
  await answer(2);
  await answer(1);
  expect(place.textContent).toBe("2");
});
