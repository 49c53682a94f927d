/** The layout engine, in a worker of its own, so that the page goes on while it thinks. */

import type { ELK } from "elkjs/lib/elk-api.js";
import type { Layouter } from "../plan/arrange.ts";

let engine: Promise<ELK> | null = null;

/** Lays a graph out; the engine comes with the first one. */
export const layOut: Layouter = async (graph) => {
  engine ??= start();
  return (await engine).layout(graph);
};

async function start(): Promise<ELK> {
  const [{ default: Engine }, { default: EngineWorker }] = await Promise.all([
    import("elkjs/lib/elk-api.js"),
    import("elkjs/lib/elk-worker.min.js?worker"),
  ]);
  return new Engine({ workerFactory: () => new EngineWorker() });
}
