/** Recent commands of this page to the run: pending until the robot responds, then with the response. */

import { Check, Clock, Send, X } from "lucide-react";
import { commandInWords } from "../../model/command_words.ts";
import { dismiss, dismissed } from "../../store/history/dismissed.ts";
import { answeredBy, askedQuestions } from "../../store/history/questions.ts";
import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { withStateNames } from "../../store/page/names.ts";
import { IconButton } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { type CommandOnTheWay, type SentLine, sentLines } from "../parts/sent.ts";

export function SentList({ watch }: { readonly watch: Watch }) {
  const sent = useSignal(watch.sent);
  const seen = useSignal(dismissed(watch));
  useSignal(askedQuestions(watch));
  useSignal(watch.now);
  const now_ms = useComputed(() => (watch.sent.value.length > 0 ? clock1s.value : 0), [watch]);
  return (
    <ul className="mission-sent" aria-label="Commands you sent" aria-live="polite">
      {sentLines(
        sent,
        seen,
        now_ms,
        (question) => answeredBy(watch, question),
        (id) => openCommand(watch, id),
      )
        .filter((line) => !isShownElsewhere(line))
        .map((line) => (
          <Line key={line.id} line={line} onClose={() => dismiss(watch, line.id)} />
        ))}
    </ul>
  );
}

/** Pending command at the station, for a remote robot. Its id there has the user's name as a prefix. */
function openCommand(watch: Watch, id: string): CommandOnTheWay | null {
  const robot = watch.now.value?.robot;
  const open = robot?.commands.find((command) => command.id.endsWith(`/${id}`));
  return robot && open ? { ...open, isRobotHeard: robot.is_heard } : null;
}

const SIGNS = { sent: Send, applied: Check, refused: X, expired: Clock, lost: X };

/** True for pending and applied responses to a question, which are shown with the question. */
function isShownElsewhere({ command, kind }: SentLine): boolean {
  return command.type === "answer_question" && (kind === "sent" || kind === "applied");
}

/** Names of commands that differ on the buttons here. */
const BUTTONS: Readonly<Record<string, string>> = { step_over: "Step" };

function Line({ line, onClose }: { readonly line: SentLine; readonly onClose: () => void }) {
  const { command, kind, words } = line;
  const Icon = SIGNS[kind];
  const { page } = useHost().context();
  const title = BUTTONS[command.type] ?? commandInWords(command);
  return (
    <li className={`mission-sent-${kind}`}>
      <Icon size={16} aria-hidden />
      <span>
        <strong>{title}</strong> {withStateNames(page.tabs.peek(), page.active.peek(), words)}
      </span>
      {kind !== "sent" && kind !== "applied" && (
        <IconButton label="Close" icon={<X size={16} />} onClick={onClose} />
      )}
    </li>
  );
}
