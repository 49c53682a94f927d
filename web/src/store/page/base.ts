/** Address of this page's server. A proxy may serve it below a path: the page uses its own address, or the one that the server has
 * written into it. */

/** Address of the server, without a trailing slash; empty without a page. */
export function pageBase(view: Document | undefined = globalThis.document): string {
  if (view === undefined) return "";
  const meta = view.querySelector<HTMLMetaElement>('meta[name="base"]');
  return new URL(meta?.content ?? "./", view.location.href).href.replace(/\/$/, "");
}

/** Prefix of this page's keys in the browser's storage; empty at the root of an origin. Several robots may share an origin. */
export function storePrefix(base: string): string {
  const path = base === "" ? "" : new URL(base).pathname;
  return path === "/" || path === "" ? "" : `${path}:`;
}
