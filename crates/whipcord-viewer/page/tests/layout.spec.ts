import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, near, set, test, tip, tipBySolve } from "./viewer";

async function place(page: Page): Promise<[number, number]> {
  return JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[]") as [number, number];
}

async function size(page: Page): Promise<{ width: number; height: number }> {
  return (await page.locator("#canvas").boundingBox())!;
}

test("sliders of what has both signs have zero in their middle, and the last solution is marked with its unit", async ({ page, viewer }) => {
  void viewer;
  const track = page.locator('.quantity:has([data-name="force-x"]) .track');
  const [zero, whole] = [(await track.locator(".zero").boundingBox())!, (await track.boundingBox())!];
  expect(Math.abs(zero.x + zero.width / 2 - (whole.x + whole.width / 2))).toBeLessThan(1.5);
  await expect(page.locator('.quantity:has([data-name="cable-0"]) .zero')).toBeHidden();
  // Wide: nearly as the panel.
  expect(whole.width).toBeGreaterThan(250);
  const mark = page.locator('.quantity:has([data-name="cable-0"]) .mark');
  await expect(mark).toBeHidden();
  await set(page, "cable-0", "60000");
  await expect(mark).toHaveText("last solution at 14 N");
  await page.screenshot({ path: `${ARTEFACTS}/last-solution.png` });
  await page.keyboard.press("Control+z");
  await expect(mark).toBeHidden();
  // A number beyond the end of a slider keeps zero in its middle.
  await set(page, "force-x", "-90");
  const moved = (await track.locator(".zero").boundingBox())!;
  expect(Math.abs(moved.x - zero.x)).toBeLessThan(1.5);
});

test("the view is of all sides, fitted to the shape that is shown, in perspective or not", async ({ page, viewer }) => {
  void viewer;
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const sideways = await place(page);
  for (const side of ["Front", "Side", "Top", "Isometric"]) {
    await page.getByRole("button", { name: side, exact: true }).click();
    // The tip is within the view, not at its edge.
    await expect.poll(async () => {
      const [[x, y], { width, height }] = [await place(page), await size(page)];
      return Math.abs(x - width / 2) < 0.47 * width && Math.abs(y - height / 2) < 0.47 * height;
    }, { message: side }).toBe(true);
    await page.screenshot({ path: `${ARTEFACTS}/side-${side.toLowerCase()}.png` });
  }
  await expect.poll(async () => Math.hypot(...(await place(page)).map((c, k) => c - sideways[k]!))).toBeLessThan(2);
  // From the front x goes to the right: the tip is at as many pixels as the scale bar says.
  await page.getByRole("button", { name: "Front", exact: true }).click();
  await page.getByRole("button", { name: "Orthographic" }).click();
  await expect(page.getByRole("button", { name: "Orthographic" })).toHaveAttribute("aria-pressed", "true");
  const [x, , z] = await tip(page, "cosserat");
  const before = await place(page);
  await set(page, "cable-0", "0");
  await expect.poll(async () => near(await tip(page, "cosserat"), [x!, 0, z!], 1e-3)).toBe(false);
  const [there, , up] = await tip(page, "cosserat");
  const bar = page.locator("#bar");
  const metres = Number((await bar.textContent())!.replace(" mm", "")) / 1e3;
  const pixels = (await bar.boundingBox())!.width / metres;
  await expect.poll(async () => Math.abs((await place(page))[0] - before[0] - pixels * (there! - x!))).toBeLessThan(3);
  await expect.poll(async () => Math.abs((await place(page))[1] - before[1] + pixels * (up! - z!))).toBeLessThan(3);
  // The address has it all, a moment after the last change.
  await page.waitForTimeout(500);
  expect(page.url()).toContain("view=");
  const now = await place(page);
  await page.reload();
  await expect(page.getByRole("button", { name: "Orthographic" })).toHaveAttribute("aria-pressed", "true");
  await expect.poll(async () => Math.hypot(...(await place(page)).map((c, k) => c - now[k]!))).toBeLessThan(2);
  // By keys alone.
  await page.locator("#canvas").focus();
  await page.keyboard.press("5");
  await expect(page.getByRole("button", { name: "Orthographic" })).toHaveAttribute("aria-pressed", "false");
  for (const key of ["3", "4", "1"]) {
    const was = await place(page);
    await page.keyboard.press(key);
    await expect.poll(async () => Math.hypot(...(await place(page)).map((c, k) => c - was[k]!)), { message: key }).toBeGreaterThan(3);
  }
});

test("an axis in the corner is pressed to look along it", async ({ page, viewer }) => {
  void viewer;
  await page.getByRole("button", { name: "Front", exact: true }).click();
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const { x, y, width } = (await page.locator("#canvas").boundingBox())!;
  const was = await place(page);
  // From the front z is at the upper end: from above the robot is seen end-on, its tip beside its base.
  await page.mouse.click(x + width + 8 - 64, y + 36 + 64 - 32);
  await expect.poll(async () => (await place(page))[1] - was[1]).toBeGreaterThan(100);
});

test("bodies are cut open, and whole again", async ({ page, viewer }) => {
  void viewer;
  const drawn = async (): Promise<string> => page.locator("#canvas").evaluate((canvas) => (canvas as HTMLCanvasElement).toDataURL());
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  await expect(page.locator("#cut-at")).toBeHidden();
  await page.getByLabel("Section cut", { exact: true }).selectOption("y");
  const place = page.locator("#cut-at");
  await expect(place).toBeVisible();
  await page.waitForTimeout(600);
  const half = await drawn();
  await page.screenshot({ path: `${ARTEFACTS}/cut.png` });
  await place.focus();
  for (let k = 0; k < 3; k++) await place.press("PageUp");
  await expect.poll(drawn).not.toBe(half);
  await page.getByLabel("Section cut", { exact: true }).selectOption("");
  await expect(place).toBeHidden();
});

test("help is there by button and key, with what numbers mean", async ({ page, viewer }) => {
  void viewer;
  await page.locator("#canvas").focus();
  await page.keyboard.press("?");
  const help = page.getByRole("dialog", { name: "Help" });
  await expect(help).toBeVisible();
  await expect(help).toContainText("least eigenvalue of the tangent stiffness");
  await page.screenshot({ path: `${ARTEFACTS}/help.png` });
  await page.keyboard.press("Escape");
  await expect(help).toBeHidden();
  await page.getByRole("button", { name: "Help" }).click();
  await help.getByRole("button", { name: "Close" }).click();
  await expect(help).toBeHidden();
  // Each number says what it is.
  const silent = await page.locator("#answers dt, #answers dd, #answers thead th, #controls .quantity").evaluateAll((all) =>
    all.filter((item) => (item as HTMLElement).title === "").map((item) => item.textContent),
  );
  expect(silent).toEqual([]);
});

test("the robot stays in sight on a narrow screen while the rest goes by", async ({ page, viewer }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  const seen = async (): Promise<boolean> => {
    const box = (await page.locator("#canvas").boundingBox())!;
    return box.y >= 0 && box.y + box.height <= 844 && box.height > 200;
  };
  await expect.poll(seen).toBe(true);
  await page.locator('input[type="number"][data-name="gravity-z"]').scrollIntoViewIfNeeded();
  await expect.poll(seen).toBe(true);
  await page.locator("#answers").scrollIntoViewIfNeeded();
  await expect.poll(seen).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/narrow-scrolled.png` });
  await set(page, "cable-3", "12.5");
  const expected = tipBySolve(viewer.file, (text) => text.replace("8 N", "12.5 N"));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, 1e-6)).toBe(true);
});
