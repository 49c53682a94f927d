/** Text of any length: its first lines, all of it on request, and a search field. */

import { useState } from "react";
import { Button } from "../../../ui/button.tsx";
import { TextField } from "../../../ui/field.tsx";
import { Marked } from "../../../ui/marked.tsx";

interface LongTextProps {
  readonly text: string;
  /** Original number of characters, if the text was truncated. */
  readonly count?: number | undefined;
}

/** Length from which a search field is shown, in characters. */
const SEARCH_FROM = 200;
const FOLDED_MAX = 240;

export function LongText({ text, count = 0 }: LongTextProps) {
  const [isWhole, setWhole] = useState(false);
  const [query, setQuery] = useState("");
  const length = [...text].length;
  const folded = isWhole || query !== "" ? text : firstLines(text);
  const spans = placesOf(folded, query);
  return (
    <div className="value-text">
      {text.length >= SEARCH_FROM && (
        <div className="value-find">
          <TextField
            label="Find in the text"
            hideLabel
            type="search"
            placeholder="Find in the text"
            value=""
            onInput={setQuery}
          />
          {query !== "" && <span className="value-type">{spans.length} found</span>}
        </div>
      )}
      <pre>
        <Marked text={folded} spans={spans} />
      </pre>
      {folded.length < text.length && (
        <Button kind="quiet" onClick={() => setWhole(true)}>
          Show all {length} characters
        </Button>
      )}
      {isWhole && (
        <Button kind="quiet" onClick={() => setWhole(false)}>
          Show less
        </Button>
      )}
      {count > length && (
        <p className="value-fact">
          {length} of {count} characters were kept.
        </p>
      )}
    </div>
  );
}

function firstLines(text: string): string {
  const lines = text.slice(0, FOLDED_MAX).split("\n").slice(0, 6).join("\n");
  return lines.length < text.length ? lines : text;
}

/** Matches of the query in the text, ignoring case. */
export function placesOf(text: string, query: string): { start: number; length: number }[] {
  const [all, wanted] = [text.toLowerCase(), query.toLowerCase()];
  const places = [];
  if (wanted === "" || all.length !== text.length) return [];
  for (let at = all.indexOf(wanted); at >= 0; at = all.indexOf(wanted, at + wanted.length)) {
    places.push({ start: at, length: wanted.length });
  }
  return places;
}
