/** Markdown of a description as HTML that can do no harm: only what text needs gets through, by a list of what is allowed. */

import DOMPurify from "dompurify";
import { marked } from "marked";

const TAGS = [
  ...["p", "br", "hr", "h1", "h2", "h3", "h4", "h5", "h6", "blockquote", "pre", "code"],
  ...["strong", "em", "b", "i", "u", "s", "del", "sub", "sup", "kbd", "mark", "a"],
  ...["ul", "ol", "li", "table", "thead", "tbody", "tr", "th", "td"],
];

const purify = DOMPurify(window);

purify.addHook("afterSanitizeAttributes", (node) => {
  if (!node.hasAttribute("href")) return;
  // A click leaves the page where it is.
  node.setAttribute("target", "_blank");
  node.setAttribute("rel", "noopener noreferrer");
});

marked.use({
  renderer: {
    checkbox: ({ checked }) => (checked ? "☑ " : "☐ "),
    html: ({ text }) => withoutHandlers(text),
  },
});

/** Renames handlers: browsers complain of those in HTML that is only read. They would be taken away afterwards in any case. */
export function withoutHandlers(html: string): string {
  return html.replace(/<[a-z][^>]*>?/gi, (tag) =>
    tag.replace(/([\s"'/])on\w+\s*=/gi, "$1data-no="),
  );
}

export function safeHtml(text: string): string {
  const made = marked.parse(text, { async: false, gfm: true, breaks: true });
  return purify.sanitize(made, {
    ALLOWED_TAGS: TAGS,
    ALLOWED_ATTR: ["href", "title", "start"],
    ALLOW_DATA_ATTR: false,
    ALLOW_ARIA_ATTR: false,
    ALLOWED_URI_REGEXP: /^(?:https?|mailto):/i,
  });
}
