/** A traceback of Python, read: its frames and what was raised. */

export interface TracebackFrame {
  readonly file: string;
  readonly line: number;
  readonly function: string;
  /** The line itself, if it was told. */
  readonly code: string;
}

export interface Traceback {
  readonly frames: readonly TracebackFrame[];
  /** The frame of the script that is nearest to the error; null without frames. */
  readonly own: TracebackFrame | null;
  /** `ValueError: no`. */
  readonly message: string;
  /** The errors that led to it, the nearest first. */
  readonly causes: readonly Traceback[];
}

const FRAME = /^ {2}File "(.*)", line (\d+), in (.*)$/;

const BEGIN = "Traceback (most recent call last)";
/** What Python writes between two errors of a chain. */
const LINK = /^(The above exception was the direct cause|During handling of the above exception)/;

/** What a text says that is a traceback; null if it is none. Of a chain of errors, the last with those that led to it. */
export function readTraceback(text: string): Traceback | null {
  const lines = text.split("\n");
  const begins = lines.flatMap((line, index) => (line.startsWith(BEGIN) ? [index] : []));
  const parts = begins.map((begin, index) => readPart(lines.slice(begin, begins[index + 1])));
  const [last, ...causes] = parts.reverse();
  return last ? { ...last, causes } : null;
}

function readPart(lines: readonly string[]): Traceback {
  const frames: TracebackFrame[] = [];
  let at = 1;
  for (; at < lines.length; at += 1) {
    const line = lines[at] ?? "";
    const found = FRAME.exec(line);
    if (found) frames.push(frameOf(found, lines[at + 1] ?? ""));
    else if (line !== "" && !line.startsWith(" ")) break;
  }
  const script = frames[0]?.file;
  const own = frames.findLast(({ file }) => file === script) ?? null;
  const link = lines.findIndex((line) => LINK.test(line));
  const said = lines.slice(at, link < 0 ? lines.length : link).map(withoutModule);
  return { frames, own, message: said.join("\n").trimEnd(), causes: [] };
}

/** A line that tells an error, without the name that the module of a script happens to have: `NoPath: none` of
 * `script160.NoPath: none`. */
export function withoutModule(line: string): string {
  return line.replace(/^script\d+\.(?=[^\s.:]+(?::|$))/, "");
}

function frameOf(found: RegExpExecArray, next: string): TracebackFrame {
  const [, file = "", line = "0", name = ""] = found;
  const isCode = next.startsWith("    ") && !/^ +[~^]+$/.test(next);
  return { file, line: Number(line), function: name, code: isCode ? next.trim() : "" };
}
