import { readFileSync } from "node:fs";

import type { Page } from "@playwright/test";

import { expect, test, tip } from "./viewer";

async function saved(page: Page, button: string): Promise<{ name: string; content: Buffer }> {
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: button }).click();
  const download = await waiting;
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

test("the robot is saved as a picture, as bodies and as a film", async ({ page, viewer }) => {
  void viewer;
  await page.getByText("Save", { exact: true }).click();

  const picture = await saved(page, "Picture (PNG)");
  expect(picture.name).toBe("two-segment-arm.png");
  expect(picture.content.subarray(1, 4).toString()).toBe("PNG");
  const width = await page.locator("#canvas").evaluate((canvas) => (canvas as HTMLCanvasElement).width);
  expect(picture.content.readUInt32BE(16)).toBe(width);

  const gltf = (await saved(page, "Robot (glTF)")).content;
  expect(gltf.subarray(0, 4).toString()).toBe("glTF");
  expect(gltf.readUInt32LE(8)).toBe(gltf.length);

  // Corners of the triangles in mm: the robot ends where its tip is, but for half a disk.
  const stl = (await saved(page, "Robot (STL)")).content;
  const triangles = stl.readUInt32LE(80);
  expect(stl.length).toBe(84 + 50 * triangles);
  let highest = 0;
  for (let t = 0; t < triangles; t++) {
    for (let corner = 0; corner < 3; corner++) highest = Math.max(highest, stl.readFloatLE(84 + 50 * t + 12 + 12 * corner + 8));
  }
  const z = 1e3 * (await tip(page, "cosserat"))[2]!;
  expect(highest).toBeGreaterThan(z);
  expect(highest).toBeLessThan(z + 18);

  await page.getByRole("button", { name: "Record film" }).click();
  const slider = page.locator('input[type="range"][data-name="cable-0"]');
  for (let i = 0; i < 8; i++) {
    await slider.press("PageUp");
    await page.waitForTimeout(60);
  }
  const film = await saved(page, "Stop film");
  expect(film.name).toBe("two-segment-arm.webm");
  expect(film.content.readUInt32BE(0)).toBe(0x1a45dfa3);
  expect(film.content.length).toBeGreaterThan(1000);
});
