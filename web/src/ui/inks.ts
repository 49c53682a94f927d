/** Colours of the theme for what draws by itself, and word of another theme. */

/** The value of a variable of the theme: `--text`. */
export type Inks = (variable: string) => string;

/** The colours as an element has them now; each is looked up once. */
export function inksOf(element: Element): Inks {
  const style = getComputedStyle(element);
  const known = new Map<string, string>();
  return (variable) => {
    let value = known.get(variable);
    if (value === undefined) {
      value = style.getPropertyValue(variable).trim() || "#888888";
      known.set(variable, value);
    }
    return value;
  };
}

/** Tells when the colours of the page may be others. Returns the way to stop. */
export function onTheme(changed: () => void): () => void {
  const watcher = new MutationObserver(changed);
  watcher.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  return () => watcher.disconnect();
}
