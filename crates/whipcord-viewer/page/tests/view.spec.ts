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
  expect(page.url()).toContain("force=");
  await page.screenshot({ path: `${ARTEFACTS}/dragged.png` });
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), before, SAME)).toBe(true);
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
  const force = new URL(page.url()).hash.match(/force=([^&]*)/)?.[1]?.split(",") ?? [];
  const given = `tip_force = [${force.map((f) => `"${f} N"`).join(", ")}]\n`;
  const expected = tipBySolve(viewer.file, (text) => text + given);
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, SAME)).toBe(true);
});

test("a variant of a model is chosen", async ({ page, viewer }) => {
  void viewer;
  await set(page, "gravity-z", "0");
  await page.getByLabel("four-bar-strain-energy").check();
  await expect(page.locator('.answer[data-model="four-bar-strain-energy"]')).toHaveAttribute("data-status", "solved");
});

test("colours stand for what they say", async ({ page, viewer }) => {
  void viewer;
  for (const [colouring, legend] of [["tension", "tension in N"], ["curvature", "curvature in 1/m"], ["strain", "stretch in %"]] as const) {
    await page.getByLabel("Colour by").selectOption(colouring);
    await expect(page.locator("#legend")).toContainText(legend);
    await page.screenshot({ path: `${ARTEFACTS}/${colouring}.png` });
  }
  await page.getByLabel("Colour by").selectOption("model");
  await expect(page.locator("#legend")).toBeHidden();
});

test("a cable is changed from tension to length, and the compliance of the tip is shown", async ({ page, viewer }) => {
  void viewer;
  await page.getByRole("button", { name: "Cable upper-1" }).click();
  await expect(page.locator('input[type="number"][data-name="cable-0"]')).toHaveAttribute("aria-label", /millimetres/);
  await set(page, "cable-0", "4");
  const row = page.locator('.answer[data-model="cosserat"] tbody tr').first();
  await expect(row.locator("td").last()).toHaveText("4.000");
  await page.getByLabel("Compliance of the tip").check();
  await expect(page.locator('.answer[data-model="cosserat"] dl')).toContainText("mm/N");
  await page.screenshot({ path: `${ARTEFACTS}/compliance.png` });
});

test.describe("among obstacles", () => {
  test.use({ example: "contact/among-bodies.toml" });

  test("the robot touches them, and what knows no contact says so", async ({ page, viewer }) => {
    void viewer;
    await page.getByLabel("Colour by").selectOption("contact");
    await expect(page.locator('.answer[data-model="cosserat"] dl')).toContainText("touches at");
    await page.screenshot({ path: `${ARTEFACTS}/obstacles.png` });
  });
});
