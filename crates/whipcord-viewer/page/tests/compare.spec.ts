import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, set, solve, test } from "./viewer";

interface Answer {
  disks: { position: [number, number, number]; orientation: number[] }[];
}

const distance = (a: readonly number[], b: readonly number[]): number => Math.hypot(...a.map((c, k) => c - b[k]!));

test("one table compares the models: tip, difference, mean over the disks", async ({ page, viewer }) => {
  await expect(page.locator("#compare")).toHaveCount(0);
  await page.getByLabel("cosserat-disks").check();
  await page.getByLabel("pseudo-rigid-body").check();
  const row = (model: string) => page.locator(`tr[data-compared="${model}"]`);
  await expect(row("cosserat")).toContainText("reference");
  const [first, ...others] = ["cosserat", "cosserat-disks", "pseudo-rigid-body"].map((model) => {
    const { disks } = JSON.parse(solve(viewer.file, (text) => text, "--model", model)) as Answer;
    return { model, places: disks.map(({ position }) => position) };
  });
  for (const { model, places } of others) {
    const apart = places.map((place, k) => 1e3 * distance(place, first!.places[k]!));
    const mean = Math.sqrt(apart.reduce((sum, d) => sum + d * d, 0) / apart.length);
    const digits = (value: number): string => String(Number(value.toPrecision(3)));
    const cells = row(model).locator("td");
    await expect(cells.nth(1)).toHaveText(digits(apart.at(-1)!));
    await expect(cells.nth(2)).toHaveText(digits(apart.at(-1)! / 3));
    await expect(cells.nth(3)).toHaveText(digits(mean));
    await expect(cells.nth(4)).toContainText(/s$/);
  }
  await page.screenshot({ path: `${ARTEFACTS}/comparison.png` });
});

test("a shape is kept as a ghost, and what follows is compared with it", async ({ page, viewer }) => {
  void viewer;
  const ghost = page.getByRole("button", { name: "Ghost" });
  await ghost.click();
  await expect(ghost).toHaveAttribute("aria-pressed", "true");
  const before = JSON.parse((await page.locator(".answer").getAttribute("data-tip"))!) as number[];
  const cells = page.locator('tr[data-compared="cosserat"] td');
  await expect(cells.nth(1)).toHaveText("0");
  await set(page, "cable-0", "4");
  await expect.poll(async () => {
    const now = JSON.parse((await page.locator(".answer").getAttribute("data-tip"))!) as number[];
    const far = 1e3 * distance(now, before);
    return far > 5 && Math.abs(Number(await cells.nth(1).textContent()) - far) < 0.006 * far;
  }).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/ghost.png` });
  await ghost.click();
  await expect(page.locator("#compare")).toHaveCount(0);
});

/** What the legend of a chart says of a line. */
async function read(page: Page, chart: string, line: string): Promise<number> {
  const text = await page.locator(`figure[data-chart="${chart}"] .u-series`, { hasText: line }).locator(".u-value").first().textContent();
  return Number((text ?? "").replace("−", "-").replace(" mm", ""));
}

test("charts have the strains with their signs, values under pointer and keys, and zoom", async ({ page, viewer }) => {
  await set(page, "gravity-z", "0");
  // Without loads the curvature of the upper segment is constant: the angle between its ends over its length.
  const { disks } = JSON.parse(solve(viewer.file, (text) => text.replace('"9.81 m/s^2"', '"0"'))) as Answer;
  const [w, , y] = disks.at(-1)!.orientation;
  const [w0, , y0] = disks.at(-2)!.orientation;
  const angle = 2 * (Math.atan2(y!, w!) - Math.atan2(y0!, w0!));
  const chart = page.locator('figure[data-chart="bending-y"]');
  await expect(chart).toHaveCount(1);
  const plot = chart.locator(".plot");
  const spacing = 0.3 / (disks.length - 1);
  const over = chart.locator(".u-over");
  await over.scrollIntoViewIfNeeded();
  const box = (await over.boundingBox())!;
  await page.mouse.move(box.x + box.width - 2, box.y + box.height / 2);
  await expect.poll(async () => Math.abs((await read(page, "bending-y", "cosserat")) - angle / spacing)).toBeLessThan(2e-3 * Math.abs(angle / spacing));
  expect(angle).toBeLessThan(0);
  // The other charts of the same pointer read the same place.
  expect(await read(page, "tension", "s")).toBeCloseTo(await read(page, "bending-y", "s"), 6);
  await page.mouse.move(5, 5);
  // By keys from the left end.
  await plot.focus();
  await page.keyboard.press("Escape");
  await page.keyboard.press("ArrowRight");
  const first = await read(page, "bending-y", "s");
  await page.keyboard.press("ArrowRight");
  await expect.poll(() => read(page, "bending-y", "s")).toBeGreaterThan(first);
  await page.screenshot({ path: `${ARTEFACTS}/charts.png` });
  const values = async (): Promise<string | null> => plot.getAttribute("aria-label");
  expect(await values()).toMatch(/Bending κy in 1\/m along the robot, from −[\d.]+ to [\d.]+/);
  // Zoomed in by the pointer, it stays so while the robot moves; all is shown again by a key.
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, box.y + 20, { steps: 5 });
  await page.mouse.up();
  await page.mouse.move(box.x + 1, box.y + 20);
  await expect.poll(() => read(page, "bending-y", "s")).toBeGreaterThan(100);
  await set(page, "cable-3", "10");
  await page.mouse.move(box.x + 2, box.y + 22);
  await expect.poll(() => read(page, "bending-y", "s")).toBeGreaterThan(100);
  await plot.focus();
  await page.keyboard.press("Escape");
  await page.mouse.move(box.x + 3, box.y + 20);
  await expect.poll(() => read(page, "bending-y", "s")).toBeLessThan(20);
  await page.mouse.move(5, 5);
});

test("every quantity along the robot has a chart", async ({ page, viewer }) => {
  void viewer;
  await set(page, "moment-z", "20");
  const chips = page.locator(".chip");
  const names = await chips.evaluateAll((all) => all.map((chip) => (chip as HTMLElement).dataset["chart"]!));
  expect(names).toEqual([
    "bending-x", "bending-y", "curvature", "twist", "shear-x", "shear-y", "strain", "moment-x", "moment-y", "torsion", "moment", "tension", "contact",
  ]);
  for (const name of names) {
    const chip = page.locator(`.chip[data-chart="${name}"]`);
    if ((await chip.getAttribute("aria-pressed")) === "false") await chip.press("Enter");
    await expect(page.locator(`figure[data-chart="${name}"]`)).toHaveCount(1);
  }
  // A torque of 20 mN·m at the tip is the torsion of the backbone but for what the cables take, which the twist lays askew.
  await expect.poll(async () => {
    const range = (await page.locator('figure[data-chart="torsion"]').getAttribute("data-range"))!;
    const [least, most] = range.replace(/−/g, "-").match(/-?[\d.]+/g)!.map(Number) as [number, number];
    return least > 5 && most < 20;
  }).toBe(true);
  for (const name of names.slice(3)) await page.locator(`.chip[data-chart="${name}"]`).click();
  await expect(page.locator("#charts figure")).toHaveCount(3);
});

test("colours of what has a sign are centred at zero, others go from least to greatest", async ({ page, viewer }) => {
  void viewer;
  await page.getByLabel("Colour by").selectOption("bending-y");
  const legend = page.locator("#legend");
  await expect(legend).toContainText("bending κy in 1/m");
  const [least, most] = (await legend.locator("> span").allTextContents()).filter((text) => /^[−\d.]+$/.test(text));
  expect(least).toBe(`−${most}`);
  await set(page, "cable-1", "3");
  for (const cable of ["cable-2", "cable-4", "cable-5"]) await set(page, cable, "2");
  await page.getByLabel("Colour by").selectOption("tension");
  await expect(legend.locator("> span").nth(1)).toHaveText("2");
  await expect(legend.locator("> span").last()).toHaveText("14");
});

test.describe("a cable that is slack", () => {
  test.use({ example: "table1/case-3.toml" });

  test("is so at its slider, in the table and in the view", async ({ page, viewer }) => {
    void viewer;
    await page.getByRole("button", { name: "change between tension and shortening" }).click();
    await set(page, "cable-0", "-5");
    await expect(page.locator('.quantity:has([data-name="cable-0"]) .badge')).toHaveText("slack");
    await expect(page.locator("td.slack")).toHaveText("slack");
    await expect(page.locator("#labels .label", { hasText: "is slack" })).toBeVisible();
  });
});
