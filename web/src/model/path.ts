/** Paths of states: ids from the root to the state, joined by `/`. */

/** Path of the container; null for the root. */
export function parentOf(path: string): string | null {
  const end = path.lastIndexOf("/");
  return end < 0 ? null : path.slice(0, end);
}

/** Id of the state. */
export function idOf(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1);
}

/** Path of a child. */
export function childPath(parent: string, id: string): string {
  return `${parent}/${id}`;
}

/** True if `path` is `outer` or inside it. */
export function isWithin(path: string, outer: string): boolean {
  return path === outer || (path.length > outer.length && path.startsWith(`${outer}/`));
}

/** The path itself and the paths of all states around it, from the root on. */
export function lineage(path: string): readonly string[] {
  const found: string[] = [];
  for (let end = path.indexOf("/"); end >= 0; end = path.indexOf("/", end + 1)) {
    found.push(path.slice(0, end));
  }
  found.push(path);
  return found;
}

/** Innermost state that contains or equals all paths; null if there is none. */
export function commonPath(paths: readonly string[]): string | null {
  const [first, ...rest] = paths;
  if (first === undefined) return null;
  const around = lineage(first).filter((outer) => rest.every((path) => isWithin(path, outer)));
  return around.at(-1) ?? null;
}
