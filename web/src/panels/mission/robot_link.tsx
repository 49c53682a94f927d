/** Link to a remote robot, as prominent as the status of its run. It states which facts are unknown without an up-link. */

import { CalendarClock, Radio, RadioTower } from "lucide-react";
import { useState } from "react";
import { untilContact_ms, waitForContact_ms } from "../../model/contact_wait.ts";
import type { ClockOffset, LinkHealth, LinkRights } from "../../model/generated/protocol.ts";
import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import { IconButton } from "../../ui/button.tsx";
import { onDemand } from "../../ui/on_demand.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration } from "../parts/duration.ts";
import { commandsInWords, contactInWords } from "./planned_contact.ts";
import "./robot_link.css";

/** Name of the fact about the contact. */
const CONTACT = "planned contact";

const ContactPlan = onDemand(async () => (await import("./contact_plan.tsx")).ContactPlan);
const CommandList = onDemand(async () => (await import("./command_list.tsx")).CommandListPart);

export function RobotLink({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  // After the end of a run, the status of the link is no longer updated.
  const robot = useComputed(() => {
    const now = watch.now.value;
    return now && isLive(now.run.phase) ? (now.robot ?? null) : null;
  }, [watch]);
  const pulse = useSignal(page.server.pulse);
  const [showsPlan, setShowsPlan] = useState(false);
  if (robot === null) return null;
  // Time of the server, so that a silent server does not appear as a silent robot.
  const now_ms = pulse?.server_ms ?? 0;
  const isWhole = robot.is_heard && upLinkSilence(robot, now_ms) === null;
  return (
    <section
      className={`robot-link${isWhole ? "" : " robot-link-dark"}`}
      aria-label="Link to the robot"
    >
      <p className="robot-link-contact">
        {isWhole ? <Radio size={22} aria-hidden /> : <RadioTower size={22} aria-hidden />}
        <span>{contact(robot, now_ms)}</span>
      </p>
      <dl className="robot-link-facts">
        {facts(robot, now_ms).map(([name, value, why]) => (
          <div key={name} title={why}>
            <dt>{name}</dt>
            <dd>
              {value}
              {name === CONTACT && !showsPlan && (
                <IconButton
                  label="Plan contacts"
                  icon={<CalendarClock size={16} />}
                  onClick={() => setShowsPlan(true)}
                />
              )}
            </dd>
          </div>
        ))}
      </dl>
      {robot.commands.length > 0 && (
        <ul className="robot-link-commands" aria-label="Commands on the way to the robot">
          {commandsInWords(robot, now_ms).map((words, index) => (
            <li key={robot.commands[index]?.id}>{words}</li>
          ))}
        </ul>
      )}
      {showsPlan && (
        <ContactPlan robot={robot.robot} now_ms={now_ms} onClose={() => setShowsPlan(false)} />
      )}
      <CommandList watch={watch} robot={robot} now_ms={now_ms} />
    </section>
  );
}

/** Most important fact, in large letters. */
function contact(robot: LinkHealth, now_ms: number): string {
  if (robot.heard_ms === null) return `No signal from ${robot.robot} since the station started`;
  if (robot.is_heard) {
    const silence_ms = upLinkSilence(robot, now_ms);
    if (silence_ms === null) return `Receiving from ${robot.robot}`;
    return `Receiving from ${robot.robot}, but it has confirmed nothing from here for ${duration(silence_ms)}`;
  }
  return `No signal from ${robot.robot} for ${duration(ago(now_ms, robot.heard_ms))}`;
}

/** Time since the last confirmation of the robot; null while that is normal, or was never measured. */
function upLinkSilence(robot: LinkHealth, now_ms: number): number | null {
  if (robot.reached_ms === null || robot.round_trip_ms === null) return null;
  const since_ms = ago(now_ms, robot.reached_ms);
  // An idle station reports every four statuses at most.
  const usual_ms = 2 * robot.round_trip_ms + 10 * robot.expected_every_ms + 3_000;
  return since_ms > usual_ms ? since_ms : null;
}

type Fact = readonly [name: string, value: string, why: string];

function facts(robot: LinkHealth, now_ms: number): readonly Fact[] {
  const { down_bytes_per_s, up_bytes_per_s, commands } = robot;
  return [
    delay(robot, now_ms),
    command(robot, now_ms),
    planned(robot, now_ms),
    next(robot),
    [
      "received / sent",
      `${size(down_bytes_per_s)}/s / ${size(up_bytes_per_s)}/s`,
      "Bytes a second from and to the robot, over all its runs",
    ],
    [
      "events to come",
      toCome(robot),
      "Events that the robot has recorded but this station has not received, as last reported by the robot",
    ],
    [
      "commands on the way",
      commands.length === 0 ? "none" : String(commands.length),
      "Commands to this robot that it has not answered yet",
    ],
    [
      "clock ahead by",
      clock(robot.clock),
      "By how much the robot's clock is ahead of the station's",
    ],
    rights(robot),
  ];
}

const RIGHTS: Readonly<Record<LinkRights, string>> = {
  observe: "see runs",
  command: "command runs",
  change: "command and change runs",
};

/** Rights of this station's users on the robot, and how to change them. */
function rights({ robot, rights: given }: LinkHealth): Fact {
  const why = `By the pairing, for all users of this station; the robot checks it. Another choice needs another pairing: rafcon pair ${robot} --rights observe, command or change`;
  return ["this station may", given ? RIGHTS[given] : "unknown", why];
}

/** Number of missing events. While the robot is not received, its run continues, so the number is a lower bound. */
function toCome({ is_heard, missing }: LinkHealth): string {
  const known = missing.toLocaleString("en");
  if (!is_heard) return missing === 0 ? "unknown" : `${known} or more`;
  return missing === 0 ? "none" : known;
}

function delay(robot: LinkHealth, now_ms: number): Fact {
  const why = "Half of the measured way to the robot and back";
  if (robot.reached_ms === null || robot.round_trip_ms === null)
    return [
      "delay",
      "unknown: no up-link",
      "The robot has never confirmed a signal from this station",
    ];
  const since_ms = upLinkSilence(robot, now_ms);
  const value = duration(robot.round_trip_ms / 2);
  if (since_ms === null) return ["delay", value, why];
  const measured = `${value}, ${duration(since_ms)} ago`;
  return ["delay", measured, `${why}: the robot has confirmed nothing since`];
}

/** Times for the next command: when it is sent, takes effect, and expires. */
function command(robot: LinkHealth, now_ms: number): Fact {
  const why =
    "When a command that is given now is sent, takes effect and expires; a stop does not expire";
  const { lifetime_ms } = robot;
  const wait_ms = untilContact_ms(robot, now_ms);
  const sent = wait_ms === 0 ? "" : `sent in ${duration(wait_ms)}, `;
  const lasts_ms = waitForContact_ms(robot, now_ms) + (lifetime_ms ?? 0);
  const expiry = lifetime_ms === null ? "" : `, expires in ${duration(lasts_ms)}`;
  return ["command given now", `${sent}${effectNow(robot, wait_ms)}${expiry}`, why];
}

/** Time of effect. It is unknown without a measured delay or any contact. */
function effectNow({ is_heard, round_trip_ms }: LinkHealth, wait_ms: number): string {
  if (round_trip_ms === null) return "effect unknown: delay not measured yet";
  if (!is_heard && wait_ms === 0) return "effect unknown: no contact with the robot";
  return `effect in ${duration(wait_ms + round_trip_ms / 2)}`;
}

/** The planned contact. The plan is informative; the station sends at any time. */
function planned(robot: LinkHealth, now_ms: number): Fact {
  const why =
    robot.contacts_problem ??
    "The open contact of the plan, or else the next one; the station sends outside of contacts, too";
  return [CONTACT, contactInWords(robot, now_ms), why];
}

function next(robot: LinkHealth): Fact {
  const why = "While the link is whole, the robot sends its status at least this often";
  if (!robot.is_heard) return ["next status", "unknown", "No status arrives from the robot"];
  return ["next status", `within ${duration(robot.expected_every_ms)}`, why];
}

/** Offset of the robot's clock, as a range. */
function clock(offset: ClockOffset | null): string {
  if (offset === null) return "unknown";
  const { least_ms, most_ms } = offset;
  if (most_ms === null) return `${signed(least_ms)} or more`;
  return `${signed((least_ms + most_ms) / 2)} ± ${duration((most_ms - least_ms) / 2)}`;
}

function signed(ms: number): string {
  return ms < 0 ? duration(ms) : `+${duration(ms)}`;
}

function ago(now_ms: number, then_ms: number): number {
  return Math.max(0, now_ms - then_ms);
}

function size(bytes: number): string {
  return bytes < 1_000 ? `${bytes} B` : `${(bytes / 1_000).toFixed(1)} KB`;
}
