/** Markdown as it reads. */

import { useMemo } from "react";
import { safeHtml } from "./markdown.ts";

export function Markdown({ text }: { text: string }) {
  const html = useMemo(() => safeHtml(text), [text]);
  return (
    <div
      className="inspector-markdown"
      // biome-ignore lint/security/noDangerouslySetInnerHtml: DOMPurify has taken out what could do harm
      dangerouslySetInnerHTML={{ __html: html }}
    />
  );
}
