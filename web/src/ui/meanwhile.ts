/** What somebody else makes of a text while it is typed here. */

/** Whether a text of another person's waits to be overwritten: not one that was there when the typing began, nor one's own. */
export function isOthers(value: string, own: ReadonlySet<string>, text: string | null): boolean {
  return text !== null && value !== text && !own.has(value);
}

/** What becomes of both texts. */
export function meanwhileInWords(value: string, enter = "Enter"): string {
  return `It ${changed(value)} in the meantime. ${enter} keeps your text, Escape takes theirs.`;
}

/** Why a text whose field has gone was given up. */
export function givenUpInWords(value: string): string {
  return `it ${changed(value)} in the meantime`;
}

function changed(value: string): string {
  return value === "" ? "was emptied" : `was changed to “${value}”`;
}
