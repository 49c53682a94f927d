/** Rewrites messages of the server for the page: without addresses of its interface and options of its commands. */

/** Addresses and options in messages, with their replacements. */
const OTHERS: readonly (readonly [RegExp, string])[] = [
  [/: (?:GET )?\/api\/v1\/\S+ lists them$/, ""],
  [/: give it more time \(`--time-limit`\)/, ": give it more time"],
  [/: plan without `--parallel` and durations/, ": plan without parallel steps and durations"],
];

export function inPageWords(message: string): string {
  return OTHERS.reduce((text, [words, instead]) => text.replace(words, instead), message);
}
