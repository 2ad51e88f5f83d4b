import { spawnSync } from "node:child_process";
import { mkdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { expect, test } from "@playwright/test";

import { ARTEFACTS, near, ROOT, set, tip, tipBySolve, WHIPCORD } from "./viewer";

test("an exported page opens from disk without a network, and its sliders work", async ({ page, context }) => {
  mkdirSync(ARTEFACTS, { recursive: true });
  const out = join(ARTEFACTS, "exported.html");
  const file = join(ROOT, "examples/three-cable-segment.toml");
  const exported = spawnSync(WHIPCORD, ["view", file, "--export", out], { encoding: "utf8" });
  expect(exported.status, exported.stderr).toBe(0);
  expect(statSync(out).size).toBeLessThanOrEqual(5_000_000);

  const complaints: string[] = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(request.url());
  });
  await context.setOffline(true);
  await page.goto(pathToFileURL(out).href);
  await expect(page.locator("#view")).toHaveAttribute("data-frame", /\d+/);
  await expect(page.locator("#note")).toContainText("solved frames");

  // As the file has it is a frame that was solved: off by what 16 bits make of strains.
  const before = await tip(page, "cosserat");
  expect(near(before, tipBySolve(file, (text) => text), 1e-5), String(before)).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/exported.png` });
  // Moments are known, from the strains of the frames.
  await expect(page.getByRole("button", { name: "Bending moment" })).toBeEnabled();

  // Between frames it is near: three cables have more than ten positions each.
  const slider = page.locator('input[type="range"][data-name="cable-0"]');
  await slider.focus();
  for (let i = 0; i < 5; i++) await slider.press("PageUp");
  const tension = await slider.inputValue();
  const solved = tipBySolve(file, (text) => text.replace(/tension = "[^"]*"/, `tension = "${tension} N"`));
  await expect.poll(async () => near(await tip(page, "cosserat"), solved, 1e-4)).toBe(true);
  expect(near(solved, before, 1e-2)).toBe(false);
  await set(page, "cable-1", "1e9");
  await expect(page.locator('input[type="number"][data-name="cable-1"]')).not.toHaveValue("1e9");
  expect(complaints).toEqual([]);
});
