/** Starts the page. */

import "@fontsource-variable/inter";
import "@fontsource-variable/jetbrains-mono";
import "../ui/tokens.css";
import { createRoot } from "react-dom/client";
import { allCommands } from "../commands/all.ts";
import { startPage } from "../sync/page.ts";
import { keepCompositions } from "../ui/composition.ts";
import { undoTranslations } from "../ui/translation.ts";
import { App } from "./app.tsx";
import { reportErrors, reportTranslation } from "./report_errors.ts";
import { newSession } from "./session.ts";
import { applyTheme } from "./theme.ts";
import { keepTitle } from "./title.ts";

const place = document.getElementById("app");
if (place) {
  const page = startPage();
  const session = newSession(page, allCommands());
  reportErrors(page, window);
  keepCompositions(window);
  undoTranslations(document, () => reportTranslation(page));
  applyTheme(page, window);
  keepTitle(page, document);
  const { commands, context } = session;
  // Tests and benches that inspect the page set a mark before its start.
  if ("__rafcon" in window) Object.assign(window, { __rafcon: { page, commands, context } });
  createRoot(place).render(<App session={session} />);
}
