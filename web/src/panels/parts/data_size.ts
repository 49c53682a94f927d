/** Sizes of data as text. */

/** Such as `812 B`, `20.0 KB`, `1.2 MB`. */
export function dataSize(bytes: number): string {
  if (bytes < 1_000) return `${bytes} B`;
  if (bytes < 999_500) return `${threeFigures(bytes / 1_000)} KB`;
  if (bytes < 999_500_000) return `${threeFigures(bytes / 1_000_000)} MB`;
  return `${threeFigures(bytes / 1_000_000_000)} GB`;
}

function threeFigures(number: number): string {
  return number < 99.95 ? number.toFixed(1) : String(Math.round(number));
}
