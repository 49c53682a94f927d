import fc from "fast-check";
import { describe, expect, test } from "vitest";
import { childBoxesOf } from "./default_places.ts";
import type { StateDocument } from "./generated/protocol.ts";
import { type Box, intersects } from "./geometry.ts";
import { defaultChildBox } from "./layout_reader.ts";

function state(box?: Box): StateDocument {
  const { x = 0, y = 0, width = 0, height = 0 } = box ?? {};
  const layout = { gui: { editor_gaphas: { rel_pos: [x, y], size: [width, height] } } };
  return { path: "A", name: "A", kind: "execution", ...(box && { layout }) };
}

function overlaps(boxes: readonly Box[]): number {
  return boxes.filter((one, index) =>
    boxes.slice(index + 1).some((other) => intersects(one, other)),
  ).length;
}

describe("states without a place", () => {
  const size = { width: 100, height: 100 };

  test("few of them stand where the reference puts them", () => {
    const boxes = childBoxesOf([state(), state(), state()], size);
    expect(boxes).toEqual([0, 1, 2].map((index) => defaultChildBox(index, size)));
  });

  test.each([10, 17, 400])("%i of them do not overlap", (count) => {
    const boxes = childBoxesOf(
      Array.from({ length: count }, () => state()),
      size,
    );
    expect(boxes).toHaveLength(count);
    expect(overlaps(boxes)).toBe(0);
  });

  test("they stand beside those that have a place, inside of the container", () => {
    const part = fc.double({ min: 0, max: 60, noNaN: true });
    const drawn = fc.record({ x: part, y: part, width: fc.constant(14), height: fc.constant(9) });
    const children = fc.array(fc.option(drawn, { nil: undefined }), {
      minLength: 1,
      maxLength: 14,
    });
    fc.assert(
      fc.property(children, (places) => {
        const boxes = childBoxesOf(places.map(state), size);
        boxes.forEach((box, index) => {
          if (places[index]) return;
          const others = boxes.filter((_, other) => other !== index);
          expect(others.some((other) => intersects(box, other))).toBe(false);
          expect(Math.max(box.x + box.width, box.y + box.height)).toBeLessThanOrEqual(100);
        });
      }),
    );
  });
});
