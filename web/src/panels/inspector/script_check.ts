/** Requests the syntax check of a script from the server, and the check against its state. */

import type { CheckScript, ScriptPlace, ScriptProblem } from "../../model/generated/protocol.ts";
import type { Page } from "../../store/page/page.ts";

/** Returns the problems of a script. If the check fails, the first line has a note. */
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
