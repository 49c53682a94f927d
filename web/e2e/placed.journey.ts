/** Boxes stand on the canvas where the files say: the files are read here, and the picture's pixels are looked at. */

import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import { type Box, intersects } from "../src/model/geometry.ts";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import { AROUND, boxShown } from "./support/pixels.ts";
import { EXAMPLES } from "./support/places.ts";
import { asName, share, shippedLibraries } from "./support/reference.ts";

/** Of those that the reference ships, some of each kind of drawing; and one of ours. */
const SHIPPED = [
  "examples/tutorials/99_bugs",
  "examples/tutorials/99_bottles_of_beer",
  "examples/tutorials/print_info_and_wait",
  "examples/functionality_examples/backward_step_preemption",
  "examples/functionality_examples/backward_step_hierarchy",
  "examples/functionality_examples/hierarchy_abortion_handling",
];

interface Items {
  readonly items: readonly [number, number];
}

interface LayoutFile {
  readonly gui: { readonly editor_gaphas: { readonly rel_pos: Items; readonly size: Items } };
}

/** Where the file of a state puts it, in its container. */
function boxOf(folder: string): Box {
  const file = JSON.parse(readFileSync(join(folder, "meta_data.json"), "utf8")) as LayoutFile;
  const { rel_pos, size } = file.gui.editor_gaphas;
  const [x, y] = rel_pos.items;
  const [width, height] = size.items;
  return { x, y, width, height };
}

/** The boxes of the children of the root, by their folders. */
function boxesIn(machine: string): ReadonlyMap<string, Box> {
  const folders = readdirSync(machine, { withFileTypes: true }).filter(
    (entry) => entry.isDirectory() && entry.name !== "__pycache__",
  );
  return new Map(folders.map(({ name }) => [name, boxOf(join(machine, name))]));
}

/** Boxes with nothing else around them that the look at pixels could take for them. */
function alone(boxes: readonly Box[], away: number): readonly Box[] {
  const wide = ({ x, y, width, height }: Box): Box => ({
    x: x - away,
    y: y - away,
    width: width + 2 * away,
    height: height + 2 * away,
  });
  return boxes.filter((box) =>
    boxes.every((other) => other === box || !intersects(wide(box), wide(other))),
  );
}

/** Looks at each child of the root, and counts those that could be looked at. */
async function look(app: App, machine: string): Promise<number> {
  const root = await app.sheet.evaluate(() => window.__rafcon.context().tab?.session.machine.root);
  await app.press("t");
  await app.until(({ tab }) => tab?.view.modes.value.transitions === false, null);
  await app.drawn();
  const shown = await app.box(root ?? "");
  const scale = shown.width / boxOf(machine).width;
  const boxes = alone([...boxesIn(machine).values()], (2 * AROUND) / scale);
  for (const box of boxes) {
    const corner = await app.spot(root ?? "", box.x, box.y);
    const expected = { ...corner, width: box.width * scale, height: box.height * scale };
    const found = await boxShown(app, expected);
    const wrong = [
      found.x - expected.x,
      found.y - expected.y,
      found.width - expected.width,
      found.height - expected.height,
    ];
    for (const off of wrong) {
      expect(Math.abs(off), `${JSON.stringify({ machine, box, expected, found })}`).toBeLessThan(3);
    }
  }
  return boxes.length;
}

journey(
  "boxes of our examples stand where their files say",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    expect(await look(app, join(EXAMPLES, "hierarchy_and_data"))).toBeGreaterThan(1);
  },
);

for (const path of SHIPPED) {
  const [name, folder] = [asName(path), join(share(), path)];
  journey(
    `boxes of the reference's ${path} stand where its files say`,
    { open: name, machines: { [name]: folder }, libraries: shippedLibraries() },
    async ({ app }) => {
      expect(await look(app, folder)).toBeGreaterThan(0);
    },
  );
}
