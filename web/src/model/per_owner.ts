/** What is made once for each owner, when it is first wanted, and ends with it: derived models, caches and state of higher layers, of
 * which the owner knows nothing. */

/** Makes the value of an owner at the first call, whose further arguments count for good. */
export function perOwner<Owner extends WeakKey, More extends readonly unknown[], Value>(
  make: (owner: Owner, ...more: More) => Value,
): (owner: Owner, ...more: More) => Value {
  const made = new WeakMap<Owner, { readonly value: Value }>();
  return (owner, ...more) => {
    const known = made.get(owner);
    if (known) return known.value;
    const value = make(owner, ...more);
    made.set(owner, { value });
    return value;
  };
}
