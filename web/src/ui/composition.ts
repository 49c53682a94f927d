/** Keys of an input method are not the page's: Enter takes the composed word, Escape gives it up. */

/** Scripts: their editor follows compositions itself. */
const FOLLOWS_COMPOSITION = ".cm-editor";

/** The number that browsers give the key when an input method has it; some report the last Enter of a word only by it. */
const BY_INPUT_METHOD = 229;

/** Keeps keys of input methods from everything in a window, until the returned function is called. */
export function keepCompositions(view: Window): () => void {
  const keep = (event: KeyboardEvent) => {
    const isComposed = event.isComposing || event.keyCode === BY_INPUT_METHOD;
    const target = event.target as Element | null;
    if (isComposed && !target?.closest?.(FOLLOWS_COMPOSITION)) event.stopImmediatePropagation();
  };
  view.addEventListener("keydown", keep, { capture: true });
  return () => view.removeEventListener("keydown", keep, { capture: true });
}
