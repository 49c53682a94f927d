/** Storage of the browser. The page works without it and reports when a value cannot be stored. */

import { signal } from "@preact/signals-core";
import { pageBase, storePrefix } from "./page/base.ts";

export interface LocalStore {
  /** Stored JSON value; undefined if none. */
  readonly get: (key: string) => unknown;
  /** Stores a value as JSON; undefined removes it. */
  readonly put: (key: string, value: unknown) => void;
  /** Stored keys with this prefix. */
  readonly keys: (prefix: string) => readonly string[];
  /** Calls the listener when another tab of the browser changes the value. */
  readonly whenOther: (key: string, listener: () => void) => void;
}

/** Reason why the browser's storage failed; null before a failure. Remains until the page is closed. */
export const storageFault = signal<"full" | "refused" | null>(null);

/** Stored value, if it is an object. */
export function kept<T extends object>(localStore: LocalStore, key: string): T | undefined {
  const value = localStore.get(key);
  return typeof value === "object" && value !== null ? (value as T) : undefined;
}

/** A storage of the browser. All keys get the prefix. */
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
    whenOther: (key, listener) => {
      window.addEventListener("storage", (event) => {
        if (event.key === prefix + key || event.key === null) listener();
      });
    },
  };
}

/** Old versions of Firefox have another name for the error. */
function isFull(error: unknown): boolean {
  const names = ["QuotaExceededError", "NS_ERROR_DOM_QUOTA_REACHED"];
  return error instanceof Error && names.includes(error.name);
}

/** Storage of this browser across visits; without a browser, in memory only. */
export const BROWSER_STORE: LocalStore =
  typeof window === "undefined" ? memoryStore() : localStoreOf(() => window.localStorage);

/** Storage in memory: for tests, and without a browser. */
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
