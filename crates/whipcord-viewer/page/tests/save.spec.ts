import { readFileSync, writeFileSync } from "node:fs";

import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, test, tip } from "./viewer";

async function saved(page: Page, button: string): Promise<{ name: string; content: Buffer }> {
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: button }).click();
  const download = await waiting;
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

test("the robot is saved as a picture, as bodies and as a film", async ({ page, viewer }) => {
  void viewer;
  await page.getByText("Save", { exact: true }).click();

  // 80 mm at 150 for each inch.
  await page.getByLabel("Width in mm").fill("80");
  await page.getByLabel("Height in mm").fill("60");
  await page.getByLabel("DPI").fill("150");
  await page.getByLabel("Transparent").check();
  const picture = await saved(page, "Picture (PNG)");
  expect(picture.name).toBe("two-segment-arm.png");
  expect(picture.content.subarray(1, 4).toString()).toBe("PNG");
  expect([picture.content.readUInt32BE(16), picture.content.readUInt32BE(20)]).toEqual([472, 354]);
  expect(picture.content.subarray(37, 41).toString()).toBe("pHYs");
  expect(picture.content.readUInt32BE(41)).toBe(5906);
  writeFileSync(`${ARTEFACTS}/picture.png`, picture.content);
  // Its corners show what is behind it, and its middle the robot; the page's own view is as before.
  const [corner, seen] = await page.evaluate(async (content) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(content), (c) => c.charCodeAt(0))]));
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
    canvas.drawImage(image, 0, 0);
    const { data } = canvas.getImageData(0, 0, image.width, image.height);
    let seen = 0;
    for (let k = 3; k < data.length; k += 4) if (data[k]! > 200) seen++;
    return [data[3], seen];
  }, picture.content.toString("base64"));
  expect(corner).toBe(0);
  expect(seen).toBeGreaterThan(2000);
  const svg = await saved(page, "Picture (SVG)");
  const words = svg.content.toString();
  writeFileSync(`${ARTEFACTS}/picture.svg`, words);
  expect(words).toContain('width="80mm" height="60mm"');
  expect(words).toMatch(/<text[^>]*>gravity 9.81 m\/s²<\/text>/);
  expect(words).toMatch(/<text[^>]*>\d+ mm<\/text>/);
  expect(words.match(/<path/g)!.length).toBeGreaterThan(20);
  // What is too large is refused with the reason.
  await page.getByLabel("DPI").fill("9000");
  await page.getByRole("button", { name: "Picture (PNG)" }).click();
  await expect(page.locator("#status")).toContainText("8192 pixels along each edge");
  await page.getByLabel("DPI").fill("150");

  const gltf = (await saved(page, "Robot (glTF)")).content;
  const described = JSON.parse(gltf.subarray(20, 20 + gltf.readUInt32LE(12)).toString()) as { nodes: { name?: string }[] };
  const names = described.nodes.map(({ name }) => name?.replaceAll("_", " "));
  for (const name of ["cosserat", "backbone", "cable upper-1", "disk 1"]) expect(names).toContain(name);
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
