/** Texts about planned contacts with a robot: the open or the next one, and when each command is sent and takes effect. */

import { commandTypeInWords } from "../../model/command_words.ts";
import { untilContact_ms } from "../../model/contact_wait.ts";
import type { LinkHealth, OpenCommand } from "../../model/generated/protocol.ts";
import { utcTime } from "../../store/page/times.ts";
import { duration } from "../parts/duration.ts";

/** The open contact, or else the next one. */
export function contactInWords(robot: LinkHealth, now_ms: number): string {
  if (robot.contacts_problem !== undefined) return "unknown: the plan cannot be read";
  const { contact } = robot;
  if (contact === undefined) return "no contact planned";
  const { begin_ms, end_ms, profile, note } = contact;
  const more = note === undefined ? `profile ${profile}` : `profile ${profile}, ${note}`;
  const end = utcTime(end_ms, now_ms);
  const wait_ms = untilContact_ms(robot, now_ms);
  if (wait_ms === 0) return `open until ${end}, ${duration(until(end_ms, now_ms))} left, ${more}`;
  return `in ${duration(wait_ms)}, ${utcTime(begin_ms, now_ms)} to ${end}, ${more}`;
}

/** Each pending command, with the time at which it is sent and takes effect. */
export function commandsInWords(robot: LinkHealth, now_ms: number): readonly string[] {
  return robot.commands.map((command) => {
    const isListed = command.id.startsWith("//list/");
    const user = isListed ? "the command list" : command.id.split("/", 1)[0];
    const state = stage(command, robot.is_heard, now_ms);
    return `${commandTypeInWords(command.asks)} of ${user}: ${state}`;
  });
}

function stage(command: OpenCommand, isHeard: boolean, now_ms: number): string {
  const effect = command.effect_ms;
  const isWaiting = command.stage === "sent" && command.send_at_ms === undefined;
  if (isWaiting && !isHeard) return "being sent, time of effect unknown: no contact with the robot";
  switch (command.stage) {
    case "overdue":
      return "expired without an answer of the robot";
    case "started":
      return "the run has it";
    case "received":
      return effect === undefined
        ? "the robot has it"
        : `the robot has it, ${takesEffect(effect, now_ms)}`;
    case "sent":
      return `${sending(command, now_ms)}, ${takesEffect(effect, now_ms)}`;
  }
}

function sending({ send_at_ms }: OpenCommand, now_ms: number): string {
  if (send_at_ms === undefined) return "being sent";
  return `to be sent in ${duration(until(send_at_ms, now_ms))}, at ${utcTime(send_at_ms, now_ms)}`;
}

/** Time of effect. An unknown one is never estimated. */
function takesEffect(effect_ms: number | undefined, now_ms: number): string {
  if (effect_ms === undefined) return "time of effect unknown: delay not measured yet";
  const wait_ms = until(effect_ms, now_ms);
  if (wait_ms === 0) return "should have taken effect, no answer yet";
  return `takes effect in ${duration(wait_ms)}, at ${utcTime(effect_ms, now_ms)}`;
}

function until(then_ms: number, now_ms: number): number {
  return Math.max(0, then_ms - now_ms);
}
