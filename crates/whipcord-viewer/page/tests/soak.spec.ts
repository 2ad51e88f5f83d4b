import type { CDPSession, Page } from "@playwright/test";

import { expect, test } from "./viewer";

/** A minute for who wants it: `SOAK_SECONDS=60 npx playwright test soak`. */
const SECONDS = Number(process.env["SOAK_SECONDS"] ?? 6);

interface Held {
  /** Of JavaScript, after what is not needed has been collected, in MiB. */
  heap: number;
  /** Elements of the page. */
  nodes: number;
  /** Objects of WebGL. */
  graphics: number;
}

async function held(page: Page, session: CDPSession): Promise<Held> {
  await session.send("HeapProfiler.collectGarbage");
  const { metrics } = await session.send("Performance.getMetrics");
  const of = (name: string): number => metrics.find((metric) => metric.name === name)?.value ?? NaN;
  const graphics = await page.evaluate(() => (window as unknown as { held: number }).held);
  return { heap: of("JSHeapUsedSize") / 2 ** 20, nodes: of("Nodes"), graphics };
}

/** Moves the sliders of all cables at each picture of the display; how many of the frames that came were drawn, and in which time. */
async function move(page: Page, seconds: number): Promise<{ frames: number; elapsed: number }> {
  return page.evaluate(async (seconds) => {
    const sliders = [...document.querySelectorAll<HTMLInputElement>('input[type="range"][data-name^="cable-"]')];
    const view = document.getElementById("view")!;
    let frames = 0;
    const watching = new MutationObserver(() => frames++);
    watching.observe(view, { attributeFilter: ["data-frame"] });
    const begun = performance.now();
    for (let now = 0; now < 1e3 * seconds; now = performance.now() - begun) {
      sliders.forEach((slider, k) => {
        slider.value = String(Number(slider.max) * (0.25 + 0.2 * Math.sin((now / 1e3) * (1 + 0.3 * k))));
        slider.dispatchEvent(new Event("input"));
      });
      await new Promise(requestAnimationFrame);
    }
    watching.disconnect();
    return { frames, elapsed: (performance.now() - begun) / 1e3 };
  }, seconds);
}

for (const example of ["two-segment-arm.toml", "contact/among-bodies.toml"]) {
  test.describe(example, () => {
    test.use({ example });

    test("the sliders move for long, and nothing grows", async ({ page, viewer }) => {
      test.setTimeout(1e3 * (120 + 3 * SECONDS));
      // What WebGL makes and gives back is counted from the start of the page on.
      await page.addInitScript(() => {
        const counted = window as unknown as { held: number };
        counted.held = 0;
        const context = WebGL2RenderingContext.prototype;
        const count = (name: `${"create" | "delete"}${"Buffer" | "Program" | "Texture" | "VertexArray"}`, by: number): void => {
          const own = context[name] as (...given: unknown[]) => unknown;
          (context as unknown as Record<string, unknown>)[name] = function (this: unknown, ...given: unknown[]): unknown {
            counted.held += by;
            return own.apply(this, given);
          };
        };
        for (const kind of ["Buffer", "Program", "Texture", "VertexArray"] as const) {
          count(`create${kind}`, 1);
          count(`delete${kind}`, -1);
        }
      });
      await page.reload();
      await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
      const session = await page.context().newCDPSession(page);
      await session.send("Performance.enable");
      await move(page, 2);
      const before = await held(page, session);
      const { frames, elapsed } = await move(page, SECONDS);
      const after = await held(page, session);
      console.log(
        `${example}: ${(frames / elapsed).toFixed(1)} frames a second for ${elapsed.toFixed(1)} s; ` +
          `heap ${before.heap.toFixed(2)} MiB, then ${after.heap.toFixed(2)}; elements ${before.nodes}, then ${after.nodes}; ` +
          `objects of WebGL ${before.graphics}, then ${after.graphics}`,
      );
      expect(frames).toBeGreaterThan(0);
      // What waits to be collected differs by up to 2 MiB from run to run.
      expect(after.heap - before.heap).toBeLessThan(3);
      // Elements that were replaced wait to be collected for a while.
      expect(after.nodes).toBeLessThan(1.5 * before.nodes + 500);
      expect(after.graphics).toBeLessThanOrEqual(before.graphics + 12);
      // Nor when the file is saved again and again.
      for (let k = 0; k < 6; k++) {
        viewer.edit((text) => `${text}\n`);
        await page.waitForTimeout(700);
      }
      expect((await held(page, session)).graphics).toBeLessThanOrEqual(before.graphics + 12);
    });
  });
}
