/** Ids of requests: nobody else has them, and they say nothing. */

/** Makes ids that begin alike and differ in a number. */
export function newIds(): () => string {
  const bytes = crypto.getRandomValues(new Uint8Array(9));
  const prefix = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  let count = 0;
  return () => {
    count += 1;
    return `${prefix}-${count}`;
  };
}
