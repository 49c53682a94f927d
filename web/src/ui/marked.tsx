/** A text with the matches of a search marked. */

import "./marked.css";

interface MarkedProps {
  readonly text: string;
  /** In order, without overlaps. */
  readonly spans: readonly { readonly start: number; readonly length: number }[];
}

export function Marked({ text, spans }: MarkedProps) {
  if (spans.length === 0) return <>{text}</>;
  const end = spans.reduce((_, { start, length }) => start + length, 0);
  return (
    <>
      {spans.map(({ start, length }, index) => {
        const before = spans[index - 1];
        const from = before ? before.start + before.length : 0;
        return (
          <span key={start}>
            {text.slice(from, start)}
            <mark className="marked">{text.slice(start, start + length)}</mark>
          </span>
        );
      })}
      {text.slice(end)}
    </>
  );
}
