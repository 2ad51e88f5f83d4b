import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";

import { ARTEFACTS, expect, near, set, solve, test, tip, WHIPCORD } from "./viewer";

test.describe("steps", () => {
  test.use({ example: "hysteresis-loop.toml" });

  test("of a file are played, one after the other, as the library solves them", async ({ page, viewer }) => {
    const { steps } = JSON.parse(solve(viewer.file, (text) => text)) as { steps: { disks: { position: number[] }[] }[] };
    const timeline = page.getByRole("group", { name: "Timeline" });
    await expect(timeline.locator("output")).toHaveText(`step 1 of ${steps.length}`);
    const scrub = page.getByLabel("Place in the course");
    // By keys alone.
    await scrub.focus();
    await scrub.press("Home");
    for (const k of [0, 1, 2]) {
      if (k > 0) await scrub.press("ArrowRight");
      else await scrub.press("ArrowRight").then(() => scrub.press("ArrowLeft"));
      await expect.poll(async () => near(await tip(page, "cosserat"), steps[k]!.disks.at(-1)!.position, 1e-5), { message: String(k) }).toBe(true);
      await expect(timeline.locator("output")).toHaveText(`step ${k + 1} of ${steps.length}`);
    }
    // To the last one, which is what the sliders say.
    await page.getByLabel("Speed").selectOption("5");
    await page.getByRole("button", { name: "Play" }).click();
    await expect(timeline.locator("output")).toHaveText(`step ${steps.length} of ${steps.length}`);
    await expect(page.getByRole("button", { name: "Play" })).toBeVisible();
    await expect.poll(async () => near(await tip(page, "cosserat"), steps.at(-1)!.disks.at(-1)!.position, 1e-5)).toBe(true);
    await page.screenshot({ path: `${ARTEFACTS}/steps.png` });
    await page.getByRole("button", { name: "Live" }).click();
    await expect(page.getByRole("button", { name: "Live" })).toBeDisabled();
  });
});

test.describe("a motion", () => {
  test.use({ example: "released-arm.toml" });

  test("is simulated and played, in a loop and as a film, and a slider goes back to the present", async ({ page, viewer }) => {
    const simulated = spawnSync(WHIPCORD, ["simulate", viewer.file, "--json"], { encoding: "utf8", maxBuffer: 2 ** 28 });
    expect(simulated.status, simulated.stderr).toBe(0);
    const { states } = JSON.parse(simulated.stdout) as { states: { time: number; poses: { position: number[] }[] }[] };
    const present = await tip(page, "cosserat");
    await page.getByRole("button", { name: "Play" }).click();
    const timeline = page.getByRole("group", { name: "Timeline" });
    await expect(timeline).toHaveAttribute("data-known", String(states.length));
    await page.getByRole("button", { name: "Pause" }).or(page.getByRole("button", { name: "Play" })).click();
    const scrub = page.getByLabel("Place in the course");
    for (const share of [0, 0.3, 1]) {
      const k = Math.round(share * (states.length - 1));
      await scrub.fill(String(k));
      const { position } = states[k]!.poses.at(-1)!;
      await expect.poll(async () => near(await tip(page, "cosserat"), position, 1e-9), { message: String(k) }).toBe(true);
      await expect(timeline.locator("output")).toContainText(`${states[k]!.time.toFixed(2)} s of`);
    }
    // Round and round.
    await page.getByLabel("Loop").check();
    await page.getByLabel("Speed").selectOption("5");
    await page.getByRole("button", { name: "Play" }).click();
    const at = async (): Promise<number> => Number(await timeline.getAttribute("data-at"));
    await expect.poll(at).toBeLessThan(states.length - 1);
    await page.screenshot({ path: `${ARTEFACTS}/motion.png` });
    await page.getByRole("button", { name: "Pause" }).click();
    // A film of all of it, slowly enough for a slow machine.
    await page.getByLabel("Speed").selectOption("0.5");
    const waiting = page.waitForEvent("download");
    await page.getByRole("button", { name: "Film", exact: true }).click();
    const film = await waiting;
    expect(film.suggestedFilename()).toBe("released-arm.webm");
    expect(readFileSync(await film.path()).readUInt32BE(0)).toBe(0x1a45dfa3);
    await set(page, "cable-0", "0.5");
    await expect(page.getByRole("button", { name: "Live" })).toBeDisabled();
    await page.keyboard.press("Control+z");
    await expect.poll(async () => near(await tip(page, "cosserat"), present, 1e-6)).toBe(true);
  });

  test("has the loads of its time", async ({ page, viewer }) => {
    viewer.edit((text) => `${text.replace("Released arm", "Pushed arm")}\n[[motion.loads]]\nfactor = [["0 s", 0], ["1 s", 1]]\n[[motion.loads.point]]\nat = "150 mm"\nforce = ["0.2 N", "0 N", "0 N"]\n`);
    await expect(page.locator("#title")).toHaveText("Pushed arm");
    const timeline = page.getByRole("group", { name: "Timeline" });
    await page.getByRole("button", { name: "Play" }).click();
    await expect(timeline).toHaveAttribute("data-known", "201");
    await page.getByRole("button", { name: "Pause" }).or(page.getByRole("button", { name: "Play" })).click();
    const labels = page.locator("#labels .label:visible");
    for (const [row, words] of [["50", "force 0.1 N"], ["150", "force 0.2 N"]] as const) {
      await page.getByLabel("Place in the course").fill(row);
      await expect(labels.filter({ hasText: words })).toHaveCount(1);
      await expect(labels.filter({ hasText: "gravity" })).toHaveCount(1);
    }
    await page.screenshot({ path: `${ARTEFACTS}/motion-loads.png` });
    await page.getByRole("button", { name: "Live" }).click();
    await expect(labels.filter({ hasText: "force" })).toHaveCount(0);
  });

  test("is ended by other sliders, and tells why where there is none", async ({ page, viewer }) => {
    viewer.edit((text) => text.replace('title = "Released arm"', 'title = "Yielding arm"').replace('length = "300 mm"', 'length = "300 mm"\nyield_moment = "1 mN*m"'));
    await expect(page.locator("#title")).toHaveText("Yielding arm");
    await page.getByRole("button", { name: "Play" }).click();
    await expect(page.locator("#status")).toContainText("friction against bending");
    await set(page, "cable-0", "0.5");
    await expect(page.locator("#status")).toBeHidden();
  });
});

test("a file without steps and motion has no timeline", async ({ page, viewer }) => {
  void viewer;
  await expect(page.getByRole("group", { name: "Timeline" })).toHaveCount(0);
});
