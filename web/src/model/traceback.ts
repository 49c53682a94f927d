/** Parses Python tracebacks: their frames and their error. */

export interface TracebackFrame {
  readonly file: string;
  readonly line: number;
  readonly function: string;
  /** Source line; empty if the traceback omits it. */
  readonly code: string;
}

export interface Traceback {
  readonly frames: readonly TracebackFrame[];
  /** Frame of the script that is nearest to the error; null without frames. */
  readonly own: TracebackFrame | null;
  /** `ValueError: no`. */
  readonly message: string;
  /** Errors that led to it, the nearest first. */
  readonly causes: readonly Traceback[];
}

const FRAME = /^ {2}File "(.*)", line (\d+), in (.*)$/;

const BEGIN = "Traceback (most recent call last)";
/** Text of Python between two errors of a chain. */
const LINK = /^(The above exception was the direct cause|During handling of the above exception)/;

/** Parses a traceback; null if the text is not one. For a chain of errors, returns the last one with its causes. */
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
  const messageLines = lines.slice(at, link < 0 ? lines.length : link).map(withoutModule);
  return { frames, own, message: messageLines.join("\n").trimEnd(), causes: [] };
}

/** An error line without the module name of a script: `NoPath: none` for `script160.NoPath: none`. */
export function withoutModule(line: string): string {
  return line.replace(/^script\d+\.(?=[^\s.:]+(?::|$))/, "");
}

function frameOf(found: RegExpExecArray, next: string): TracebackFrame {
  const [, file = "", line = "0", name = ""] = found;
  const isCode = next.startsWith("    ") && !/^ +[~^]+$/.test(next);
  return { file, line: Number(line), function: name, code: isCode ? next.trim() : "" };
}
