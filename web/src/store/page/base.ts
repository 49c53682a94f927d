/** The address of this page's server, which a proxy may offer below a path. The page finds it by its own address, or by the address
 * that the server has written into the page. */

/** Address of the server, without a slash at its end; empty where there is no page. */
export function pageBase(view: Document | undefined = globalThis.document): string {
  if (view === undefined) return "";
  const meta = view.querySelector<HTMLMetaElement>('meta[name="base"]');
  return new URL(meta?.content ?? "./", view.location.href).href.replace(/\/$/, "");
}

/** Prefix of what this page keeps in the browser: empty at the root of an origin. Several robots may share one origin. */
export function storePrefix(base: string): string {
  const path = base === "" ? "" : new URL(base).pathname;
  return path === "/" || path === "" ? "" : `${path}:`;
}
