/** Undoes translations. A translator replaces text nodes by `<font>` elements; the page keeps writing into its own text nodes, so
 * a replaced one would show an old fact for ever. Knows no component. */

/** Pause after an undo, in ms. A translator that reacts at once must not block the page. */
const PAUSE_MS = 50;

/** Texts of users may contain `<font>` themselves. */
const OF_USERS = ".inspector-markdown";

/** Undoes translations of a document until the returned function is called; `onTranslated` is called once. */
export function undoTranslations(page: Document, onTranslated: () => void): () => void {
  let waiting: MutationRecord[] = [];
  let timer: ReturnType<typeof setTimeout> | undefined;
  let isReported = false;
  const undo = () => {
    timer = undefined;
    const records = waiting;
    waiting = [];
    if (!undone(records)) return;
    observer.takeRecords();
    timer = setTimeout(undo, PAUSE_MS);
    if (!isReported) onTranslated();
    isReported = true;
  };
  const observer = new MutationObserver((records) => {
    if (timer === undefined && !records.some(addsFont)) return;
    waiting = [...waiting, ...records];
    if (timer === undefined) undo();
  });
  observer.observe(page, { childList: true, subtree: true });
  return () => {
    observer.disconnect();
    clearTimeout(timer);
  };
}

/** True if something was undone. The last change is undone first, so that each place is as it was after the change. */
function undone(records: readonly MutationRecord[]): boolean {
  const added = new Set(records.filter(addsFont).map(({ target }) => target));
  const translated = new Set(
    records
      .filter((record) => added.has(record.target) && lostTexts(record).length > 0)
      .map(({ target }) => target),
  );
  for (const record of records.toReversed()) {
    const { target, nextSibling } = record;
    if (!translated.has(target)) continue;
    const before = nextSibling?.parentNode === target ? nextSibling : null;
    for (const text of lostTexts(record)) target.insertBefore(text, before);
    for (const node of record.addedNodes) if (isFont(node)) node.parentNode?.removeChild(node);
  }
  return translated.size > 0;
}

function addsFont({ target, addedNodes }: MutationRecord): boolean {
  return [...addedNodes].some(isFont) && !(target as Element).closest?.(OF_USERS);
}

function lostTexts({ removedNodes }: MutationRecord): readonly Node[] {
  return [...removedNodes].filter((node) => node.nodeType === 3 && !node.parentNode);
}

function isFont({ nodeName }: Node): boolean {
  return nodeName === "FONT";
}
