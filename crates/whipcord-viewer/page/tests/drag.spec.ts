import type { Page } from "@playwright/test";

import { ARTEFACTS, expect, near, set, test, tip, tipBySolve, type Viewer } from "./viewer";

type Place = [number, number];

async function places(page: Page): Promise<{ handle: Place; spring: Place | undefined; rests: boolean }> {
  const data = await page.locator("#canvas").evaluate((canvas) => ({ ...(canvas as HTMLElement).dataset }));
  const place = (text: string | undefined): Place | undefined => (text ? (JSON.parse(text) as Place) : undefined);
  return { handle: place(data["handle"]) ?? [NaN, NaN], spring: place(data["spring"]), rests: data["rests"] === "true" };
}

/** Seen from the front in parallel: a pixel is a length. */
async function fromFront(page: Page): Promise<number> {
  await page.getByRole("button", { name: "Front", exact: true }).click();
  await page.getByRole("button", { name: "Orthographic" }).click();
  await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
  // The picture comes after the numbers.
  await page.waitForTimeout(500);
  const bar = page.locator("#bar");
  return Number((await bar.textContent())!.replace(" mm", "")) / 1e3 / (await bar.boundingBox())!.width;
}

/** Takes hold of a place of the view, goes by so many pixels, and looks at what is there once it rests. */
async function pull(page: Page, from: Place, by: Place, atRest: (pointer: Place) => Promise<void>): Promise<void> {
  const box = (await page.locator("#canvas").boundingBox())!;
  await page.mouse.move(box.x + from[0], box.y + from[1]);
  await page.mouse.down();
  await page.mouse.move(box.x + from[0] + by[0], box.y + from[1] + by[1], { steps: 10 });
  await expect.poll(async () => (await places(page)).rests).toBe(true);
  await atRest([from[0] + by[0], from[1] + by[1]]);
  await page.mouse.up();
}

/** The force in N that the address has. */
function force(page: Page, key: string): number[] {
  const words = new URL(page.url()).hash.match(new RegExp(`${key}=([^&]*)`))?.[1]?.split(",") ?? [];
  return words.map(Number);
}

test("a spring pulls at the tip: its end stays under the pointer, and its force is that of its length", async ({ page, viewer }) => {
  const metres = await fromFront(page);
  const { handle } = await places(page);
  let stretched = 0;
  await pull(page, handle, [90, 30], async (pointer) => {
    await expect.poll(async () => {
      const { spring } = await places(page);
      return spring ? Math.hypot(spring[0] - pointer[0], spring[1] - pointer[1]) : Infinity;
    }).toBeLessThan(3);
    const now = await places(page);
    stretched = metres * Math.hypot(now.spring![0] - now.handle[0], now.spring![1] - now.handle[1]);
    await expect(page.locator("#labels .label", { hasText: /^[\d.]+ m?N$/ })).toBeVisible();
    await page.screenshot({ path: `${ARTEFACTS}/spring.png` });
  });
  await expect.poll(() => page.url()).toContain("force=");
  const given = force(page, "force");
  // All of the slider for half of the length.
  const range = Number(await page.locator('input[type="range"][data-name="force-x"]').getAttribute("max"));
  expect(Math.hypot(...given)).toBeGreaterThan(0.02 * range);
  expect(Math.abs(Math.hypot(...given) / ((2 * range * stretched) / 0.3) - 1)).toBeLessThan(0.05);
  // In the plane of the view.
  expect(Math.abs(given[1] ?? 0)).toBeLessThan(1e-3 * range);
  const expected = tipBySolve(viewer.file, (text) => `${text}tip_force = [${given.map((f) => `"${f} N"`).join(", ")}]\n`);
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, 1e-6)).toBe(true);
  await expect(page.locator("#labels .label", { hasText: "force" })).toBeVisible();
});

/** Where the middle of the backbone is seen: by what the chart of a quantity points at nothing is said, so that the place is computed. */
async function middle(page: Page, viewer: Viewer, metres: number): Promise<Place> {
  void viewer;
  const at = page.locator('input[type="number"][data-name="pull-at"]');
  const s = Number(await at.inputValue()) / 1e3;
  const { handle } = await places(page);
  const [x, , z] = await tip(page, "cosserat");
  // Nearly on the straight line from the base to the tip, as the arm is bent little: searched around it until the pointer says so.
  const box = (await page.locator("#canvas").boundingBox())!;
  const guess: Place = [handle[0] + (x! * (s / 0.3 - 1)) / metres, handle[1] + (z! * (1 - s / 0.3)) / metres];
  for (const off of [0, 4, -4, 8, -8, 12, -12, 16, -16, 24, -24, 32, -32]) {
    await page.mouse.move(box.x + guess[0] + off, box.y + guess[1]);
    const cursor = await page.locator("#canvas").evaluate((canvas) => (canvas as HTMLElement).style.cursor);
    if (cursor === "grab") return [guess[0] + off, guess[1]];
  }
  throw new Error("the backbone is nowhere near");
}

test("a spring pulls at any place of the backbone, and the force stays when it is let go", async ({ page, viewer }) => {
  const metres = await fromFront(page);
  await pull(page, await middle(page, viewer, metres), [80, 0], async () => {
    const { spring } = await places(page);
    expect(spring).toBeDefined();
    await page.screenshot({ path: `${ARTEFACTS}/pulled-inside.png` });
  });
  await expect.poll(() => page.url()).toContain("pull=");
  const [s, ...given] = force(page, "pull") as [number, number, number, number];
  expect(s).toBeGreaterThan(0.1);
  expect(s).toBeLessThan(0.2);
  expect(given[0]).toBeGreaterThan(0.01);
  const load = (values: readonly number[]): string => `\n[[loads.point]]\nat = "${1e3 * s} mm"\nforce = [${values.map((f) => `"${f} N"`).join(", ")}]\n`;
  const expected = tipBySolve(viewer.file, (text) => text + load(given));
  await expect.poll(async () => near(await tip(page, "cosserat"), expected, 1e-6)).toBe(true);
  // Its sliders have it, and by keys alone it is set and removed.
  await expect(page.locator('input[type="number"][data-name="pull-x"]')).toHaveValue(String(given[0]));
  await set(page, "pull-y", "0.2");
  const other = tipBySolve(viewer.file, (text) => text + load([given[0]!, 0.2, given[2]!]));
  await expect.poll(async () => near(await tip(page, "cosserat"), other, 1e-6)).toBe(true);
  await page.getByRole("button", { name: "Remove" }).press("Enter");
  const free = tipBySolve(viewer.file, (text) => text);
  await expect.poll(async () => near(await tip(page, "cosserat"), free, 1e-6)).toBe(true);
  await expect.poll(() => page.url()).not.toContain("pull=");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => near(await tip(page, "cosserat"), other, 1e-6)).toBe(true);
});

test("only the tip is taken hold of where it is to be moved", async ({ page, viewer }) => {
  const metres = await fromFront(page);
  const place = await middle(page, viewer, metres);
  await page.getByLabel("Move the tip").check();
  const box = (await page.locator("#canvas").boundingBox())!;
  await page.mouse.move(box.x + place[0] + 1, box.y + place[1]);
  await expect.poll(() => page.locator("#canvas").evaluate((canvas) => (canvas as HTMLElement).style.cursor)).toBe("");
  const { handle } = await places(page);
  await page.mouse.move(box.x + handle[0], box.y + handle[1]);
  await expect.poll(() => page.locator("#canvas").evaluate((canvas) => (canvas as HTMLElement).style.cursor)).toBe("grab");
});

test("loads of the file are drawn with their values", async ({ page, viewer }) => {
  viewer.edit((text) => `${text}
tip_moment = ["0", "20 mN*m", "0"]
[[loads.point]]
at = "100 mm"
force = ["0 N", "0.3 N", "0 N"]
[[loads.distributed]]
force = ["0 N/m", "0 N/m", "-0.5 N/m"]
[[loads.mass]]
at = "200 mm"
mass = "15 g"
`);
  const labels = page.locator("#labels .label");
  for (const words of ["force 0.3 N", "moment 20 mN·m", "load 0.5 N/m", "mass 15 g", "gravity 9.81 m/s²"]) {
    await expect(labels.filter({ hasText: words })).toHaveCount(1);
  }
  await page.screenshot({ path: `${ARTEFACTS}/loads.png` });
});

test.describe("among obstacles", () => {
  test.use({ example: "contact/among-bodies.toml" });

  test("contact forces have their values", async ({ page, viewer }) => {
    void viewer;
    const shown = page.locator("#labels .label", { hasText: /^[\d.]+ m?N$/ });
    await expect(shown).not.toHaveCount(0);
    const total = await page.locator('.answer[data-model="cosserat"] dl').textContent();
    // One contact: the sum of all is its force.
    expect(total).toContain("1 point");
    const newtons = Number(total!.match(/1 point, ([\d.]+) N in all/)![1]);
    await expect(shown.first()).toHaveText(`${Number((1e3 * newtons).toPrecision(3))} mN`);
  });
});

test("arrows at the tip move it along an axis", async ({ page, viewer }) => {
  void viewer;
  const targets: number[][] = [];
  page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => {
    const { target } = JSON.parse(String(payload)) as { target?: number[] | null };
    if (target) targets.push(target);
  }));
  await page.reload();
  await fromFront(page);
  await page.getByLabel("Move the tip").check();
  await page.waitForTimeout(500);
  const before = await tip(page, "cosserat");
  const { handle } = await places(page);
  const box = (await page.locator("#canvas").boundingBox())!;
  const [x, y] = [box.x + handle[0], box.y + handle[1]];
  await page.screenshot({ path: `${ARTEFACTS}/gizmo.png` });
  await page.mouse.move(x, y - 42);
  await page.mouse.move(x, y - 44);
  await page.mouse.down();
  // Up and sideways: along the axis alone it follows.
  for (let k = 1; k <= 6; k++) await page.mouse.move(x + 4 * k, y - 44 + 3 * k);
  await page.mouse.up();
  await expect.poll(() => targets.length).toBeGreaterThan(0);
  for (const target of targets) {
    expect(Math.abs(target[0]! - before[0]!)).toBeLessThan(1e-6);
    expect(Math.abs(target[1]! - before[1]!)).toBeLessThan(1e-6);
  }
  expect(targets.at(-1)![2]).toBeLessThan(before[2]! - 1e-3);
});

test("the tip is moved by numbers and by arrow keys, within the limits", async ({ page, viewer }) => {
  viewer.edit((text) => `${text.replace(/^title = .*$/m, 'title = "Arm with limits"')}\n[limits]\ntension = ["0.5 N", "40 N"]\n`);
  await expect(page.locator("#title")).toHaveText("Arm with limits");
  await expect(page.locator('input[data-name="tip-x"]')).toBeHidden();
  await page.getByLabel("Move the tip").check();
  const box = page.locator('input[data-name="tip-x"]');
  await expect(box).toBeVisible();
  const before = await tip(page, "cosserat");
  const shown = Number(await box.inputValue());
  expect(Math.abs(shown - 1e3 * before[0]!)).toBeLessThan(1e-3 * Math.abs(1e3 * before[0]!) + 1e-2);
  await box.fill(String(shown - 8));
  await box.press("Enter");
  const wanted = [(shown - 8) / 1e3, before[1]!, before[2]!];
  await expect.poll(async () => near(await tip(page, "cosserat"), wanted, 2e-5)).toBe(true);
  await page.screenshot({ path: `${ARTEFACTS}/tip-by-numbers.png` });
  // An arrow key goes to the next multiple of its step.
  const step = Number(await box.getAttribute("step"));
  const next = (Math.floor(Number(await box.inputValue()) / step) + 1) * step;
  await box.press("ArrowUp");
  await expect.poll(async () => Math.abs(1e3 * (await tip(page, "cosserat"))[0]! - next)).toBeLessThan(0.02);
  // Too far: the nearest place, and what keeps it.
  await box.fill("5000");
  await box.press("Enter");
  await expect(page.locator("#limits")).toContainText("from the target, at a limit: ");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await tip(page, "cosserat"))[0]!).toBeLessThan(0.2);
});
