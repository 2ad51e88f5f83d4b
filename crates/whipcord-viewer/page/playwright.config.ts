import { defineConfig } from "@playwright/test";

const target = process.env["VIEWER_ARTEFACTS"] ?? "../../../target/viewer";

// The browser is that of the system: none is downloaded.
export default defineConfig({
  testDir: "tests",
  outputDir: `${target}/playwright`,
  workers: 1,
  timeout: 120_000,
  // Solves are not optimised in debug, and machines are shared.
  expect: { timeout: 20_000 },
  reporter: "line",
  use: {
    browserName: "chromium",
    viewport: { width: 1400, height: 860 },
    launchOptions: {
      executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium",
      args: [
        "--no-sandbox",
        // WebGL by software.
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        // The rest of the page is put together faster without it.
        "--disable-gpu-compositing",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--no-first-run",
        // A page that tests put in place of the server's (PAGE_BUILT) is for the browser not of this machine.
        ...(process.env["PAGE_BUILT"] === undefined ? [] : ["--disable-features=LocalNetworkAccessChecks"]),
      ],
    },
  },
});
