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
  const found = readTraceback(chain);
  expect(found?.own?.line).toBe(9);
  expect(found?.message).toBe("KeyError: 'a'");
  expect(readTraceback("0 of 5 parts are in the box")).toBeNull();
});

test("the errors that led to the last one, the nearest first", () => {
  const part = (line: number, error: string) =>
    `Traceback (most recent call last):\n  File "/a/script.py", line ${line}, in execute\n    x\n${error}`;
  const link = "\n\nThe above exception was the direct cause of the following exception:\n\n";
  const found = readTraceback(
    [part(1, "OSError: gone"), part(2, "E: b"), part(3, "F: c")].join(link),
  );
  expect(found?.message).toBe("F: c");
  const causes = found?.causes.map(({ message, own }) => `${own?.line} ${message}`);
  expect(causes).toEqual(["2 E: b", "1 OSError: gone"]);
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
