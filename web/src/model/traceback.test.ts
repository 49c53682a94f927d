import { expect, test } from "vitest";
import { readTraceback, withoutModule } from "./traceback.ts";

const TEXT = `Traceback (most recent call last):
  File "/machines/arm/script.py", line 7, in execute
    move(inputs["goal"])
    ~~~~^^^^^^^^^^^^^^^^
  File "/machines/arm/script.py", line 3, in move
    json.loads(goal)
  File "/usr/lib/python3/json/__init__.py", line 346, in loads
    return _default_decoder.decode(s)
json.decoder.JSONDecodeError: Expecting value: line 1`;

test("the script's own frame that is nearest to the error", () => {
  const found = readTraceback(TEXT);
  expect(found?.frames.map(({ line }) => line)).toEqual([7, 3, 346]);
  expect(found?.own).toEqual({
    file: "/machines/arm/script.py",
    line: 3,
    function: "move",
    code: "json.loads(goal)",
  });
  expect(found?.message).toBe("json.decoder.JSONDecodeError: Expecting value: line 1");
});

test("of a chain the last one; another text is none", () => {
  const chain = `${TEXT}\n\nDuring handling of the above exception, another exception occurred:\n\nTraceback (most recent call last):\n  File "/a/script.py", line 9, in execute\n    x\nKeyError: 'a'`;
  expect(readTraceback(chain)?.own?.line).toBe(9);
  expect(readTraceback("0 of 5 parts are in the box")).toBeNull();
});

test("the name of a script's module is no part of what its error says", () => {
  const lines = [
    "script160.NoPath: no way",
    "script7.Done",
    "script7.py is gone: no",
    "KeyError: 'script1.x'",
  ];
  expect(lines.map(withoutModule)).toEqual([
    "NoPath: no way",
    "Done",
    "script7.py is gone: no",
    "KeyError: 'script1.x'",
  ]);
});
