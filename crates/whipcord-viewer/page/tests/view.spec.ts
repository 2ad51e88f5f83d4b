import { ARTEFACTS, expect, near, set, test, tip, tipBySolve } from "./viewer";

/** The page's stations change the steps of the integration, by less than the error that it allows: 1e-6 of the length. */
const SAME = 1e-6;

test("shows the robot of the file", async ({ page, viewer }) => {
  await expect(page.locator("h1")).toHaveText("Two-segment arm");
  const expected = tipBySolve(viewer.file, (text) => text);
  const found = await tip(page, "cosserat");
  expect(near(found, expected, SAME), `${found} is not ${expected}`).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/light.png` });
  await page.emulateMedia({ colorScheme: "dark" });
  await page.screenshot({ path: `${ARTEFACTS}/dark.png` });
});

test("a slider moves the tip as the library says", async ({ page, viewer }) => {
  await set(page, "cable-3", "12.5");
  const expected = tipBySolve(viewer.file, (text) => text.replace("8 N", "12.5 N"));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
  // By the keyboard: one step of a thousandth of the range.
  const slider = page.locator('input[type="range"][data-name="cable-0"]');
  const before = Number(await slider.inputValue());
  await slider.focus();
  await slider.press("ArrowRight");
  const after = Number(await slider.inputValue());
  expect(after).toBeGreaterThan(before);
  const moved = tipBySolve(viewer.file, (text) => text.replace("8 N", "12.5 N").replace("14 N", `${after} N`));
  await expect.poll(async () => near(await tip(page, "cosserat"), moved, SAME)).toBe(true);
});

test("several models lie over each other", async ({ page, viewer }) => {
  await page.getByLabel("cosserat-disks").check();
  const expected = tipBySolve(viewer.file, (text) => text, "--model", "cosserat-disks");
  await expect.poll(async () => near(await tip(page, "cosserat-disks"), expected, SAME)).toBe(true);
  await page.getByLabel("pseudo-rigid-body").check();
  await expect(page.locator(".answer")).toHaveCount(3);
  await page.screenshot({ path: `${ARTEFACTS}/models.png` });
});

test("what has no solution keeps the last shape and says why", async ({ page, viewer }) => {
  void viewer;
  await set(page, "cable-0", "60000");
  await expect(page.locator('.answer[data-model="cosserat"]')).toHaveAttribute("data-status", "failed");
  await expect(page.locator("#status")).toContainText("cosserat:");
  await expect(page.locator("#status")).toContainText("in grey");
  await page.screenshot({ path: `${ARTEFACTS}/unsolvable.png` });
  await page.keyboard.press("Control+z");
  await expect(page.locator('.answer[data-model="cosserat"]')).toHaveAttribute("data-status", "solved");
  await expect(page.locator("#status")).toBeHidden();
});

test("the file is followed as it changes, and its mistakes are shown", async ({ page, viewer }) => {
  viewer.edit((text) => text.replace('length = "300 mm"', 'length = "300 mn"'));
  await expect(page.locator("#status")).toContainText("two-segment-arm.toml:7:");
  await page.screenshot({ path: `${ARTEFACTS}/broken.png` });
  viewer.edit((text) => text.replace("300 mn", "280 mm"));
  await expect(page.locator("#status")).toBeHidden();
  const expected = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("the address keeps the state, and undo, redo and reset go through it", async ({ page, viewer }) => {
  await set(page, "force-x", "0.25");
  await set(page, "cable-1", "3");
  const pulled = tipBySolve(viewer.file, (text) => text.replace("tension = \"1 N\"", "tension = \"3 N\"") + 'tip_force = ["0.25 N", "0 N", "0 N"]\n');
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  expect(page.url()).toContain("force=0.25,0,0");
  await page.reload();
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  await page.getByRole("button", { name: "Reset" }).click();
  const asInFile = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), asInFile, SAME)).toBe(true);
  expect(new URL(page.url()).hash).toBe("");
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  await page.getByRole("button", { name: "Redo" }).click();
  await expect.poll(async () => near(await tip(page, "cosserat"), asInFile, SAME)).toBe(true);
});
