/** Converts the Markdown of a description to safe HTML: only the tags and attributes in an allowlist, up to a size that the page
 * can show. */

import DOMPurify from "dompurify";
import { Lexer, Marked, type Token, type TokensList } from "marked";

/** Maximum number of characters of a description that are formatted. */
export const FORMATTED_MAX = 32_000;
/** Maximum nesting of lists, quotations and emphasis that is formatted. */
export const NESTING_MAX = 16;

const TAGS = [
  ...["p", "br", "hr", "h1", "h2", "h3", "h4", "h5", "h6", "blockquote", "pre", "code"],
  ...["strong", "em", "b", "i", "u", "s", "del", "sub", "sup", "kbd", "mark", "a"],
  ...["ul", "ol", "li", "table", "thead", "tbody", "tr", "th", "td"],
];

const purify = DOMPurify(window);

purify.addHook("afterSanitizeAttributes", (node) => {
  if (!node.hasAttribute("href")) return;
  // A click opens the link in another tab.
  node.setAttribute("target", "_blank");
  node.setAttribute("rel", "noopener noreferrer");
});

const marked = new Marked({
  gfm: true,
  breaks: true,
  renderer: {
    checkbox: ({ checked }) => (checked ? "☑ " : "☐ "),
    html: ({ text }) => withoutHandlers(text),
  },
});

/** Renames event handlers, because browsers log errors for those in inert HTML. The sanitizer would remove them later. */
export function withoutHandlers(html: string): string {
  return html.replace(/<[a-z][^>]*>?/gi, (tag) =>
    tag.replace(/([\s"'/])on\w+\s*=/gi, "$1data-no="),
  );
}

/** Parses Markdown up to a maximum depth. Deeper parts stay plain text. */
class BoundedLexer extends Lexer {
  isTooDeep = false;
  #depth = 0;

  override blockTokens(source: string, tokens?: Token[], isClipped?: boolean): Token[];
  override blockTokens(source: string, tokens?: TokensList, isClipped?: boolean): TokensList;
  override blockTokens(source: string, tokens: Token[] = [], isClipped?: boolean): Token[] {
    return this.#within(source, tokens, () => super.blockTokens(source, tokens, isClipped));
  }

  override inlineTokens(source: string, tokens: Token[] = []): Token[] {
    return this.#within(source, tokens, () => super.inlineTokens(source, tokens));
  }

  #within(source: string, tokens: Token[], read: () => Token[]): Token[] {
    if (this.#depth >= NESTING_MAX) {
      this.isTooDeep = true;
      tokens.push({ type: "text", raw: source, text: source, escaped: false });
      return tokens;
    }
    this.#depth++;
    try {
      return read();
    } finally {
      this.#depth--;
    }
  }
}

/** HTML of a description, not sanitized yet. */
interface Formatted {
  readonly html: string;
  /** Number of characters of the text that the HTML contains. */
  readonly length: number;
  /** True if parts are nested too deep to be formatted. */
  readonly isTooDeep: boolean;
}

/** Formats the beginning of a text. The time does not depend on the length or nesting of the text. */
export function formatted(text: string): Formatted {
  const beginning = beginningOf(text);
  const lexer = new BoundedLexer({ ...marked.defaults });
  const html = marked.parser(lexer.lex(beginning));
  return { html, length: beginning.length, isTooDeep: lexer.isTooDeep };
}

/** Beginning of a text, cut after a whole line unless the last line is long. */
function beginningOf(text: string): string {
  if (text.length <= FORMATTED_MAX) return text;
  const end = text.lastIndexOf("\n", FORMATTED_MAX);
  return text.slice(0, end > FORMATTED_MAX / 2 ? end : FORMATTED_MAX);
}

export function safeHtml(text: string): Formatted {
  const { html, ...rest } = formatted(text);
  const safe = purify.sanitize(html, {
    ALLOWED_TAGS: TAGS,
    ALLOWED_ATTR: ["href", "title", "start"],
    ALLOW_DATA_ATTR: false,
    ALLOW_ARIA_ATTR: false,
    ALLOWED_URI_REGEXP: /^(?:https?|mailto):/i,
  });
  return { ...rest, html: safe };
}
