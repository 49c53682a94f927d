/** Makes layouts real in the dock, keeps what the user does to them, and shows and folds panels. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import type { DockviewApi, DockviewGroupPanel, SerializedDockview } from "dockview-react";
import type { Layouts, PanelSide } from "../commands/command.ts";
import { MISSION_PANEL } from "../commands/mission.ts";
import { kept, type LocalStore } from "../store/local_store.ts";
import { LAYOUT_KEY, type PanelLayout, SHIPPED, sizeOn, withPanels } from "./layouts.ts";
import { placeMission, sizeMission } from "./mission_place.ts";
import { PANELS, panelOf } from "./panels.tsx";
import type { DockPort } from "./session.ts";

/** In the order in which they are put beside the canvas. */
const SIDES: readonly PanelSide[] = ["bottom", "left", "right"];

const OWN = "rafcon.layouts";
const FOLDED = "rafcon.folded";
const SIZES = "rafcon.sizes";
const CANVAS = "canvas";
const OPPOSITE: Readonly<Record<PanelSide, "left" | "right" | "below">> = {
  left: "left",
  right: "right",
  bottom: "below",
};

/** Shares of the dock, because the dock itself grows and shrinks while a group is hidden. */
interface GroupShare {
  readonly width: number;
  readonly height: number;
}

/** The dock caches the position of the canvas for one or two frames; earlier measurements may be outdated. */
const CALM_MS = 100;

export class DockControl implements DockPort {
  readonly #api: DockviewApi;
  readonly #localStore: LocalStore;
  readonly #changes = signal(0);
  readonly #stop: () => void;
  #isNarrow = false;

  constructor(api: DockviewApi, localStore: LocalStore) {
    this.#api = api;
    this.#localStore = localStore;
    const listening = api.onDidLayoutChange(() => {
      this.#changes.value = this.#changes.peek() + 1;
      this.#keep();
    });
    this.#stop = () => listening.dispose();
  }

  /** Changes with each new arrangement of the panels. */
  get changes(): ReadonlySignal<number> {
    return this.#changes;
  }

  dispose(): void {
    this.#stop();
  }

  /** As the page was left, or as a layout that ships. */
  restore(first: string): void {
    const before = kept<SerializedDockview>(this.#localStore, LAYOUT_KEY);
    if (!before || !this.#load(before)) this.#build(SHIPPED[first] ?? {});
  }

  /** On a narrow page mission control is above the canvas, and nothing below; true if that changes its place. */
  stack(isNarrow: boolean): boolean {
    this.#isNarrow = isNarrow;
    const isMoved = placeMission(this.#api, isNarrow);
    if (isMoved && this.#groups("bottom").length > 0) this.#show("bottom", !isNarrow);
    // The position of the canvas is measured after a change of its size, which therefore comes last.
    if (isMoved) setTimeout(() => sizeMission(this.#api, isNarrow), CALM_MS);
    return isMoved;
  }

  /** On a small page sides fold, so that the canvas has the room; once it is large again they are there again. What is folded or
   * shown by hand meanwhile stays so, also when the page is loaded again. */
  fold(isSmall: boolean): void {
    const folded = kept<PanelSide[]>(this.#localStore, FOLDED);
    if (isSmall === (folded !== undefined) || this.#api.getPanel(MISSION_PANEL)) return;
    const sides = folded ?? SIDES.filter((side) => this.layouts.isShown(side));
    for (const side of sides) this.#show(side, !isSmall);
    // Each side that is shown takes room from those before it.
    if (!isSmall)
      for (const side of sides) for (const group of this.#groups(side)) this.#sizeAgain(group);
    this.#localStore.put(FOLDED, isSmall ? sides : undefined);
  }

  readonly isInSight = (id: string): boolean => {
    this.#changes.value;
    return this.#api.getPanel(id)?.api.isVisible === true;
  };

  showPanel = (id: string): void => {
    const panel = panelOf(id);
    if (!panel) return;
    const there = this.#api.getPanel(id) ?? this.#add(id, panel.side);
    if (!there.group.api.isVisible) there.group.api.setVisible(true);
    there.api.setActive();
  };

  dock = (ids: readonly string[]): void => {
    for (const id of ids) {
      const panel = this.#api.getPanel(id);
      const side = panelOf(id)?.side;
      if (!panel || !side) continue;
      const [neighbour] = this.#groups(side);
      if (neighbour) panel.api.moveTo({ group: neighbour });
      else {
        panel.api.close();
        this.#add(id, side);
      }
    }
  };

  readonly layouts: Layouts = {
    names: () => [...Object.keys(SHIPPED), ...this.layouts.own()],
    own: () => Object.keys(this.#own()),
    apply: (name) => {
      const own = this.#own()[name];
      if (own && this.#load(own)) return;
      const shipped = SHIPPED[name];
      if (shipped) this.#build(shipped);
    },
    save: (name) => {
      const own = this.#own();
      this.#localStore.put(OWN, { ...own, [name]: this.#api.toJSON() });
    },
    remove: (name) => {
      const own = this.#own();
      this.#localStore.put(
        OWN,
        Object.fromEntries(Object.entries(own).filter(([key]) => key !== name)),
      );
    },
    isShown: (side) => {
      this.#changes.value;
      if (this.#api.hasMaximizedGroup()) return false;
      return this.#groups(side).some((group) => group.api.isVisible);
    },
    toggle: (side) => this.#show(side, !this.layouts.isShown(side)),
    toggleFocus: () => {
      const canvas = this.#api.getPanel(CANVAS);
      if (this.#api.hasMaximizedGroup()) this.#api.exitMaximizedGroup();
      else if (canvas) this.#api.maximizeGroup(canvas);
    },
    panels: () => PANELS.map(({ id, title }) => ({ id, title })),
  };

  /** A group that is hidden gets its size back later, also after a reload. */
  #keepSizes(groups: readonly DockviewGroupPanel[]): void {
    const { width, height } = this.#api;
    if (width === 0 || height === 0) return;
    const kept = groups
      .filter(({ api }) => api.isVisible)
      .map(({ id, api }) => [id, { width: api.width / width, height: api.height / height }]);
    this.#localStore.put(SIZES, { ...this.#sizes(), ...Object.fromEntries(kept) });
  }

  #sizeAgain({ id, api }: DockviewGroupPanel): void {
    const share = this.#sizes()[id];
    if (!share) return;
    const { width, height } = this.#api;
    api.setSize({ width: share.width * width, height: share.height * height });
  }

  #sizes(): Readonly<Record<string, GroupShare>> {
    const groups = new Set(this.#api.groups.map(({ id }) => id));
    const all = kept<Record<string, GroupShare>>(this.#localStore, SIZES) ?? {};
    return Object.fromEntries(Object.entries(all).filter(([id]) => groups.has(id)));
  }

  #own(): Readonly<Record<string, SerializedDockview>> {
    return kept(this.#localStore, OWN) ?? {};
  }

  #show(side: PanelSide, shown: boolean): void {
    if (this.#api.hasMaximizedGroup()) this.#api.exitMaximizedGroup();
    const groups = this.#groups(side);
    if (groups.length === 0 && shown) {
      for (const panel of PANELS) if (panel.side === side) this.showPanel(panel.id);
    }
    if (!shown) this.#keepSizes(groups);
    for (const group of groups) group.api.setVisible(shown);
    if (shown) for (const group of groups) this.#sizeAgain(group);
    this.#changes.value = this.#changes.peek() + 1;
  }

  /** Groups of the grid on one side: where most of their panels belong. */
  #groups(side: PanelSide): DockviewGroupPanel[] {
    return this.#api.groups.filter((group) => {
      const [first] = group.panels;
      return group.api.location.type === "grid" && panelOf(first?.id ?? "")?.side === side;
    });
  }

  #add(id: string, side: PanelSide) {
    const [neighbour] = this.#groups(side);
    const title = panelOf(id)?.title ?? id;
    if (neighbour) {
      return this.#api.addPanel({
        id,
        component: id,
        title,
        position: { referenceGroup: neighbour },
      });
    }
    const size = SHIPPED["Edit"]?.[side]?.size ?? 280;
    return this.#api.addPanel({
      id,
      component: id,
      title,
      position: { direction: OPPOSITE[side] },
      ...(side === "bottom" ? { initialHeight: size } : { initialWidth: size }),
    });
  }

  #build(wanted: PanelLayout): void {
    const known = withPanels(wanted, (id) => panelOf(id) !== undefined);
    const { bottom: _, ...stacked } = known;
    const layout: PanelLayout = this.#isNarrow && known.left?.isTall ? stacked : known;
    this.#api.clear();
    const canvas = this.#api.addPanel({ id: CANVAS, component: CANVAS, renderer: "always" });
    for (const side of SIDES) {
      this.#buildSide(side, layout[side], canvas.group);
    }
    this.#settleCanvas();
    this.#size(layout);
    sizeMission(this.#api, this.#isNarrow);
    canvas.api.setActive();
  }

  /** Sides come one after the other, and each takes some room from those before it: so they are measured at last. */
  #size(layout: PanelLayout): void {
    for (const side of SIDES) {
      const wanted = layout[side];
      const group = this.#api.getPanel(wanted?.groups[0]?.[0] ?? "")?.group;
      if (!group || !wanted) continue;
      const size = sizeOn(this.#api, side, wanted);
      group.api.setSize(side === "bottom" ? { height: size } : { width: size });
    }
  }

  #buildSide(side: PanelSide, wanted: PanelLayout[PanelSide], centre: DockviewGroupPanel): void {
    let before: DockviewGroupPanel | undefined;
    for (const [first = "", ...others] of wanted?.groups ?? []) {
      const size = wanted?.size ?? 280;
      const panel = this.#api.addPanel({
        id: first,
        component: first,
        title: panelOf(first)?.title ?? first,
        position: before
          ? { referenceGroup: before, direction: side === "bottom" ? "right" : "below" }
          : this.#firstPlace(side, wanted?.isTall === true, centre),
        ...(side === "bottom" ? { initialHeight: size } : { initialWidth: size }),
      });
      before = panel.group;
      for (const id of others) {
        this.#api.addPanel({
          id,
          component: id,
          title: panelOf(id)?.title ?? id,
          position: { referenceGroup: panel.group },
          inactive: true,
        });
      }
    }
  }

  /** At the edge of the page, or beside the canvas alone. */
  #firstPlace(side: PanelSide, isTall: boolean, centre: DockviewGroupPanel) {
    if (isTall && this.#isNarrow) return { direction: "above" as const };
    if (side === "right" || isTall) return { direction: OPPOSITE[side] };
    return { referenceGroup: centre, direction: OPPOSITE[side] };
  }

  /** The canvas has no tab, is never closed, and nothing is put over it. */
  #settleCanvas(): void {
    const group = this.#api.getPanel(CANVAS)?.group;
    if (!group) return;
    group.header.hidden = true;
    group.locked = true;
  }

  #load(layout: SerializedDockview): boolean {
    try {
      const known = Object.keys(layout.panels).every((id) => id === CANVAS || panelOf(id));
      if (!known || !layout.panels[CANVAS]) return false;
      this.#api.fromJSON(layout);
      this.#settleCanvas();
      return true;
    } catch {
      this.#api.clear();
      return false;
    }
  }

  #keep(): void {
    if (this.#api.getPanel(CANVAS)) this.#localStore.put(LAYOUT_KEY, this.#api.toJSON());
  }
}
