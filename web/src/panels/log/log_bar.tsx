/** Filter bar of the log. */

import { Eraser } from "lucide-react";
import type { ReactNode } from "react";
import type { LogLevel } from "../../model/generated/protocol.ts";
import { IconButton } from "../../ui/button.tsx";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import type { LogSource } from "./entries.ts";

interface LogFilter {
  readonly source: LogSource;
  readonly least: LogLevel;
  readonly query: string;
  /** True to show only lines of the selected states and of states inside them. */
  readonly isOfSelection: boolean;
  readonly follows: boolean;
}

export const FIRST_FILTER: LogFilter = {
  source: "both",
  least: "info",
  query: "",
  isOfSelection: false,
  follows: true,
};

const SOURCE_TITLES = [
  { value: "both", title: "Run and page" },
  { value: "run", title: "Run" },
  { value: "page", title: "Page" },
] as const;

const LEAST = [
  { value: "verbose", title: "Everything" },
  { value: "debug", title: "Debug and above" },
  { value: "info", title: "Info and above" },
  { value: "warning", title: "Warnings and errors" },
  { value: "error", title: "Errors" },
] as const;

interface LogBarProps {
  readonly filter: LogFilter;
  readonly onChange: (filter: LogFilter) => void;
  readonly hasRun: boolean;
  readonly onClear: () => void;
  /** Additional buttons. */
  readonly children?: ReactNode;
}

export function LogBar({ filter, onChange, hasRun, onClear, children }: LogBarProps) {
  const change = (part: Partial<LogFilter>) => onChange({ ...filter, ...part });
  return (
    <div className="log-bar">
      <TextField
        label="Filter the log"
        hideLabel
        type="search"
        placeholder="Text or state"
        value=""
        onInput={(query) => change({ query })}
      />
      {hasRun && (
        <Select
          label="Source"
          hideLabel
          value={filter.source}
          options={SOURCE_TITLES}
          onChange={(source) => change({ source })}
        />
      )}
      <Select
        label="Level"
        hideLabel
        value={filter.least}
        options={LEAST}
        onChange={(least) => change({ least })}
      />
      <Checkbox
        label="Selection only"
        title="Only lines of the selected states and the states inside them"
        checked={filter.isOfSelection}
        onChange={(isOfSelection) => change({ isOfSelection })}
      />
      <Checkbox
        label="Follow"
        title="Follow the newest line"
        checked={filter.follows}
        onChange={(follows) => change({ follows })}
      />
      <span className="log-gap" />
      {children}
      <IconButton label="Clear page messages" icon={<Eraser size={15} />} onClick={onClear} />
    </div>
  );
}
