/** Values that are created once per owner, on first use, and end with it: derived models, caches and state of higher layers,
 * without any reference in the owner. */

/** Creates the value of an owner at the first call. The further arguments of later calls are ignored. */
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
