import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";

import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, near, test, tip, tipBySolve, WHIPCORD } from "./viewer";

test.use({ example: "table1/case-3.toml" });

const HOLES = /holes = \[[^\]]*\]/;
const SAME = 1e-6;

async function list(page: Page): Promise<string> {
  return (await page.locator("#hole-list").textContent()) ?? "";
}

test("holes are chosen by clicks on disks, by numbers, and undone", async ({ page, viewer }) => {
  const before = await tip(page, "cosserat");
  const own = await list(page);
  expect(own).toBe("holes = [1, 2, 3, 4, 4, 4, 4, 3, 2, 1]");
  await page.getByLabel("Choose by clicks on the disks").check();
  // From above each disk shows its holes; the last one is in front.
  await page.getByRole("button", { name: "Top" }).click();
  const canvas = page.locator("#canvas");
  const box = (await canvas.boundingBox())!;
  const handle = JSON.parse((await canvas.getAttribute("data-handle"))!) as [number, number];
  // Around the tip there are holes of the last disk: one of the clicks is on one.
  let chosen = own;
  for (const radius of [12, 20, 30, 42, 56]) {
    for (let k = 0; k < 12 && chosen === own; k++) {
      const angle = (2 * Math.PI * k) / 12;
      await page.mouse.click(box.x + handle[0] + radius * Math.cos(angle), box.y + handle[1] + radius * Math.sin(angle));
      chosen = await list(page);
    }
  }
  expect(chosen).not.toBe(own);
  await page.screenshot({ path: `${ARTEFACTS}/holes.png` });
  await expect.poll(async () => near(await tip(page, "cosserat"), tipBySolve(viewer.file, (text) => text.replace(HOLES, chosen)), SAME)).toBe(true);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), before, SAME)).toBe(true);
  expect(await list(page)).toBe(own);
  await page.keyboard.press("Control+Shift+z");
  await expect.poll(() => list(page)).toBe(chosen);
  await page.keyboard.press("Control+z");
  // By the keyboard: a hole further on the fifth disk.
  await page.locator("#hole-5").focus();
  await page.keyboard.press("ArrowUp");
  await expect.poll(() => list(page)).toBe("holes = [1, 2, 3, 4, 5, 4, 4, 3, 2, 1]");
  const expected = tipBySolve(viewer.file, (text) => text.replace(HOLES, "holes = [1, 2, 3, 4, 5, 4, 4, 3, 2, 1]"));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
  // The address has them, once they rest.
  await expect(page).toHaveURL(/holes=1-2-3-4-5-4-4-3-2-1/);
  await page.reload();
  await expect.poll(() => list(page)).toBe("holes = [1, 2, 3, 4, 5, 4, 4, 3, 2, 1]");
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("a sketched shape is a target for holes and a table", async ({ page, viewer }) => {
  const plane = page.locator("#sketch-plane");
  await plane.scrollIntoViewIfNeeded();
  const box = (await plane.boundingBox())!;
  const scale = box.width / (2.2 * 0.18);
  const at = (u: number, z: number): [number, number] => [box.x + box.width / 2 + scale * u, box.y + scale * (1.15 * 0.18 - z)];
  await expect(page.getByRole("button", { name: "Find holes" })).toBeDisabled();
  // An arc by a right angle.
  const radius = 0.18 / (Math.PI / 2);
  await page.mouse.move(...at(0, 0));
  await page.mouse.down();
  for (let k = 1; k <= 60; k++) {
    const angle = ((Math.PI / 2) * k) / 60;
    await page.mouse.move(...at(radius * (1 - Math.cos(angle)), radius * Math.sin(angle)));
  }
  await page.mouse.up();
  await expect(page.locator("#sketch-plane circle")).toHaveCount(9);
  const before = await list(page);
  await page.getByRole("button", { name: "Find holes" }).click();
  await expect(page.locator("#sketch-status")).toContainText("no other list of holes comes nearer");
  await expect.poll(() => list(page)).not.toBe(before);
  const found = await list(page);
  await page.screenshot({ path: `${ARTEFACTS}/sketch.png` });
  // The table is what the command reads, and gives the same holes.
  const downloading = page.waitForEvent("download");
  await page.getByRole("button", { name: "Download CSV" }).click();
  const file = await (await downloading).path();
  const text = readFileSync(file, "utf8");
  expect(text.split("\n")).toHaveLength(11);
  const csv = `${viewer.file}.csv`;
  writeFileSync(csv, text);
  const vary = ["--vary", "cables[0].holes", "--vary", "cables[0].tension"];
  const designed = spawnSync(WHIPCORD, ["design", viewer.file, "--target", csv, ...vary, "--json"], { encoding: "utf8" });
  expect(designed.status, designed.stderr).toBe(0);
  const { cables, error } = JSON.parse(designed.stdout) as { cables: { holes: number[] }[]; error: number };
  expect(found).toBe(`holes = [${cables[0]!.holes.join(", ")}]`);
  expect(error).toBeLessThan(0.01);
  // Undo takes holes and tension back, and then the sketch.
  await page.keyboard.press("Control+z");
  await expect.poll(() => list(page)).toBe(before);
  await page.keyboard.press("Control+z");
  await expect(page.getByRole("button", { name: "Find holes" })).toBeDisabled();
  // By the keyboard alone: a point of the shape moves, and is a sketch.
  await page.locator("#sketch-disk-10").focus();
  await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("ArrowDown");
  await expect(page.locator("#sketch-disk-10")).toHaveAttribute("aria-label", /: 5 mm across, 179 mm along/);
  await expect(page.getByRole("button", { name: "Find holes" })).toBeEnabled();
  await page.getByRole("button", { name: "Clear" }).click();
  await expect(page.getByRole("button", { name: "Find holes" })).toBeDisabled();
});
