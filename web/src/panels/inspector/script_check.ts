/** Asks the server what Python's parser says of a script, and whether the script fits its state. */

import type { CheckScript, ScriptPlace, ScriptProblem } from "../../model/generated/protocol.ts";
import type { Page } from "../../store/page/page.ts";

/** If the server cannot say, that is told as a note on the first line. */
export function checkScript(
  page: Page,
  state: ScriptPlace | null,
): (script: string) => Promise<readonly ScriptProblem[]> {
  return async (script) => {
    if (page.server.link.peek().state !== "up") return [];
    const body: CheckScript = { script, state };
    try {
      return await page.server.request<readonly ScriptProblem[]>("POST", "/python/check", body);
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      const message = `The script could not be checked: ${reason}`;
      return [{ line: 1, column: 1, message, severity: "note" }];
    }
  };
}
