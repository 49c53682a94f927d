/** Commands of this page: pending ones, and for a while their fates. Nothing counts as done before the robot has confirmed it. */

import { Check, CircleHelp, Hourglass, Send, TriangleAlert, X } from "lucide-react";
import { type ReactNode, useEffect, useState } from "react";
import { commandInWords } from "../model/command_words.ts";
import { sentLines } from "../panels/parts/sent.ts";
import { dismiss, dismissed } from "../store/history/dismissed.ts";
import { answeredBy, askedQuestions } from "../store/history/questions.ts";
import type { SentCommand, Watch } from "../store/history/run.ts";
import { withStateNames } from "../store/page/names.ts";
import { IconButton } from "../ui/button.tsx";
import { useSignal } from "../ui/signals.ts";
import { useSession } from "./session_context.tsx";
import "./sent_commands.css";

const EVERY_MS = 100;

const SIGNS: Readonly<Record<string, ReactNode>> = {
  sent: <Send size={14} aria-hidden />,
  applied: <Check size={14} aria-hidden />,
  refused: <TriangleAlert size={14} aria-hidden />,
  expired: <Hourglass size={14} aria-hidden />,
  lost: <CircleHelp size={14} aria-hidden />,
};

export function SentCommands({ watch }: { watch: Watch }) {
  const sent = useSignal(watch.sent);
  const seen = useSignal(dismissed(watch));
  const now_ms = useTicks(sent);
  useSignal(askedQuestions(watch));
  const { page } = useSession();
  const lines = sentLines(sent, seen, now_ms, (question) => answeredBy(watch, question));
  return (
    <ul className="sent" aria-label="Pending commands" aria-live="polite">
      {lines.map(({ id, command, kind, words }) => (
        <li key={id} className={`sent-line sent-${kind}`}>
          {SIGNS[kind]}
          <span>
            <strong>{commandInWords(command)}</strong>{" "}
            {withStateNames(page.tabs.peek(), page.active.peek(), words)}
          </span>
          {kind !== "sent" && kind !== "applied" && (
            <IconButton label="Close" icon={<X size={14} />} onClick={() => dismiss(watch, id)} />
          )}
        </li>
      ))}
    </ul>
  );
}

/** The time, ten times a second from when something was sent until nothing more will be different by itself. */
function useTicks(sent: readonly SentCommand[]): number {
  const [now_ms, setNow] = useState(() => Date.now());
  useEffect(() => {
    if (sent.length === 0) return;
    setNow(Date.now());
    let rounds = 0;
    const timer = setInterval(() => {
      rounds += 1;
      setNow(Date.now());
      const isWaiting = sent.some(({ answer }) => answer === null);
      if (!isWaiting && rounds * EVERY_MS > 3_000) clearInterval(timer);
    }, EVERY_MS);
    return () => clearInterval(timer);
  }, [sent]);
  return now_ms;
}
