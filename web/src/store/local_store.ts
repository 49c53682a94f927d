/** Storage of the browser. The page works without it and reports when a value cannot be stored. */

import { signal } from "@preact/signals-core";
import { pageBase, storePrefix } from "./page/base.ts";

export interface LocalStore {
  /** What was put there as JSON; undefined if there is nothing. */
  readonly get: (key: string) => unknown;
  /** Puts it there; undefined removes it. */
  readonly put: (key: string, value: unknown) => void;
  /** Of all that is kept, the keys that begin like this. */
  readonly keys: (prefix: string) => readonly string[];
  /** Tells when another tab of the browser has put something else there. */
  readonly whenOther: (key: string, told: () => void) => void;
}

/** Reason why the browser's storage failed; null before a failure. Remains until the page is closed. */
export const storageFault = signal<"full" | "refused" | null>(null);

/** What was kept, if it is an object. */
export function kept<T extends object>(localStore: LocalStore, key: string): T | undefined {
  const value = localStore.get(key);
  return typeof value === "object" && value !== null ? (value as T) : undefined;
}

/** The storage of a browser, for keys that begin like this there. */
export function localStoreOf(
  storage: () => Storage,
  prefix: string = storePrefix(pageBase()),
): LocalStore {
  return {
    get: (key) => {
      try {
        return JSON.parse(storage().getItem(prefix + key) ?? "null") ?? undefined;
      } catch {
        return undefined;
      }
    },
    put: (key, value) => {
      const text = value === undefined ? undefined : JSON.stringify(value);
      try {
        if (text === undefined) storage().removeItem(prefix + key);
        else storage().setItem(prefix + key, text);
      } catch (error) {
        storageFault.value ??= isFull(error) ? "full" : "refused";
      }
    },
    keys: (beginning) => {
      try {
        const own = Object.keys(storage()).filter((key) => key.startsWith(prefix + beginning));
        return own.map((key) => key.slice(prefix.length));
      } catch {
        return [];
      }
    },
    whenOther: (key, told) => {
      window.addEventListener("storage", (event) => {
        if (event.key === prefix + key || event.key === null) told();
      });
    },
  };
}

/** Firefox had a name of its own for it. */
function isFull(error: unknown): boolean {
  const names = ["QuotaExceededError", "NS_ERROR_DOM_QUOTA_REACHED"];
  return error instanceof Error && names.includes(error.name);
}

/** What this browser keeps over visits; without a browser, as long as the program runs. */
export const BROWSER_STORE: LocalStore =
  typeof window === "undefined" ? memoryStore() : localStoreOf(() => window.localStorage);

/** Kept as long as the program runs: for tests, and where there is no browser. */
export function memoryStore(): LocalStore {
  const texts = new Map<string, string>();
  return {
    get: (key) => JSON.parse(texts.get(key) ?? "null") ?? undefined,
    put: (key, value) => {
      if (value === undefined) texts.delete(key);
      else texts.set(key, JSON.stringify(value));
    },
    keys: (prefix) => [...texts.keys()].filter((key) => key.startsWith(prefix)),
    whenOther: () => {},
  };
}
