/** Formatted Markdown, up to a limit. A button shows the full plain text. */

import { useMemo, useState } from "react";
import { Button } from "../../ui/button.tsx";
import { safeHtml } from "./markdown.ts";

export function Markdown({ text }: { text: string }) {
  const [isPlain, setPlain] = useState(false);
  const { html, length, isTooDeep } = useMemo(() => safeHtml(text), [text]);
  const isShortened = length < text.length;
  return (
    <>
      {(isShortened || isTooDeep) && (
        <div className="inspector-shortened" role="note">
          {isShortened
            ? `Shortened: the first ${length} of ${text.length} characters are formatted.`
            : "Parts that are nested too deep are not formatted."}
          <Button kind="quiet" pressed={isPlain} onClick={() => setPlain(!isPlain)}>
            Full text without format
          </Button>
        </div>
      )}
      {isPlain ? <PlainText text={text} /> : <FormattedText html={html} />}
    </>
  );
}

function FormattedText({ html }: { html: string }) {
  return (
    <div
      className="inspector-markdown"
      // biome-ignore lint/security/noDangerouslySetInnerHtml: DOMPurify has sanitized it
      dangerouslySetInnerHTML={{ __html: html }}
    />
  );
}

/** Characters per piece. The browser lays out only visible pieces. */
const PIECE = 10_000;

function PlainText({ text }: { text: string }) {
  const pieces = useMemo(() => piecesOf(text), [text]);
  return (
    <div className="inspector-plain">
      {pieces.map(({ at, piece }) => (
        <pre key={at}>{piece}</pre>
      ))}
    </div>
  );
}

interface TextPiece {
  readonly at: number;
  readonly piece: string;
}

function piecesOf(text: string): readonly TextPiece[] {
  const pieces: TextPiece[] = [];
  for (let at = 0; at < text.length; ) {
    const line = text.indexOf("\n", at + PIECE / 2);
    const end = line >= 0 && line < at + PIECE ? line + 1 : at + PIECE;
    pieces.push({ at, piece: text.slice(at, end) });
    at = end;
  }
  return pieces;
}
