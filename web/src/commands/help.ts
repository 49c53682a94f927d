/** Commands of the Help menu, and the palette. */

import type { UserCommand } from "./command.ts";

export const HELP: readonly UserCommand[] = [
  {
    id: "help.palette",
    title: "Search everything…",
    detail: "Finds commands, states, machines and libraries.",
    keys: ["Ctrl+K"],
    menu: "Help/1",
    run: ({ shell }, argument) => shell.openPalette(argument),
  },
  {
    id: "help.commands",
    title: "All commands…",
    keys: ["Ctrl+Shift+P", "F1"],
    menu: "Help/1",
    run: ({ shell }) => shell.openPalette(">"),
  },
  {
    id: "help.keys",
    title: "Keys…",
    detail: "Shows and changes all keys.",
    keys: ["?"],
    menu: "Help/1",
    run: async ({ shell }) => {
      await shell.dialog("keys", undefined);
    },
  },
  {
    id: "help.settings",
    title: "Settings…",
    keys: ["Ctrl+,"],
    menu: "Help/2",
    run: async ({ shell }) => {
      await shell.dialog("settings", undefined);
    },
  },
  {
    id: "help.about",
    title: "About RAFCON",
    menu: "Help/3",
    run: async ({ shell }) => {
      await shell.dialog("about", undefined);
    },
  },
];
