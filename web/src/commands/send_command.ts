/** The way of a command from the user to the run in front. What became of it is shown over the canvas, and kept in the
 * log if it is not what was wanted. */

import type { Command as RunCommand } from "../model/generated/protocol.ts";
import type { SentCommand, Watch } from "../store/history/run.ts";
import type { CommandContext } from "./command.ts";

/** Gives the run in front a command; true once it was carried out. */
export async function sendCommand(
  context: CommandContext,
  title: string,
  runCommand: RunCommand,
): Promise<boolean> {
  const watch = context.tab?.run.peek();
  return watch ? sendCommandTo(context, watch, title, runCommand) : false;
}

export async function sendCommandTo(
  { page }: CommandContext,
  watch: Watch,
  title: string,
  runCommand: RunCommand,
): Promise<boolean> {
  const why = failureOf(await watch.command(runCommand));
  if (why !== null) page.tell({ level: "warning", text: `${title}: ${why}`, isQuiet: true });
  return why === null;
}

/** Reason why a command was not carried out; null if it was. */
export function failureOf({ answer }: SentCommand): string | null {
  switch (answer?.answer) {
    case "applied":
      return null;
    case "refused":
      return answer.reason;
    case "expired":
      return "it expired and was not carried out: it did not reach the runner in time";
    default:
      return `it is unknown whether it was carried out: ${answer?.reason ?? "there was no answer"}`;
  }
}
