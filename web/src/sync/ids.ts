/** Ids of requests. */

/** Makes unique ids of 12 hexadecimal digits, the length that takes the fewest bytes on a link to a robot. */
export function newRequestId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(6));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
