import { readdirSync } from "node:fs";
import { join } from "node:path";

import { ARTEFACTS, expect, ROOT, test } from "./viewer";

/** All robot files among the examples. */
function files(folder = "examples"): string[] {
  return readdirSync(join(ROOT, folder), { withFileTypes: true }).flatMap((entry) => {
    const name = `${folder}/${entry.name}`;
    if (entry.isDirectory()) return files(name);
    // What others extend is no robot by itself.
    return entry.name.endsWith(".toml") && entry.name !== "prototype.toml" ? [name.replace("examples/", "")] : [];
  });
}

/** `SCREENSHOTS=1` takes pictures in both colour schemes and sizes. */
const looks = [
  { name: "wide", width: 1440, height: 900, colorScheme: "light" },
  { name: "narrow-dark", width: 390, height: 844, colorScheme: "dark" },
  ...(process.env["SCREENSHOTS"] === undefined ? [] : [
    { name: "wide-dark", width: 1440, height: 900, colorScheme: "dark" },
    { name: "narrow", width: 390, height: 844, colorScheme: "light" },
  ] as const),
] as const;

for (const example of files()) {
  test.describe(example, () => {
    test.use({ example });

    test("is shown wide and narrow, light and dark, with its tip in sight", async ({ page, viewer }) => {
      void viewer;
      for (const { name, width, height, colorScheme } of looks) {
        await page.setViewportSize({ width, height });
        await page.emulateMedia({ colorScheme });
        await page.reload();
        await expect(page.locator('.answer[data-status="solved"]').first()).toBeVisible();
        await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
        const size = (await page.locator("#canvas").boundingBox())!;
        await expect.poll(async () => {
          const [x, y] = JSON.parse((await page.locator("#canvas").getAttribute("data-handle"))!) as [number, number];
          return x > 0 && y > 0 && x < size.width && y < size.height;
        }, { message: name }).toBe(true);
        // No word lies on the axes in the corner, whose circle is within this square.
        const corner = [size.x + size.width - 110, size.y + 46, size.x + size.width - 2, size.y + 154] as const;
        const onCorner = await page.locator("#labels .label:visible").evaluateAll((labels, [left, top, right, bottom]) =>
          labels.filter((label) => {
            const box = label.getBoundingClientRect();
            return box.left < right && box.right > left && box.top < bottom && box.bottom > top;
          }).map((label) => label.textContent), corner);
        expect(onCorner).toEqual([]);
        expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
        await page.screenshot({ path: `${ARTEFACTS}/examples/${example.replace(/[/.]/g, "-")}-${name}.png` });
      }
    });
  });
}
