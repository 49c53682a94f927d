/** Restores the machine as of a step. Asks for confirmation if that undoes steps of other users. */

import type { OpenTab } from "../../store/page/page.ts";
import type { PanelHost } from "../context.tsx";

export async function jumpTo(host: PanelHost, tab: OpenTab, revision: number): Promise<void> {
  const { page, shell } = host.context();
  const answer = await tab.session.jump(revision, false);
  if (!("refused" in answer)) return;
  if (answer.code !== "others_edits") {
    page.tell({ level: "warning", text: `Could not go to that step: ${answer.refused}` });
    return;
  }
  const yes = await shell.confirm({
    title: "Undo steps of other users?",
    text: `${capital(whatGoes(answer.refused))}. You can undo this afterwards.`,
    yes: "Go there anyway",
    no: "Cancel",
    danger: true,
  });
  if (!yes) return;
  const again = await tab.session.jump(revision, true);
  if ("refused" in again) {
    page.tell({ level: "warning", text: `Could not go to that step: ${again.refused}` });
  }
}

/** Such as `this reverts 1 step of anna`: the refusal without its hint for programs. */
function whatGoes(refusal: string): string {
  return refusal.split(":")[0] ?? refusal;
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
