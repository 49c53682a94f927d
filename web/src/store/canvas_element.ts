/** What code that draws on canvas elements needs of the page: the colours of the theme, and the pixels of the screen. */

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

/** Tells when the colours of the page may be others: by the theme, or by the class of what is around a place. Returns the way to
 * stop. */
export function onTheme(changed: () => void, around?: Element | null): () => void {
  const watcher = new MutationObserver(changed);
  watcher.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  if (around) watcher.observe(around, { attributes: true, attributeFilter: ["class"] });
  return () => watcher.disconnect();
}

/** The context of a canvas, which gets as many pixels of the screen as this size in CSS pixels has; it draws in CSS pixels. */
export function scaledContext(
  canvas: HTMLCanvasElement,
  size: { readonly width: number; readonly height: number },
  settings?: CanvasRenderingContext2DSettings,
): CanvasRenderingContext2D | null {
  const ratio = Math.max(1, window.devicePixelRatio || 1);
  const [width, height] = [Math.round(size.width * ratio), Math.round(size.height * ratio)];
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d", settings);
  context?.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}
