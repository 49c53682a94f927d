import { expect, test } from "vitest";
import { lineAt, renameInScript, scriptUses, textOfLiteral } from "./python.ts";

function uses(script: string): readonly string[] {
  return scriptUses(script).map(({ of, name, access }) => `${access} ${of} ${name}`);
}

test("ports are found by subscript, get, in and update", () => {
  const script = `
def execute(self, inputs, outputs, gvm):
    speed = inputs["speed"] * inputs.get('factor', 1)
    if "goal" in inputs and inputs:
        outputs["way"], rest = plan(f"{inputs['goal']}")
    outputs["count"] += 1
    outputs.update({"left": speed, "right": {"deep": 1}})
    del outputs["old"]
    # inputs["not this"]
    print('outputs["nor this"]', other["nor that"])
`;
  expect(uses(script)).toEqual([
    "read input speed",
    "read input factor",
    "read input goal",
    "set output way",
    "read input goal",
    "set output count",
    "set output left",
    "set output right",
    "set output old",
  ]);
});

test("arguments of execute may have other names", () => {
  const script = `
def execute(self, i, o: dict, variables=None):
    o["x"] = i["y"]
    variables.set_variable("z", 1)
`;
  expect(uses(script)).toEqual(["set output x", "read input y", "set global z"]);
});

test("outcomes are what execute itself returns", () => {
  const script = `
def helper():
    return "no outcome"

def execute(self, inputs, outputs, gvm):
    def inner():
        return "nor this"
    result = "lost"
    if inner():
        result = again = ("found" if inputs["x"] else 'seen')
    elif self.preempted:
        return "preempted"
    elif helper():
        return 0
    return result or "aborted"

def backward_execute(self, inputs, outputs, gvm):
    return "not looked at"
`;
  expect(uses(script).filter((use) => use.includes("outcome"))).toEqual([
    "set outcome lost",
    "set outcome found",
    "set outcome seen",
    "set outcome preempted",
    "set outcome aborted",
  ]);
});

test("global variables are found by every way to them", () => {
  const script = `
from rafcon.core.singleton import global_variable_manager as variables
import rafcon.core.singleton as singletons

def execute(self, inputs, outputs, gvm):
    gvm.set_variable("basket", 0, data_type=int)
    gvm.set_variable(value=1, key="by key")
    n = gvm.get_variable('basket') + variables.get_variable("other")
    singletons.global_variable_manager.delete_variable("gone")
    if gvm.variable_exist("maybe") or gvm.is_locked("maybe"):
        key = gvm.lock_variable(n)
    gvm.something_else("not a variable")
`;
  expect(uses(script)).toEqual([
    "set global basket",
    "set global by key",
    "read global basket",
    "read global other",
    "set global gone",
    "read global maybe",
    "read global maybe",
  ]);
});

test("a variable that is set to itself is followed once", () => {
  const script = `
def execute(self, inputs, outputs, gvm):
    one = two
    two = one
    return one
`;
  expect(uses(script)).toEqual([]);
});

test("a name is changed where it is used and nowhere else", () => {
  const script = `
def execute(self, inputs, outputs, gvm):
    # "speed" is in m/s
    speed = inputs["speed"] if 'speed' in inputs else 0
    return "speed"
`;
  const found = scriptUses(script).filter(({ of, name }) => of === "input" && name === "speed");
  expect(renameInScript(script, found, 'the "v"')).toBe(`
def execute(self, inputs, outputs, gvm):
    # "speed" is in m/s
    speed = inputs["the \\"v\\""] if 'the "v"' in inputs else 0
    return "speed"
`);
  expect(lineAt(script, found[1]?.from ?? 0)).toEqual({
    line: 4,
    text: "speed = inputs[\"speed\"] if 'speed' in inputs else 0",
  });
});

test("what was renamed is found by its new name", () => {
  const script = `def execute(self, inputs, outputs, gvm):\n    inputs["a"], inputs['a']\n`;
  for (const name of ["b", "it's", 'a "b"', "back\\slash", "two\nlines", "ü😀"]) {
    const renamed = renameInScript(script, scriptUses(script), name);
    expect(scriptUses(renamed).map((use) => use.name)).toEqual([name, name]);
  }
});

test("a script with a mistake is read around it", () => {
  const script = `
def execute(self, inputs, outputs, gvm):
    if = inputs["a"]
    return "ok"
`;
  expect(uses(script)).toContain("read input a");
});

test("literals are read as Python reads them", () => {
  expect(textOfLiteral('"a\\tb\\x41\\u00e4\\101\\""')).toBe('a\tbA\u00e4A"');
  expect(textOfLiteral("r'a\\t'")).toBe("a\\t");
  expect(textOfLiteral('"""long"""')).toBe("long");
  expect(textOfLiteral("'\\q'")).toBe("\\q");
  expect(textOfLiteral("b'bytes'")).toBeNull();
});
