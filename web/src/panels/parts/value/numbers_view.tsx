/** Numbers in rows, as a table, plot or image. Their number is limited to 256, so all are drawn. */

import { type PointerEvent, useEffect, useRef, useState } from "react";
import { isColoured, type NumberArray, range } from "../../../model/numbers.ts";
import { shortNumber } from "../../../model/short_value.ts";

interface NumbersProps {
  readonly numbers: NumberArray;
  readonly name: string;
}

/** Table with one row per index of all axes except the last. */
export function NumbersTable({ numbers: { items, shape, steps }, name }: NumbersProps) {
  const width = shape.length < 2 ? 1 : (shape.at(-1) ?? 1);
  const outer = shape.length < 2 ? shape : shape.slice(0, -1);
  const rows = Array.from({ length: items.length / width }, (_, row) => row);
  const columns = Array.from({ length: width }, (_, column) => column);
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: scrolling by keyboard needs the focus
    <section className="value-scroll" aria-label={`${name} as a table`} tabIndex={0}>
      <table className="value-table">
        {shape.length > 1 && (
          <thead>
            <tr>
              <th scope="col"> </th>
              {columns.map((column) => (
                <th key={column} scope="col">
                  {column * (steps.at(-1) ?? 1)}
                </th>
              ))}
            </tr>
          </thead>
        )}
        <tbody>
          {rows.map((row) => (
            <tr key={row}>
              <th scope="row">{placeOf(row, outer, steps)}</th>
              {columns.map((column) => (
                <td key={column}>{shortNumber(items[row * width + column] ?? Number.NaN)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** Index of a row in the original value: `12`, `3, 0`. */
function placeOf(row: number, outer: readonly number[], steps: readonly number[]): string {
  const place: number[] = [];
  let rest = row;
  for (let axis = outer.length - 1; axis >= 0; axis -= 1) {
    const count = outer[axis] ?? 1;
    place.unshift((rest % count) * (steps[axis] ?? 1));
    rest = Math.floor(rest / count);
  }
  return place.join(", ");
}

const PLOT = { width: 300, height: 84 };

export function NumbersPlot({ numbers: { items, steps }, name }: NumbersProps) {
  const [at, setAt] = useState<number | null>(null);
  const [least, greatest] = range(items) ?? [0, 1];
  const x = (index: number) => (index / Math.max(1, items.length - 1)) * PLOT.width;
  const y = (value: number) =>
    greatest === least
      ? PLOT.height / 2
      : 3 + ((greatest - value) / (greatest - least)) * (PLOT.height - 6);
  const point = (event: PointerEvent<SVGSVGElement>) => {
    const box = event.currentTarget.getBoundingClientRect();
    const share = (event.clientX - box.left) / Math.max(1, box.width);
    setAt(Math.max(0, Math.min(items.length - 1, Math.round(share * (items.length - 1)))));
  };
  const found = at === null ? undefined : items[at];
  return (
    <figure className="value-figure">
      <svg
        className="value-plot"
        role="img"
        aria-label={`${name}: ${items.length} numbers from ${shortNumber(least)} to ${shortNumber(greatest)}`}
        viewBox={`0 0 ${PLOT.width} ${PLOT.height}`}
        preserveAspectRatio="none"
        onPointerMove={point}
        onPointerLeave={() => setAt(null)}
      >
        <path d={pathOf(items, x, y)} />
        {at !== null && <line x1={x(at)} x2={x(at)} y1={0} y2={PLOT.height} />}
      </svg>
      <figcaption>
        <span>
          {shortNumber(least)} to {shortNumber(greatest)}
        </span>
        {at !== null && found !== undefined && (
          <output>
            [{at * (steps[0] ?? 1)}] = {shortNumber(found)}
          </output>
        )}
      </figcaption>
    </figure>
  );
}

/** Line through finite values, with gaps at others. */
function pathOf(
  items: readonly number[],
  x: (index: number) => number,
  y: (value: number) => number,
): string {
  let isOpen = false;
  const parts = items.map((value, index) => {
    const was = isOpen;
    isOpen = Number.isFinite(value);
    return isOpen ? `${was ? "L" : "M"}${x(index).toFixed(1)} ${y(value).toFixed(1)}` : "";
  });
  return parts.join("");
}

/** Image with one grey per number, or one colour per three or four numbers. */
export function NumbersImage({ numbers, name }: NumbersProps) {
  const place = useRef<HTMLCanvasElement>(null);
  const [height = 1, width = 1] = numbers.shape;
  const [least, greatest] = range(numbers.items) ?? [0, 1];
  const isInColour = isColoured(numbers);
  useEffect(() => {
    const context = place.current?.getContext("2d");
    if (!context) return;
    const image = context.createImageData(width, height);
    image.data.set(pixelsOf(numbers));
    context.putImageData(image, 0, 0);
  }, [numbers, width, height]);
  const [stepY = 1, stepX = 1] = numbers.steps;
  return (
    <figure className="value-figure">
      <canvas
        ref={place}
        className="value-image"
        role="img"
        aria-label={`${name}: ${height} by ${width} points`}
        width={width}
        height={height}
        style={{ aspectRatio: `${width * stepX} / ${height * stepY}` }}
      />
      <figcaption>
        {isInColour
          ? "as colours"
          : `${shortNumber(least)} is black, ${shortNumber(greatest)} is white`}
      </figcaption>
    </figure>
  );
}

/** Red, green, blue and opacity of each point. */
export function pixelsOf(numbers: NumberArray): Uint8ClampedArray {
  const { items, shape } = numbers;
  const [height = 1, width = 1, depth = 1] = shape;
  const [least, greatest] = range(items) ?? [0, 1];
  const isInColour = isColoured(numbers);
  const pixels = new Uint8ClampedArray(width * height * 4);
  const grey = (value: number) =>
    greatest === least ? 128 : ((value - least) / (greatest - least)) * 255;
  for (let point = 0; point < width * height; point += 1) {
    const first = items[point * depth] ?? 0;
    for (let channel = 0; channel < 3; channel += 1) {
      const value = isInColour ? (items[point * depth + channel] ?? 0) : grey(first);
      pixels[point * 4 + channel] = value;
    }
    pixels[point * 4 + 3] = 255;
  }
  return pixels;
}
