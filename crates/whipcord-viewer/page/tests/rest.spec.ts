import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, test } from "./viewer";

interface Held {
  handle: [number, number];
  spring: [number, number] | undefined;
  words: string[];
}

async function held(page: Page): Promise<Held> {
  return page.evaluate(() => {
    const { handle, spring } = document.getElementById("canvas")!.dataset;
    const labels = [...document.querySelectorAll<HTMLElement>("#labels .label")].filter((label) => label.style.display !== "none");
    return { handle: JSON.parse(handle!), spring: spring && JSON.parse(spring), words: labels.map((label) => label.textContent!) };
  });
}

/** Waits until no answer has come for a while. */
async function settled(page: Page): Promise<void> {
  let [frame, since] = ["", Date.now()];
  await expect.poll(async () => {
    const now = (await page.locator("#view").getAttribute("data-frame"))!;
    if (now !== frame) [frame, since] = [now, Date.now()];
    return Date.now() - since;
  }, { timeout: 60_000 }).toBeGreaterThan(900);
}

/** What keeps the handle from the pointer, in words. */
const LIMIT = /mm away: \S|gives way at|no equilibrium beyond|cannot be moved/;

// Straight, helical, in contact by one side and by many, and so soft that it folds.
for (const example of ["two-segment-arm.toml", "helical-finger.toml", "contact/among-bodies.toml", "contact/gripping-finger.toml", "soft-finger.toml", "table1/case-2.toml"]) {
  test.describe(example, () => {
    test.use({ example });

    test("what is dragged rests within 3 pixels of the pointer, or what keeps it from there is shown", async ({ page, viewer }) => {
      void viewer;
      const box = (await page.locator("#canvas").boundingBox())!;
      for (const mode of ["force", "reach"] as const) {
        await page.locator(`#drag-${mode}`).check();
        // The last one is farther away than the robot is long.
        for (const [x, y] of [[25, 15], [-120, 70], [-330, 250]] as const) {
          await settled(page);
          await page.waitForTimeout(400);
          const { handle: [left, top] } = await held(page);
          const pointer = [left + x, top + y] as const;
          await page.mouse.move(box.x + left, box.y + top);
          await page.mouse.down();
          await page.mouse.move(box.x + pointer[0], box.y + pointer[1], { steps: 12 });
          await settled(page);
          const now = await held(page);
          const place = mode === "force" ? now.spring! : now.handle;
          const off = Math.hypot(place[0] - pointer[0], place[1] - pointer[1]);
          const words = now.words.filter((each) => LIMIT.test(each));
          if (off >= 3) expect(words, `${mode} ${x} ${y}: ${off.toFixed(1)} pixels off`).toHaveLength(1);
          // A spring that rests, or says why it does not.
          if (mode === "force" && words.length === 0) expect(await page.locator("#canvas").getAttribute("data-rests")).toBe("true");
          await page.screenshot({ path: `${ARTEFACTS}/rest/${example.replace(/\W/g, "-")}-${mode}${x}.png` });
          await page.mouse.up();
          await page.keyboard.press("Control+z");
        }
      }
    });
  });
}
