// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { act } from "react";
import { afterEach, expect, test } from "vitest";
import type { MachineProblem } from "../../model/generated/protocol.ts";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Problems } from "./problems.tsx";

afterEach(unmount);

test("before a machine was checked nothing is said to be without problems", () => {
  const isChecked = signal(false);
  const problems = signal<readonly MachineProblem[]>([]);
  const place = shown(<Problems />, { session: { isChecked, problems } });
  expect(place.textContent).toBe("Checking…Rules, files and scripts are being checked.");
  act(() => {
    isChecked.value = true;
  });
  expect(place.textContent).toMatch(/^No problems/);
});
