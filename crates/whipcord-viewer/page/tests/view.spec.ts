import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";

import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, near, set, solve, test, tip, tipBySolve } from "./viewer";

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

test("warnings about the file and about a shape are shown, and go with their cause", async ({ page, viewer }) => {
  await expect(page.locator(".warning, .warnings")).toHaveCount(0);
  viewer.edit((text) => text.replace('diameter = "2 mm"', 'diameter = "2 mm"\nyield_strain = "0.01 %"\nshear_correction = 0.9\nshearable = false'));
  await expect(page.locator("details.warnings summary")).toHaveText("1 warning about the file");
  await page.locator("details.warnings summary").click();
  await expect(page.locator("details.warnings li")).toContainText("has no effect: the backbone is not shearable");
  await expect(page.locator('.answer[data-model="cosserat"] .warning')).toContainText("above the yield strain of 0.01 %");
  await page.screenshot({ path: `${ARTEFACTS}/warnings.png` });
  viewer.edit((text) => text.replace(/yield_strain.*\nshear_correction.*\nshearable.*\n/, ""));
  await expect(page.locator(".warning, .warnings")).toHaveCount(0);
});

test("the file is followed as it changes, and its mistakes are shown", async ({ page, viewer }) => {
  viewer.edit((text) => text.replace('length = "300 mm"', 'length = "300 mn"'));
  await expect(page.locator("#status")).toContainText("two-segment-arm.toml:7:");
  await page.screenshot({ path: `${ARTEFACTS}/broken.png` });
  viewer.edit((text) => text.replace("300 mn", "310 mm"));
  await expect(page.locator("#status")).toBeHidden();
  const expected = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("a file with other cables is followed while the sliders move, and undo stays where it can", async ({ page, viewer }) => {
  await set(page, "cable-1", "3");
  viewer.edit((text) => text.replace('tension = "8 N"', 'tension = "7 N"'));
  const box = page.locator('input[type="number"][data-name="cable-3"]');
  await expect(box).toHaveValue("7");
  await expect(page.locator('input[type="number"][data-name="cable-1"]')).toHaveValue("3");
  await page.keyboard.press("Control+z");
  const undone = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), undone, SAME)).toBe(true);
  // The last cable goes and comes back, again and again, in the midst of what is asked for.
  const whole = viewer.read();
  const fewer = whole.slice(0, whole.lastIndexOf("[[cables]]")) + whole.slice(whole.lastIndexOf("[loads]"));
  expect(fewer.match(/\[\[cables\]\]/g)).toHaveLength(5);
  for (let k = 0; k < 6; k++) {
    viewer.edit(() => (k % 2 === 0 ? fewer : whole));
    const count = k % 2 === 0 ? 5 : 6;
    for (let moves = 0; moves < 200 && (await page.locator('input[type="range"][data-name^="cable-"]').count()) !== count; moves++) {
      await page.locator('input[type="range"][data-name="cable-0"]').press(moves % 2 === 0 ? "ArrowRight" : "ArrowLeft");
    }
    await expect(page.locator('input[type="range"][data-name^="cable-"]')).toHaveCount(count);
  }
  await page.getByRole("button", { name: "Reset" }).click();
  await expect.poll(async () => near(await tip(page, "cosserat"), undone, SAME)).toBe(true);
});

test("the server goes and comes back", async ({ page, viewer }) => {
  await set(page, "cable-1", "3");
  viewer.tolerated = /ERR_CONNECTION_REFUSED/;
  await viewer.end();
  await expect(page.locator("#status")).toContainText("No connection");
  await set(page, "cable-2", "2");
  await expect(page.locator("#waiting")).toBeHidden();
  await viewer.again();
  await expect(page.locator("#status")).toBeHidden();
  await set(page, "cable-0", "12");
  const expected = tipBySolve(viewer.file, (text) => text.replace('"14 N"', '"12 N"').replace('"1 N"', '"3 N"').replace('"1 N"', '"2 N"'));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("without a model the page says so", async ({ page, viewer }) => {
  void viewer;
  await page.getByLabel("cosserat", { exact: true }).uncheck();
  await expect(page.locator("#status")).toContainText("No model is chosen");
  await expect.poll(() => page.url()).toContain("models=");
  await page.reload();
  await expect(page.locator("#status")).toContainText("No model is chosen");
});

test("an emptied box, and one of the wrong kind, go back to what is", async ({ page, viewer }) => {
  void viewer;
  const box = page.locator('input[type="number"][data-name="cable-3"]');
  await box.fill("");
  await box.press("Tab");
  await expect(box).toHaveValue("8");
  // Long numbers are seen whole.
  await set(page, "gravity-x", "-3.92266");
  const cut = await page.evaluate(() => {
    const context = document.createElement("canvas").getContext("2d")!;
    const boxes = [...document.querySelectorAll<HTMLInputElement>('input[type="number"]')];
    return boxes.filter((box) => box.checkVisibility()).filter((box) => {
      const style = getComputedStyle(box);
      context.font = style.font;
      return context.measureText(box.value).width > box.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    }).map((box) => box.value);
  });
  expect(cut).toEqual([]);
});

test("a robot of any length is seen, also when the file makes it another", async ({ page, viewer }) => {
  const seen = async (): Promise<boolean> => {
    const [x, y] = JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[-1, -1]") as [number, number];
    const box = (await page.locator("#canvas").boundingBox())!;
    return x > 0 && y > 0 && x < box.width && y < box.height;
  };
  for (const length of ["1000 mm", "40 mm"]) {
    viewer.edit((text) => text.replace(/length = "\d+ mm"/, `length = "${length}"`).replaceAll('ends_at = "150 mm"\n', "").replace('"9.81 m/s^2"', '"0"').replace(/"\d+ N"/g, '"0 N"'));
    const expected = tipBySolve(viewer.file, (text) => text);
    await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
    await expect.poll(seen).toBe(true);
    expect(page.url()).not.toContain("view=");
    await page.reload();
    await expect.poll(seen).toBe(true);
  }
});

test("the place that one looks from is in the address", async ({ page, viewer }) => {
  void viewer;
  const canvas = page.locator("#canvas");
  await expect(canvas).toHaveAttribute("data-handle", /\d/);
  await canvas.focus();
  for (let k = 0; k < 4; k++) await page.keyboard.press("Shift+ArrowLeft");
  await expect.poll(() => page.url()).toContain("view=");
  // The picture comes after the keys.
  await page.waitForTimeout(1500);
  const seen = await canvas.getAttribute("data-handle");
  await page.reload();
  await expect(canvas).toHaveAttribute("data-handle", /\d/);
  const handle = async (): Promise<number[]> => JSON.parse((await canvas.getAttribute("data-handle")) ?? "[]") as number[];
  const [x, y] = JSON.parse(seen ?? "[]") as [number, number];
  await expect.poll(async () => Math.hypot((await handle())[0]! - x, (await handle())[1]! - y)).toBeLessThan(1);
  await canvas.focus();
  await page.keyboard.press("Home");
  await expect.poll(() => page.url()).not.toContain("view=");
});

test("the address keeps the state, and undo, redo and reset go through it", async ({ page, viewer }) => {
  await set(page, "force-x", "0.25");
  await set(page, "cable-1", "3");
  const pulled = tipBySolve(viewer.file, (text) => text.replace("tension = \"1 N\"", "tension = \"3 N\"") + 'tip_force = ["0.25 N", "0 N", "0 N"]\n');
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  await expect.poll(() => page.url()).toContain("force=0.25,,");
  await page.reload();
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  await page.getByRole("button", { name: "Reset" }).click();
  const asInFile = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), asInFile, SAME)).toBe(true);
  await expect.poll(() => new URL(page.url()).hash).toBe("");
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(async () => near(await tip(page, "cosserat"), pulled, SAME)).toBe(true);
  await page.getByRole("button", { name: "Redo" }).click();
  await expect.poll(async () => near(await tip(page, "cosserat"), asInFile, SAME)).toBe(true);
});

test("the tip is dragged", async ({ page, viewer }) => {
  void viewer;
  const before = await tip(page, "cosserat");
  // The picture comes after the numbers.
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const handle = JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[]") as [number, number];
  const box = (await page.locator("#canvas").boundingBox())!;
  await page.mouse.move(box.x + handle[0], box.y + handle[1]);
  await page.mouse.down();
  await page.mouse.move(box.x + handle[0] + 60, box.y + handle[1], { steps: 6 });
  await page.mouse.up();
  await expect.poll(async () => near(await tip(page, "cosserat"), before, 1e-3)).toBe(false);
  await expect.poll(() => page.url()).toContain("force=");
  await page.screenshot({ path: `${ARTEFACTS}/dragged.png` });
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), before, SAME)).toBe(true);
});

/** Drags the tip by so many pixels, and looks at the page before the button is released. */
async function drag(page: Page, x: number, y: number, meanwhile: () => Promise<void> = async () => {}): Promise<void> {
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const handle = JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[]") as [number, number];
  const box = (await page.locator("#canvas").boundingBox())!;
  await page.mouse.move(box.x + handle[0], box.y + handle[1]);
  await page.mouse.down();
  await page.mouse.move(box.x + handle[0] + x, box.y + handle[1] + y, { steps: 12 });
  await meanwhile();
  await page.mouse.up();
}

test("the commands bring the tip to where it is dragged, within the limits", async ({ page, viewer }) => {
  viewer.edit((text) => `${text}\n[limits]\ntension = ["0.5 N", "40 N"]\n`);
  const before = await tip(page, "cosserat");
  await page.getByLabel("Move the tip").check();
  const handle = async (): Promise<[number, number]> =>
    JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[]") as [number, number];
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const start = await handle();
  await drag(page, -40, 20, async () => {
    // The tip is where the pointer is.
    await expect.poll(async () => Math.hypot((await handle())[0] - start[0] + 40, (await handle())[1] - start[1] - 20)).toBeLessThan(2);
    await page.screenshot({ path: `${ARTEFACTS}/reach.png` });
  });
  expect(page.url()).not.toContain("force=");
  await expect.poll(() => page.url()).toContain("cables=");
  // The shape comes to be that of the commands that the sliders have, and these keep the limits.
  let moved = await tip(page, "cosserat");
  await expect
    .poll(async () => {
      const tensions = await page.locator('input[type="number"][data-name^="cable-"]').evaluateAll((boxes) => boxes.map((box) => Number((box as HTMLInputElement).value)));
      expect(tensions.length).toBe(6);
      for (const tension of tensions) expect(tension >= 0.5 && tension <= 40).toBe(true);
      moved = await tip(page, "cosserat");
      let k = 0;
      const expected = tipBySolve(viewer.file, (text) => text.replace(/^tension = "[\d.]+ N"/gm, () => `tension = "${tensions[k++]} N"`));
      expect(k).toBe(6);
      // The boxes have six digits.
      return near(moved, expected, 1e-5);
    })
    .toBe(true);
  // Far away there is a limit, which is said, and its slider is marked.
  await drag(page, -400, 0, async () => {
    await expect(page.locator("#limits")).toContainText("mm from the target, at a limit: ");
    await expect(page.locator(".quantity.limited")).not.toHaveCount(0);
    await page.screenshot({ path: `${ARTEFACTS}/reach-limits.png` });
  });
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), moved, 1e-5)).toBe(true);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), before, SAME)).toBe(true);
  await expect(page.locator(".quantity.limited")).toHaveCount(0);
});

test("where the tip can go is surveyed in the background, and is ended", async ({ page, viewer }) => {
  viewer.edit((text) => `${text.replace("9.81 m/s^2", "0")}\n[limits]\ntension = ["0 N", "16 N"]\n`);
  const limited = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), limited, SAME)).toBe(true);
  const box = page.getByLabel("Where the tip can go");
  await box.check();
  await expect(page.locator("#cloud")).toHaveText("Surveying…");
  // Sliders are answered meanwhile.
  await set(page, "cable-3", "12.5");
  const expected = tipBySolve(viewer.file, (text) => text.replace("8 N", "12.5 N"));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
  await expect(page.locator("#cloud")).toContainText("cm³", { timeout: 60_000 });
  await page.screenshot({ path: `${ARTEFACTS}/cloud.png` });
  await box.uncheck();
  await expect(page.locator("#cloud")).toBeHidden();
  // Ended at once, and asked for again.
  await box.check();
  await box.uncheck();
  await expect(page.locator("#cloud")).toBeHidden();
  await box.check();
  await expect(page.locator("#cloud")).toContainText("cm³", { timeout: 60_000 });
  await expect.poll(() => page.url()).toContain("workspace=true");
});

test("a force that turns with the tip is dragged in its frame", async ({ page, viewer }) => {
  // Pulled to one side until the tip has turned by more than a right angle: in any other frame the tip would go elsewhere.
  viewer.edit((text) => `${text.replace("14 N", "24 N")}\nfollower = true\n`);
  await expect(page.locator('[data-group="Force at the tip"]')).toContainText("in the frame of the tip");
  const free = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), free, SAME)).toBe(true);
  const handle = async (): Promise<[number, number]> =>
    JSON.parse((await page.locator("#canvas").getAttribute("data-handle")) ?? "[]") as [number, number];
  // The picture comes after the numbers: that of a new page is of this robot alone.
  await page.reload();
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  const [before, box] = [await handle(), (await page.locator("#canvas").boundingBox())!];
  await page.mouse.move(box.x + before[0], box.y + before[1]);
  await page.mouse.down();
  await page.mouse.move(box.x + before[0] + 40, box.y + before[1], { steps: 8 });
  await page.mouse.up();
  await expect.poll(async () => (await handle())[0]).toBeGreaterThan(before[0] + 4);
  await expect.poll(() => page.url()).toContain("force=");
  const force = new URL(page.url()).hash.match(/force=([^&]*)/)?.[1]?.split(",") ?? [];
  const given = `tip_force = [${force.map((f) => `"${f || 0} N"`).join(", ")}]\n`;
  const expected = tipBySolve(viewer.file, (text) => text + given);
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("a variant of a model is chosen", async ({ page, viewer }) => {
  void viewer;
  await set(page, "gravity-z", "0");
  await page.getByLabel("four-bar-strain-energy").check();
  await expect(page.locator('.answer[data-model="four-bar-strain-energy"]')).toHaveAttribute("data-status", "solved");
});

/** How many points of the view have the colour of the second cable, #8e5bd0, in light or shade: six times as much blue light as green, and red between them. */
async function violet(page: Page): Promise<number> {
  return page.locator("#canvas").evaluate((view) => {
    const canvas = view as HTMLCanvasElement;
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d")!;
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const light = (k: number): number => (data[k]! / 255) ** 2.2;
    let count = 0;
    for (let k = 0; k < data.length; k += 4) {
      if (light(k + 2) > 0.1 && light(k + 1) < 0.35 * light(k + 2) && light(k) > 0.2 * light(k + 2)) count++;
    }
    return count;
  });
}

test("colours stand for what they say", async ({ page, viewer }) => {
  void viewer;
  await expect.poll(() => violet(page)).toBeGreaterThan(20);
  for (const [colouring, legend] of [["tension", "tension in N"], ["curvature", "curvature in 1/m"], ["strain", "stretch in %"], ["moment", "bending moment in mN·m"]] as const) {
    await page.getByLabel("Colour by").selectOption(colouring);
    await expect(page.locator("#legend")).toContainText(legend);
    await page.screenshot({ path: `${ARTEFACTS}/${colouring}.png` });
  }
  await page.getByLabel("Colour by").selectOption("model");
  await expect(page.locator("#legend")).toBeHidden();
});

/** The tip once the page shows the answer to its latest request. */
async function tipOfLatest(page: Page): Promise<number[]> {
  // Requests go out and numbers are written within a few pictures of the display.
  await page.waitForTimeout(400);
  await expect(page.locator("#waiting")).toBeHidden();
  return tip(page, "cosserat");
}

test("a cable is changed from tension to length, and the compliance of the tip is shown", async ({ page, viewer }) => {
  void viewer;
  const before = await tip(page, "cosserat");
  await page.getByRole("button", { name: "Cable upper-1" }).click();
  // The robot stays where it is: rounded to six digits.
  await expect.poll(async () => page.url()).toContain("cables=s0.0058");
  expect(near(await tipOfLatest(page), before, 1e-6)).toBe(true);
  // So it does where the cable is elastic: its tension stretches it, so that more of it is drawn in.
  viewer.edit((text) => text.replace('tension = "1 N"', 'tension = "9 N"\naxial_stiffness = "2000 N"'));
  const second = page.locator('input[type="number"][data-name="cable-1"]');
  await expect(second).toHaveValue("9");
  const stretched = await tipOfLatest(page);
  await page.getByRole("button", { name: "Cable upper-2" }).click();
  await expect(second).toHaveAttribute("aria-label", /millimetres/);
  expect(near(await tipOfLatest(page), stretched, 1e-6)).toBe(true);
  // Changed at once after it was moved, it is what the answer to that makes of it.
  await page.getByRole("button", { name: "Reset" }).click();
  await set(page, "cable-3", "4");
  await page.getByRole("button", { name: "Cable lower-1" }).click();
  const four = tipBySolve(viewer.file, (text) => text.replace("8 N", "4 N"));
  await expect.poll(async () => near(await tip(page, "cosserat"), four, 2e-6)).toBe(true);
  await expect(page.locator('input[type="number"][data-name="cable-3"]')).toHaveAttribute("aria-label", /millimetres/);
  expect(near(await tipOfLatest(page), four, 2e-6)).toBe(true);
  await page.getByRole("button", { name: "Reset" }).click();
  await page.getByRole("button", { name: "Cable upper-1" }).click();
  await expect(page.locator('input[type="number"][data-name="cable-0"]')).toHaveAttribute("aria-label", /millimetres/);
  await set(page, "cable-0", "4");
  const row = page.locator('.answer[data-model="cosserat"] tbody tr').first();
  await expect(row.locator("td").last()).toHaveText("4.000");
  await page.getByLabel("Compliance of the tip").check();
  await expect(page.locator('.answer[data-model="cosserat"] dl')).toContainText("mm/N");
  await page.screenshot({ path: `${ARTEFACTS}/compliance.png` });
});

test("several models are moved together, each as the library says", async ({ page, viewer }) => {
  void viewer;
  await page.getByLabel("cosserat-disks").check();
  await page.getByLabel("pseudo-rigid-body").check();
  await set(page, "force-x", "0.3");
  const file = (model: string): number[] =>
    tipBySolve(viewer.file, (text) => `${text}tip_force = ["0.3 N", "0 N", "0 N"]\n`, "--model", model);
  for (const model of ["cosserat", "cosserat-disks", "pseudo-rigid-body"]) {
    const expected = file(model);
    await expect.poll(async () => near(await tip(page, model), expected, SAME), { message: model }).toBe(true);
  }
  await page.getByLabel("Compliance of the tip").check();
  await expect(page.locator('.answer[data-model="cosserat-disks"] dl')).toContainText("mm/N");
  await page.screenshot({ path: `${ARTEFACTS}/together.png` });
});

test.describe("among obstacles", () => {
  test.use({ example: "contact/among-bodies.toml" });

  test("the robot touches them, and a model that takes no forces says so", async ({ page, viewer }) => {
    void viewer;
    await expect(page.getByLabel("constant-curvature", { exact: true })).toBeDisabled();
    await expect(page.locator("#why-constant-curvature")).toContainText("contact forces would bend the arc unevenly");
    await page.getByLabel("cosserat-disks").check();
    await page.getByLabel("pseudo-rigid-body").check();
    await page.getByLabel("Colour by").selectOption("contact");
    for (const model of ["cosserat", "cosserat-disks", "pseudo-rigid-body"]) {
      await expect(page.locator(`.answer[data-model="${model}"] dl`)).toContainText("touches");
    }
    await expect(page.locator("#legend")).toContainText("touches nothing");
    await page.screenshot({ path: `${ARTEFACTS}/obstacles.png` });
  });
});

test.describe("of a robot that was measured", () => {
  test.use({ example: "table1/case-3.toml" });

  test("the points are in the view, and a slack cable says that it is", async ({ page, viewer }) => {
    const disks = JSON.parse(solve(viewer.file, (text) => text)).disks as { position: number[] }[];
    const rows = disks.map(({ position }, i) => [i + 1, ...position.map((c) => 1e3 * c + (i % 2))].join(","));
    writeFileSync(join(dirname(viewer.file), "seen.csv"), `disk,x,y,z\n${rows.join("\n")}\n`);
    viewer.edit((text) => text.replace("[reference]", '[measured]\ndisks = "seen.csv"\nunit = "mm"\n[reference]'));
    await expect(page.locator("#scale")).toContainText("measured on the real robot");
    await page.screenshot({ path: `${ARTEFACTS}/measured.png` });
    await page.getByRole("button", { name: "change between tension and shortening" }).click();
    await set(page, "cable-0", "-5");
    await expect(page.locator('.answer[data-model="cosserat"] tbody')).toContainText("slack");
    await page.screenshot({ path: `${ARTEFACTS}/slack.png` });
  });
});

const MOTORS = `
title = "Arm with a motor"
[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
[disks]
count = 10
[[cables]]
name = "left"
routing = { kind = "straight", angle = "0 deg", radius = "8 mm" }
[[cables]]
name = "right"
routing = { kind = "straight", angle = "180 deg", radius = "8 mm" }
[[cables]]
name = "side"
routing = { kind = "straight", angle = "90 deg", radius = "8 mm" }
tension = "1 N"
[[motors]]
name = "bend"
cables = ["left", "-right"]
spool_radius = "10 mm"
stiffness = "5 N/mm"
pretension = "4 N"
angle_limits = ["-80 deg", "80 deg"]
torque_limit = "200 N mm"
angle = "30 deg"
`;

test("a motor has a slider, and says what it holds", async ({ page, viewer }) => {
  viewer.edit(() => MOTORS);
  await expect(page.locator("h1")).toHaveText("Arm with a motor");
  // The cables of the motor follow it; the third has a slider of its own.
  await expect(page.locator('[data-group="Motors"] .quantity')).toHaveCount(1);
  await expect(page.locator('[data-group="Cables"] .quantity')).toHaveCount(1);
  await expect(page.locator('input[type="number"][data-name="motor-0"]')).toHaveValue("30");
  await set(page, "motor-0", "45");
  const expected = tipBySolve(viewer.file, (text) => text.replace("30 deg", "45 deg"));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
  const solved = JSON.parse(solve(viewer.file, (text) => text.replace("30 deg", "45 deg"))) as { motors: { torque: number; utilization: number }[] };
  const { torque, utilization } = solved.motors[0]!;
  const row = page.locator('.answer[data-model="cosserat"] tr', { has: page.getByRole("rowheader", { name: "bend", exact: true }) });
  await expect(row).toContainText(`${Number((torque * 1e3).toPrecision(3))}`);
  await expect(row).toContainText(`${Number((utilization * 100).toPrecision(3))} %`);
  // Within its limits, which its number box keeps to, and through the address and undo.
  await set(page, "motor-0", "200");
  await expect.poll(async () => page.url()).toMatch(/cables=m3\.49/);
  await expect(page.locator('.answer[data-model="cosserat"]')).toContainText("limit");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/motor.png` });
});
