/** Helpers for drawing on canvas elements: theme colours and screen pixels. */

/** Returns the value of a theme variable, such as `--text`. */
export type Inks = (variable: string) => string;

/** Current colours of an element. Each is read once. */
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

/** Calls `changed` when colours may have changed: by the theme, or by the class of `around`. Returns a function that stops this. */
export function onTheme(changed: () => void, around?: Element | null): () => void {
  const watcher = new MutationObserver(changed);
  watcher.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  if (around) watcher.observe(around, { attributes: true, attributeFilter: ["class"] });
  return () => watcher.disconnect();
}

/** Context of a canvas that draws in CSS pixels. The canvas is resized to the screen pixels of `size`. */
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
