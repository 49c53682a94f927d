/** Chromium as journeys and benches start it: without a GPU, and without what costs time beside the page. */

import { type Browser, chromium } from "playwright-core";

const CHROMIUM = process.env["RAFCON_CHROMIUM"] ?? "/usr/bin/chromium";

/** Each is a renderer of its own for every window, though the window is never seen: together they cost a third of a short journey. */
const BESIDE_THE_PAGE = [
  "SpareRendererForSitePerProcess",
  "WebUIOmniboxAimPopup",
  "WebUIOmniboxPopup",
];

/** What Playwright turns off, as far as it matters here: Chromium heeds only the last list that it is given. */
const AS_PLAYWRIGHT = [
  "AimEnabled",
  "AvoidUnnecessaryBeforeUnloadCheckSync",
  "DestroyProfileOnBrowserClose",
  "HttpsFirstBalancedModeAutoEnable",
  "HttpsUpgrades",
  "MediaRouter",
  "NetworkTimeServiceQuerying",
  "OptimizationHints",
  "PaintHolding",
  "PreconnectToSearch",
  "ThirdPartyStoragePartitioning",
];

export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--force-device-scale-factor=1",
      `--disable-features=${[...AS_PLAYWRIGHT, ...BESIDE_THE_PAGE].join(",")}`,
    ],
  });
}
