import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

/** The page asks the server that it came from; in development it is passed on to the one named here. */
const server = process.env["RAFCON_URL"] ?? "http://127.0.0.1:4747";

/** Asked as by the server's own page, which is the only one that it answers. */
const passedOn = { target: server, ws: true, changeOrigin: true, headers: { origin: server } };

/** Few files, for each request costs a round trip: what the page begins with, what the editor shows at first, all other panels
 * and dialogs, and the editor of scripts. Higher numbers take first what several need. */
const EDITOR =
  /src\/panels\/(inspector\/(?!code\/|script_code|script_conflict|skill_form|markdown)|libraries\/|globals\/|problems\/)|@lezer\/(python|lr|common|highlight)\//;
const GROUPS = [
  { name: "dock", test: /\/dockview|src\/app\/(dock|dock_control)\.tsx?$/, priority: 4 },
  { name: "page", test: /src\/app\/main\.tsx$/, priority: 5 },
  { name: "editor", test: EDITOR, priority: 3 },
  {
    name: "later",
    test: /src\/(panels\/(?!inspector\/|parts\/(pddl_|code_look))|app\/(dialogs\/|palette))/,
    priority: 2,
  },
  {
    name: "script",
    test: /(script_code|script_conflict|skill_form|pddl_field|text_difference)\.tsx$/,
    priority: 1,
  },
];

/** The page is written for React and shipped with Preact, which its own module makes complete. */
const REACT = fileURLToPath(new URL("src/ui/react.ts", import.meta.url));
const PREACT = [
  { find: /^react(-dom)?$/, replacement: REACT },
  { find: /^react-dom\/client$/, replacement: "preact/compat/client" },
  { find: /^react\/jsx-(dev-)?runtime$/, replacement: "preact/jsx-runtime" },
];

const isThemed = (selector: string) => selector.trim().startsWith(".dockview-theme-");

/** Leaves out of the dock what we have our own of, or none: the other kinds of docks, and its themes. */
const PART_OF_DOCK = {
  name: "part-of-dock",
  enforce: "pre" as const,
  transform: {
    filter: { id: /\/dockview-react\/.*\.(mjs|css)$/ },
    handler: (code: string, id: string) =>
      id.endsWith(".css")
        ? code
            .replaceAll(/\/\*.*?\*\//gs, "")
            .replaceAll(/([^{};]+)\{[^{}]*\}/g, (rule, selectors: string) =>
              selectors.split(",").every(isThemed) ? "" : rule,
            )
        : code
            .replaceAll("= React.forwardRef(", "= /* @__PURE__ */ React.forwardRef(")
            .replaceAll(/^\w+\.displayName = .*;$/gm, ""),
  },
};

export default defineConfig({
  // Whatever the path is below which a proxy offers the page.
  base: "./",
  resolve: { alias: PREACT },
  plugins: [PART_OF_DOCK],
  worker: { format: "es" },
  build: {
    target: "es2022",
    outDir: "dist",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 2000,
    rolldownOptions: {
      output: { codeSplitting: { groups: GROUPS } },
    },
  },
  server: { host: "127.0.0.1", proxy: { "/api": passedOn, "^/\\?token=[0-9a-f]{64}": passedOn } },
  test: {
    include: ["src/**/*.test.{ts,tsx}", "bench/**/*.test.ts"],
    environment: "node",
    server: { deps: { inline: [/lucide-react/, /dockview/] } },
  },
});
