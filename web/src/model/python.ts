/** Names that the script of a state uses: ports, outcomes and global variables. The Python grammar finds them, so that comments and
 * other strings with equal words are ignored. */

import type { SyntaxNode } from "@lezer/common";
import { parser } from "@lezer/python";

/** A string literal that names something of the machine. */
export interface ScriptUse {
  readonly of: "input" | "output" | "outcome" | "global";
  readonly name: string;
  /** Position of the literal, including the quotes. */
  readonly from: number;
  readonly to: number;
  /** Access to the value at that position. */
  readonly access: "set" | "read";
}

/** All names in a script, in the order of the text. */
export function scriptUses(script: string): readonly ScriptUse[] {
  const top = parser.parse(script).topNode;
  const reading: Reading = { script, names: argumentNames(script, top), found: [] };
  top.cursor().iterate((at) => {
    if (at.name === "MemberExpression") subscript(at.node, reading);
    else if (at.name === "CallExpression") call(at.node, reading);
    else if (at.name === "BinaryExpression") membership(at.node, reading);
    else if (at.name === "FunctionDefinition") returns(at.node, reading);
  });
  return reading.found.sort((one, other) => one.from - other.from);
}

/** Replaces the name in these literals. Each keeps its kind of quotes. */
export function renameInScript(script: string, uses: readonly ScriptUse[], name: string): string {
  let renamed = script;
  for (const { from, to } of uses.toSorted((one, other) => other.from - one.from)) {
    const quote = script.slice(from, to).endsWith("'") ? "'" : '"';
    renamed = renamed.slice(0, from) + quoted(name, quote) + renamed.slice(to);
  }
  return renamed;
}

/** Line around a position in a text: its number, from 1, and its text. */
export function lineAt(text: string, at: number): { readonly line: number; readonly text: string } {
  const start = text.lastIndexOf("\n", at - 1) + 1;
  const end = text.indexOf("\n", at);
  const line = text.slice(0, start).split("\n").length;
  return { line, text: text.slice(start, end < 0 ? undefined : end).trim() };
}

type NameRole = "input" | "output" | "global";

interface Reading {
  readonly script: string;
  /** Python names of the inputs, outputs and global variables. */
  readonly names: ReadonlyMap<string, NameRole>;
  readonly found: ScriptUse[];
}

const SINGLETON = "global_variable_manager";

/** The usual names, the parameters of `execute`, and aliases of the singleton. */
function argumentNames(script: string, top: SyntaxNode): ReadonlyMap<string, NameRole> {
  const names = new Map<string, NameRole>([
    ["inputs", "input"],
    ["outputs", "output"],
    ["gvm", "global"],
    [SINGLETON, "global"],
  ]);
  for (const statement of childrenOf(top)) {
    if (statement.name === "FunctionDefinition" && isEntry(statement, script)) {
      const roles: readonly NameRole[] = ["input", "output", "global"];
      const given = parameters(statement, script);
      roles.forEach((role, index) => {
        const name = given[index + 1];
        if (name !== undefined) names.set(name, role);
      });
    }
    if (statement.name === "ImportStatement") {
      const alias = new RegExp(`\\b${SINGLETON}\\s+as\\s+(\\w+)`).exec(textOf(statement, script));
      if (alias?.[1]) names.set(alias[1], "global");
    }
  }
  return names;
}

function isEntry(definition: SyntaxNode, script: string): boolean {
  const name = definition.getChild("VariableName");
  return name !== null && /^(backward_)?execute$/.test(textOf(name, script));
}

function parameters(definition: SyntaxNode, script: string): readonly string[] {
  const names: string[] = [];
  let isDefault = false;
  for (const part of childrenOf(definition.getChild("ParamList"))) {
    if (part.name === "VariableName" && !isDefault) names.push(textOf(part, script));
    isDefault = part.name === "AssignOp" || (isDefault && part.name !== ",");
  }
  return names;
}

/** `inputs["speed"]`. */
function subscript(node: SyntaxNode, reading: Reading): void {
  const [owner, bracket, key] = childrenOf(node);
  if (!owner || bracket?.name !== "[" || key?.name !== "String") return;
  const role = roleOf(owner, reading);
  if (role) add(role, key, isTarget(node) ? "set" : "read", reading);
}

/** True if the node is the target of an assignment, or is deleted. */
function isTarget(node: SyntaxNode): boolean {
  const parent = node.parent;
  if (parent?.name === "DeleteStatement") return true;
  if (parent?.name === "TupleExpression") return isTarget(parent);
  if (parent?.name !== "AssignStatement" && parent?.name !== "UpdateStatement") return false;
  const signs = childrenOf(parent).filter(({ name }) => /^(Assign|Update)Op$/.test(name));
  const last = signs.at(-1);
  return last !== undefined && node.to <= last.from;
}

const SETTERS = /^(set_variable|set_locked_variable|delete_variable)$/;
const VARIABLE = /_variable$|^variable_|_locked$|^get_(data_type|representation)$/;
const OF_DICT = /^(get|pop|setdefault)$/;

/** `inputs.get("speed")`, `outputs.update({"found": 1})`, `gvm.set_variable("speed", 1)`. */
function call(node: SyntaxNode, reading: Reading): void {
  const [callee, given] = childrenOf(node);
  const [owner] = childrenOf(callee);
  const method = callee?.getChild("PropertyName");
  if (!owner || !given || !method || callee?.name !== "MemberExpression") return;
  const role = roleOf(owner, reading);
  const name = textOf(method, reading.script);
  if (!role) return;
  if (role !== "global" && name === "update") {
    for (const key of dictionaryKeys(given)) add(role, key, "set", reading);
    return;
  }
  if (!(role === "global" ? VARIABLE : OF_DICT).test(name)) return;
  const key = firstArgument(given, reading.script);
  if (key) add(role, key, SETTERS.test(name) || name === "setdefault" ? "set" : "read", reading);
}

/** The string that is the first argument, or the argument `key`. */
function firstArgument(given: SyntaxNode, script: string): SyntaxNode | undefined {
  const parts = childrenOf(given);
  if (parts[1]?.name === "String") return parts[1];
  const at = parts.findIndex(
    (part) => part.name === "VariableName" && textOf(part, script) === "key",
  );
  const [sign, value] = at < 0 ? [] : parts.slice(at + 1);
  return sign?.name === "AssignOp" && value?.name === "String" ? value : undefined;
}

function dictionaryKeys(given: SyntaxNode): readonly SyntaxNode[] {
  return childrenOf(given.getChild("DictionaryExpression")).filter(
    (part) => part.name === "String" && part.nextSibling?.name === ":",
  );
}

/** `"speed" in inputs`. */
function membership(node: SyntaxNode, reading: Reading): void {
  const key = node.firstChild;
  const owner = node.lastChild;
  if (key?.name !== "String" || !owner || !node.getChild("in")) return;
  const role = roleOf(owner, reading);
  if (role && role !== "global") add(role, key, "read", reading);
}

function roleOf(owner: SyntaxNode, { names, script }: Reading): NameRole | undefined {
  if (owner.name === "VariableName") return names.get(textOf(owner, script));
  const last = owner.name === "MemberExpression" ? owner.lastChild : null;
  return last && textOf(last, script) === SINGLETON ? "global" : undefined;
}

/** `return "success"` of `execute` itself, including variables that it sets to a string. */
function returns(node: SyntaxNode, reading: Reading): void {
  const name = node.getChild("VariableName");
  const isTop = node.parent?.name === "Script";
  if (!isTop || !name || textOf(name, reading.script) !== "execute") return;
  const statements = own(node.getChild("Body"));
  const found = new Map<number, SyntaxNode>();
  const follow = (value: SyntaxNode | null, seen: ReadonlySet<string>) => {
    for (const leaf of leaves(value)) {
      if (leaf.name === "String") found.set(leaf.from, leaf);
      if (leaf.name !== "VariableName") continue;
      const variable = textOf(leaf, reading.script);
      if (seen.has(variable)) continue;
      for (const assigned of assignments(statements, variable, reading.script))
        follow(assigned, new Set([...seen, variable]));
    }
  };
  for (const statement of statements)
    if (statement.name === "ReturnStatement") follow(statement.lastChild, new Set());
  for (const leaf of found.values()) add("outcome", leaf, "set", reading);
}

const NESTED = new Set(["FunctionDefinition", "LambdaExpression", "ClassDefinition"]);

/** All inner nodes except those of nested functions and classes. */
function own(node: SyntaxNode | null): readonly SyntaxNode[] {
  return childrenOf(node).flatMap((child) =>
    NESTED.has(child.name) ? [] : [child, ...own(child)],
  );
}

/** Possible values of an expression. */
function leaves(node: SyntaxNode | null): readonly SyntaxNode[] {
  const parts = childrenOf(node);
  switch (node?.name) {
    case "String":
    case "VariableName":
      return [node];
    case "ParenthesizedExpression":
      return leaves(parts[1] ?? null);
    case "ConditionalExpression":
      return [...leaves(parts[0] ?? null), ...leaves(parts.at(-1) ?? null)];
    case "BinaryExpression":
      return node.getChild("or") || node.getChild("and")
        ? [...leaves(node.firstChild), ...leaves(node.lastChild)]
        : [];
    default:
      return [];
  }
}

/** Values that are assigned to this single variable: `result = "ok"`. */
function assignments(
  statements: readonly SyntaxNode[],
  variable: string,
  script: string,
): readonly SyntaxNode[] {
  return statements.flatMap((statement) => {
    if (statement.name !== "AssignStatement" || statement.getChild(",")) return [];
    const targets = statement.getChildren("VariableName").filter(({ nextSibling }) => nextSibling);
    const isSet = targets.some((target) => textOf(target, script) === variable);
    return isSet && statement.lastChild ? [statement.lastChild] : [];
  });
}

function add(
  of: ScriptUse["of"],
  node: SyntaxNode,
  access: ScriptUse["access"],
  to: Reading,
): void {
  const name = textOfLiteral(textOf(node, to.script));
  if (name !== null) to.found.push({ of, name, from: node.from, to: node.to, access });
}

function childrenOf(node: SyntaxNode | null | undefined): readonly SyntaxNode[] {
  const found: SyntaxNode[] = [];
  for (let child = node?.firstChild; child; child = child.nextSibling) found.push(child);
  return found;
}

function textOf(node: SyntaxNode, script: string): string {
  return script.slice(node.from, node.to);
}

const LITERAL = /^([a-zA-Z]*)("""|'''|"|')([\s\S]*)\2$/;
const ESCAPE = /\\(?:\n|x([\da-fA-F]{2})|u([\da-fA-F]{4})|U([\da-fA-F]{8})|([0-7]{1,3})|([\s\S]))/g;
const NAMED: Record<string, string> = {
  a: "\x07",
  b: "\b",
  f: "\f",
  n: "\n",
  r: "\r",
  t: "\t",
  v: "\v",
};

/** Text of a string literal; null for bytes and other text. */
export function textOfLiteral(literal: string): string | null {
  const [, prefix = "", , inner] = LITERAL.exec(literal) ?? [];
  if (inner === undefined || /b/i.test(prefix)) return null;
  if (/r/i.test(prefix)) return inner;
  return inner.replace(ESCAPE, (whole, x, u, long, octal, letter) => {
    const hex: string | undefined = x ?? u ?? long;
    if (hex !== undefined) return codePoint(Number.parseInt(hex, 16), whole);
    if (octal !== undefined) return codePoint(Number.parseInt(octal, 8), whole);
    if (letter === undefined) return "";
    return NAMED[letter] ?? (/["'\\]/.test(letter) ? letter : whole);
  });
}

function codePoint(code: number, otherwise: string): string {
  return code <= 0x10ffff ? String.fromCodePoint(code) : otherwise;
}

function quoted(text: string, quote: string): string {
  const escaped = text.replace(/[\\\n\r\t]/g, (sign) =>
    sign === "\\" ? "\\\\" : sign === "\n" ? "\\n" : sign === "\r" ? "\\r" : "\\t",
  );
  return quote + escaped.replaceAll(quote, `\\${quote}`) + quote;
}
