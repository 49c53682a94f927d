/** Completions in a script: names of the state's ports and outcomes, of global variables, and of members of `self`, `gvm` and
 * `dialog` (docs/scripts.md). */

import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";

/** Names that the script of a state can use. */
export interface ScriptNames {
  readonly inputs: readonly Named[];
  readonly outputs: readonly Named[];
  readonly outcomes: readonly Named[];
  readonly globals: readonly Named[];
}

export interface Named {
  readonly name: string;
  /** Type or kind of the named object. */
  readonly detail: string;
}

/** Completes names of this state. `names` is called for each completion. */
export function nameCompletion(names: () => ScriptNames) {
  return (context: CompletionContext): CompletionResult | null => {
    const line = context.state.doc.lineAt(context.pos);
    const before = line.text.slice(0, context.pos - line.from);
    const found = completionsAt(before, line.text.slice(before.length), names());
    if (!found) return null;
    return {
      from: context.pos - found.typed.length,
      options: [...found.options],
      validFor: found.isText ? /^[^"'\n]*$/ : /^\w*$/,
    };
  };
}

interface FoundCompletions {
  /** Part of the name that is typed already. */
  readonly typed: string;
  readonly options: readonly Completion[];
  /** True inside quotes. */
  readonly isText: boolean;
}

const PORT = /\b(inputs|outputs)\s*(?:\[|\.(?:get|pop|setdefault)\()\s*(["']?)([^"'\])]*)$/;
const GLOBAL = /\b(?:gvm|global_variable_manager)\.\w+\(\s*(?:key\s*=\s*)?(["']?)([^"'),]*)$/;
const RETURN =
  /(?:^|[\s:])return\s+(?:(?:[^"'#]|"[^"]*"|'[^']*')*(?:\belse|\bor)\s+)?(["']?)([^"'\s]*)$/;
const MEMBER = /\b(self\.logger|self|gvm|global_variable_manager|dialog)\.(\w*)$/;

/** Completions after the beginning of a line; `after` is the rest of the line. */
export function completionsAt(
  before: string,
  after: string,
  names: ScriptNames,
): FoundCompletions | null {
  const port = PORT.exec(before);
  if (port) {
    const [, owner, quote = "", typed = ""] = port;
    const list = owner === "inputs" ? names.inputs : names.outputs;
    return texts(list, "property", quote, typed, after);
  }
  const global = GLOBAL.exec(before);
  if (global) {
    const [, quote = "", typed = ""] = global;
    return texts(names.globals, "variable", quote, typed, after);
  }
  const returned = RETURN.exec(before);
  if (returned) {
    const [, quote = "", typed = ""] = returned;
    return texts(names.outcomes, "enum", quote, typed, after);
  }
  const member = MEMBER.exec(before);
  if (!member) return null;
  const [, owner = "", typed = ""] = member;
  return { typed, options: MEMBERS[owner] ?? [], isText: false };
}

/** Names as Python strings. Outside quotes each completion adds its own. */
function texts(
  list: readonly Named[],
  type: string,
  quote: string,
  typed: string,
  after: string,
): FoundCompletions {
  const options = list.map(({ name, detail }) => {
    const closing = after.startsWith(quote) ? "" : quote;
    const apply = quote === "" ? JSON.stringify(name) : name + closing;
    return { label: name, detail, type, apply };
  });
  return { typed, options, isText: quote !== "" };
}

function members(type: string, entries: Readonly<Record<string, string>>): readonly Completion[] {
  return Object.entries(entries).map(([name, detail]) => {
    const isMethod = name.endsWith("()");
    const label = isMethod ? name.slice(0, -2) : name;
    return { label, detail, type: isMethod ? "method" : type };
  });
}

const MEMBERS: Readonly<Record<string, readonly Completion[]>> = {
  self: members("property", {
    "preemptive_wait()": "waits; True if preempted",
    preempted: "whether the state must end",
    paused: "whether the run is paused",
    started: "whether the run was resumed since its last pause",
    "wait_for_interruption()": "waits for preemption or pause",
    "wait_for_unpause()": "waits until the run is resumed",
    logger: "logs for this state",
    name: "name of the state",
    state_id: "id of the state",
    description: "description of the state",
    "get_path()": "ids from the root on",
    file_system_path: "folder of the state",
    parent: "the container of the state",
    "get_state_machine()": "the machine",
    is_root_state: "whether it is the root state",
    outcomes: "outcomes by id",
    input_data_ports: "inputs by id",
    output_data_ports: "outputs by id",
    input_data: "values of inputs by name",
    output_data: "values of outputs by name",
    semantic_data: "the user's notes",
    "get_semantic_data()": "one of the notes",
    "add_semantic_data()": "a note for this process",
    "remove_semantic_data()": "removes a note",
    persistent_variables: "kept from run to run",
    "get_previously_executed_state()": "what ran before it",
    execution_history: "what was entered and left",
    backward_execution: "whether it is being undone",
    "get_outcome_for_state_name()": "in a decider: how a state ended",
    "get_outcome_for_state_id()": "in a decider: how a state ended",
    "get_errors_for_state_name()": "in a decider: errors of a state",
  }),
  "self.logger": members("method", {
    "verbose()": "below debug",
    "debug()": "",
    "info()": "",
    "warning()": "",
    "error()": "",
    "exception()": "with the traceback",
  }),
  gvm: globals(),
  global_variable_manager: globals(),
  dialog: members("method", {
    "ask()": "a choice of buttons",
    "text()": "a line of text",
    "number()": "a number",
    "checks()": "checkboxes",
  }),
};

function globals(): readonly Completion[] {
  return members("method", {
    "set_variable()": "key, value",
    "get_variable()": "key, default=None",
    "variable_exist()": "key",
    "delete_variable()": "key",
    "lock_variable()": "key; gives an access key",
    "unlock_variable()": "key, access key",
    "is_locked()": "key",
    "get_all_keys()": "all names",
  });
}
