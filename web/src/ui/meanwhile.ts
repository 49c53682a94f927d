/** Changes of a text by another person while it is edited here. */

/** True if a commit would overwrite the text of another person that arrived during the edit. */
export function isOthers(value: string, own: ReadonlySet<string>, text: string | null): boolean {
  return text !== null && value !== text && !own.has(value);
}

/** The choice between both texts. */
export function meanwhileInWords(value: string, enter = "Enter"): string {
  return `It ${changed(value)} in the meantime. ${enter} keeps your text, Escape takes theirs.`;
}

/** Reason why a text was discarded whose field no longer exists. */
export function givenUpInWords(value: string): string {
  return `it ${changed(value)} in the meantime`;
}

function changed(value: string): string {
  return value === "" ? "was emptied" : `was changed to “${value}”`;
}
