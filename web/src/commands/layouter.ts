/** The layout engine in a worker, so that the page stays responsive. */

import type { ELK } from "elkjs/lib/elk-api.js";
import type { Layouter } from "../plan/arrange.ts";

interface Engine {
  readonly elk: Promise<ELK>;
  /** Rejects once the engine is abandoned. */
  readonly abandoned: Promise<never>;
  readonly abandon: () => void;
}

let engine: Engine | null = null;

/** Lays a graph out; the engine comes with the first one. */
export const layOut: Layouter = async (graph) => {
  engine ??= start();
  const { elk, abandoned } = engine;
  return Promise.race([elk.then((started) => started.layout(graph)), abandoned]);
};

/** Ends the engine with all that it computes, which then fails; the next layout has another one. */
export function abandonLayout(): void {
  engine?.abandon();
  engine = null;
}

function start(): Engine {
  const elk = load();
  let reject: (reason: Error) => void = () => {};
  const abandoned = new Promise<never>((_, fail) => {
    reject = fail;
  });
  abandoned.catch(() => {});
  return {
    elk,
    abandoned,
    abandon: () => {
      reject(new Error("the layout was cancelled"));
      void elk.then(
        (started) => started.terminateWorker(),
        () => {},
      );
    },
  };
}

async function load(): Promise<ELK> {
  const [{ default: Engine }, { default: EngineWorker }] = await Promise.all([
    import("elkjs/lib/elk-api.js"),
    import("elkjs/lib/elk-worker.min.js?worker"),
  ]);
  return new Engine({ workerFactory: () => new EngineWorker() });
}
