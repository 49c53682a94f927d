/** A robot and its station on one computer. */

import { cpSync, renameSync, rmSync } from "node:fs";
import { join } from "node:path";
import { newPlace, type Place } from "./places.ts";
import { callIn, Server } from "./server.ts";

/** A station, and a robot of that place that is paired with it: `scout`. */
export async function beginStation(place: Place): Promise<readonly [Server, Server]> {
  const ground = newPlace({});
  const line = callIn(place, ["pair", "scout"]);
  callIn(ground, ["pair", "--paste"], line);
  const station = await Server.start(ground, "station", [
    "--listen",
    "127.0.0.1:0",
    "--link",
    "lan",
  ]);
  const link = ["--station", station.radio, "--link", "lan"];
  return [station, await Server.start(place, "serve", link)];
}

/** Keeps how a run on this robot is now on its disk; the returned function puts the disk back to that. The robot's server must not
 * run then. */
export function keepDisk({ place }: Server, run: string): () => void {
  const [folder, kept] = [join(place.folder, "runs", run), join(place.folder, "kept")];
  cpSync(folder, kept, { recursive: true, filter: (file) => !file.endsWith("/socket") });
  return () => {
    rmSync(folder, { recursive: true });
    renameSync(kept, folder);
  };
}
