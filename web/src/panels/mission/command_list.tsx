/** Command list of a robot: reviewed before a pass, changed, and released as one. Loaded only for runs of robots. */

import { Send, Trash2 } from "lucide-react";
import { useCallback, useEffect, useState } from "react";
import { lacks, robotRefuses } from "../../commands/run_rules.ts";
import type {
  CommandList,
  LinkHealth,
  ListedCommand,
  ListLine,
} from "../../model/generated/protocol.ts";
import type { Watch } from "../../store/history/run.ts";
import { RefusalError } from "../../store/page/server.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { AddCommand } from "./add_command.tsx";
import { lineInWords, listInWords, stateInWords } from "./command_list_words.ts";
import "./command_list.css";

/** Refresh interval of the list, in ms. Times and faults change without a message of the server. */
const REFRESH_MS = 30_000;
/** Refresh interval while the result of a command is open, in ms. */
const OPEN_REFRESH_MS = 2_000;

export interface CommandListProps {
  readonly watch: Watch;
  readonly robot: LinkHealth;
  readonly now_ms: number;
}

export function CommandListPart({ watch, robot, now_ms }: CommandListProps) {
  const { page, shell } = useHost().context();
  const { list, ask } = useCommandList(robot, now_ms);
  const refusal = useComputed(
    () => lacks(page, "command") ?? robotRefuses(watch, "command"),
    [page, watch],
  );
  if (list === null) return null;
  const { revision, released, lines } = list;
  const set = (commands: readonly ListedCommand[]) =>
    ask("PUT", `?revision=${encodeURIComponent(revision)}`, commands);
  // Commands of a released list were sent: a further command begins a new list.
  const kept = released === undefined ? lines.map(({ listed }) => listed) : [];
  const adding = (
    <AddCommand
      run={watch.id}
      robot={robot}
      label={addLabel(list)}
      refusal={refusal}
      now_ms={now_ms}
      onAdd={(command) => set([...kept, command])}
    />
  );
  if (lines.length === 0) return <div className="command-list">{adding}</div>;
  const faulty = lines.filter((line) => line.fault !== undefined).length;
  const why =
    refusal ??
    (faulty > 0 ? "nothing is sent while a command has a fault" : null) ??
    (released !== undefined && !lines.some(isUnknown) ? "all commands were sent" : null);
  const release = async () => {
    const isSure = await shell.confirm({
      title: `Release ${counted(lines.length)} to ${robot.robot}?`,
      text:
        released === undefined
          ? "All of them are sent, or none if one has a fault. A command that was sent cannot be recalled."
          : "Those whose fate is unknown are sent again. The robot carries out each at most once.",
      yes: released === undefined ? "Release" : "Release again",
    });
    if (isSure) await ask("POST", "/release", { revision });
  };
  const remove = (index: number) => set(kept.filter((_, other) => other !== index));
  return (
    <div className="command-list" role="group" aria-label={`Command list of ${robot.robot}`}>
      <p>
        <strong>Command list</strong>: {listInWords(list, now_ms)}
      </p>
      <ol>
        {lines.map((line, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a line is identified by its number
          <li key={index}>
            <span>
              <strong>{lineInWords(line, watch.id)}</strong>: {stateInWords(line, now_ms)}
            </span>
            {line.fault !== undefined && <span className="command-list-fault">{line.fault}</span>}
            {released === undefined && (
              <IconButton
                label={refusal ?? `Remove line ${index + 1}`}
                icon={<Trash2 size={16} />}
                disabled={refusal !== null}
                onClick={() => void remove(index)}
              />
            )}
          </li>
        ))}
      </ol>
      <div className="command-list-buttons">
        <Button
          icon={<Send size={16} aria-hidden />}
          disabled={why !== null}
          title={why ?? "Sends all commands of the list, or none"}
          onClick={() => void release()}
        >
          {released === undefined ? "Release…" : "Release again…"}
        </Button>
        {adding}
      </div>
    </div>
  );
}

interface ListOfRobot {
  readonly list: CommandList | null;
  /** Changes or releases the list. After a refusal it shows the reason, requests the list again, and returns false. */
  readonly ask: (method: "POST" | "PUT", what: string, body: unknown) => Promise<boolean>;
}

/** The list, requested again when the link, the plan of contacts or a command changes. */
function useCommandList(robot: LinkHealth, now_ms: number): ListOfRobot {
  const { page } = useHost().context();
  const [list, setList] = useState<CommandList | null>(null);
  const path = `/robots/${encodeURIComponent(robot.robot)}/commands`;
  const { request } = page.server;
  const load = useCallback(async () => {
    try {
      setList(await request<CommandList>("GET", path));
    } catch (error) {
      // The previous list stays until the next request.
      if (!(error instanceof RefusalError)) throw error;
    }
  }, [request, path]);
  const stages = robot.commands.map(({ id, stage }) => `${id} ${stage}`).join();
  const isOpen = list?.lines.some(({ fate }) => fate?.fate === "open") ?? false;
  const refresh_ms = isOpen ? OPEN_REFRESH_MS : REFRESH_MS;
  const changes = `${robot.is_heard} ${robot.contact?.begin_ms} ${robot.round_trip_ms === null} ${stages} ${Math.floor(now_ms / refresh_ms)}`;
  // biome-ignore lint/correctness/useExhaustiveDependencies: `changes` triggers another request
  useEffect(() => void load(), [load, changes]);
  const ask = async (method: "POST" | "PUT", what: string, body: unknown) => {
    try {
      setList(await request<CommandList>(method, `${path}${what}`, body));
      return true;
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      page.tell({ level: "error", text: error.message });
      await load();
      return false;
    }
  };
  return { list, ask };
}

function isUnknown({ fate }: ListLine): boolean {
  return fate?.fate === "answered" && fate.answer.answer === "unknown";
}

function addLabel({ released, lines }: CommandList): string {
  if (lines.length === 0) return "Add a timed command…";
  return released === undefined ? "Add a command…" : "Begin a new list…";
}

function counted(count: number): string {
  return count === 1 ? "1 command" : `${count} commands`;
}
