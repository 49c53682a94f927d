import { Text } from "@codemirror/state";
import { expect, test } from "vitest";
import type { ScriptProblem } from "../../../model/generated/protocol.ts";
import { diagnostics } from "./check.ts";

const TEXT = Text.of(["def execute(self):", "    retrun 1", ""]);

function marked(problem: Partial<ScriptProblem>): string {
  const full = { line: 1, column: 1, message: "wrong", severity: "error", ...problem } as const;
  return diagnostics(TEXT, [full], () => {})
    .map(({ from, to, severity }) => `${severity} ${JSON.stringify(TEXT.sliceString(from, to))}`)
    .join();
}

test("a problem is marked where the parser says", () => {
  expect(marked({ line: 2, column: 5, end_line: 2, end_column: 11 })).toBe('error "retrun"');
  expect(marked({ line: 2, column: 12, severity: "note" })).toBe('info "1"');
  expect(marked({ line: 1, column: 5, end_line: 2, end_column: 5 })).toBe(
    'error "execute(self):\\n    "',
  );
});

test("a problem outside of the text is marked at its end", () => {
  expect(marked({ line: 9, column: 9 })).toBe('error "\\n"');
  expect(marked({ line: 2, column: 99, end_line: 2, end_column: 1 })).toBe('error "\\n"');
  expect(
    diagnostics(Text.empty, [{ line: 1, column: 1, message: "", severity: "error" }], () => {}),
  ).toMatchObject([{ from: 0, to: 0 }]);
});

test("an edit that mends a problem is a button at its place", () => {
  const edit = { edit: "add_outcome", path: "R/A", outcome: 1, name: "nope" } as const;
  const repair = { name: 'Add the outcome "nope"', edit };
  const problem = { line: 2, column: 1, message: "", severity: "error" } as const;
  const made: string[] = [];
  const marks = diagnostics(TEXT, [{ ...problem, repairs: [repair] }], ({ name }) => {
    made.push(name);
  });
  marks[0]?.actions?.[0]?.apply(null as never, 0, 0);
  expect(made).toEqual([repair.name]);
});
