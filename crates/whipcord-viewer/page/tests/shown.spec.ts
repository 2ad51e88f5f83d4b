import { type ChildProcess, spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { deflateSync } from "node:zlib";

import AxeBuilder from "@axe-core/playwright";
import { test as plain, type Page } from "@playwright/test";

import { ARTEFACTS, built, expect, near, ROOT, solve, test, tip, WHIPCORD } from "./viewer";

interface Frame {
  position: number[];
  orientation: number[];
}

/** A line of a stream: the disks of a solution. */
function line(solved: string, time: number, measured: number[][] = []): string {
  const { disks } = JSON.parse(solved) as { disks: Frame[] };
  const count = disks.length - 1;
  const shape = {
    arc_length: disks.map((_, k) => (0.3 * k) / count),
    positions: disks.map(({ position }) => position),
    orientations: disks.map(({ orientation }) => orientation),
  };
  return `${JSON.stringify({ time, shapes: [shape, null], measured })}\n`;
}

async function axe(page: Page): Promise<void> {
  const { violations } = await new AxeBuilder({ page }).analyze();
  expect(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`)).toEqual([]);
}

plain("what a program shows is followed, kept and played again, beside another robot", async ({ page }) => {
  const arm = join(ROOT, "examples/two-segment-arm.toml");
  const finger = join(ROOT, "examples/helical-finger.toml");
  const child: ChildProcess = spawn(WHIPCORD, ["view", arm, "--beside", finger, "--stream", "--no-open"], { stdio: ["pipe", "pipe", "inherit"] });
  try {
    const url = await new Promise<string>((found) => child.stdout!.once("data", (text: Buffer) => found(text.toString().trim())));
    await built(page);
    await page.goto(url);
    await expect(page.locator("#view")).toHaveAttribute("data-frame", /\d+/);
    const timeline = page.getByRole("group", { name: "Timeline" });
    await expect(timeline).toBeHidden();
    const pulled = [1, 3, 5, 7, 9].map((pull) => solve(arm, (text) => text.replace(/tension = "[^"]*"/, `tension = "${pull} N"`)));
    const tips = pulled.map((solved) => (JSON.parse(solved) as { disks: Frame[] }).disks.at(-1)!.position);
    for (const [k, solved] of pulled.entries()) {
      child.stdin!.write(line(solved, 0.1 * k, [tips[k]!]));
      // Each is shown as it comes.
      await expect.poll(async () => near(await tip(page, "cosserat"), tips[k]!, 1e-9), { message: String(k) }).toBe(true);
    }
    await expect(timeline.locator("output")).toHaveText("0.40 s, latest");
    await expect(page.locator("#measured")).toContainText("measured");
    for (const theme of ["light", "dark"] as const) {
      await page.emulateMedia({ colorScheme: theme });
      await page.screenshot({ path: `${ARTEFACTS}/stream-${theme}.png` });
    }
    await page.emulateMedia({ colorScheme: "light" });
    await axe(page);
    // Back to the second, by keys alone; what comes then is kept, and does not take the place of what one looks at.
    const scrub = page.getByLabel("Place in the course");
    await scrub.focus();
    await scrub.press("Home");
    await scrub.press("ArrowRight");
    await expect.poll(async () => near(await tip(page, "cosserat"), tips[1]!, 1e-9)).toBe(true);
    child.stdin!.write(line(pulled[0]!, 0.5));
    await expect(timeline.locator("output")).toHaveText("0.10 s, 2 of 6");
    await page.getByRole("button", { name: "Play" }).click();
    await expect(timeline.locator("output")).toHaveText("0.50 s, latest");
    await expect.poll(async () => near(await tip(page, "cosserat"), tips[0]!, 1e-9)).toBe(true);
    // Another page begins with the latest.
    const second = await page.context().newPage();
    await built(second);
    await second.goto(url);
    await expect.poll(async () => near(await tip(second, "cosserat"), tips[0]!, 1e-9)).toBe(true);
    await second.close();
    await page.getByRole("button", { name: "Live" }).click();
    await expect.poll(async () => near(await tip(page, "cosserat"), tips[0]!, 1e-9)).toBe(false);
  } finally {
    child.kill();
  }
});

/** A camera that looks along y at a robot that stands on the origin, with a distortion that is seen. */
const CAMERA = `%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 900., 0., 330., 0., 910., 250., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.25, 0.05, 0., 0., 0. ]
rvec: [ 1.5707963267948966, 0., 0. ]
tvec: [ 0., 0.1, 0.6 ]
`;

/** Where that camera sees a place, in pixels. */
function seen([x, y, z]: readonly number[]): [number, number] {
  const depth = y! + 0.6;
  const [a, b] = [x! / depth, (0.1 - z!) / depth];
  const square = a * a + b * b;
  const bent = 1 - 0.25 * square + 0.05 * square * square;
  return [330 + 900 * a * bent, 250 + 910 * b * bent];
}

/** A grey picture with green squares around these pixels, as PNG. */
function photograph(marks: readonly (readonly [number, number])[]): Buffer {
  const rows = Array.from({ length: 480 }, (_, v) => {
    const row = Buffer.alloc(1 + 640 * 3, 120);
    row[0] = 0;
    for (const [u, w] of marks) {
      if (Math.abs(v - w) > 4) continue;
      for (let c = Math.ceil(u - 4); c <= u + 4; c++) row.set([0, 255, 0], 1 + 3 * c);
    }
    return row;
  });
  const table = Array.from({ length: 256 }, (_, n) => Array.from({ length: 8 }).reduce<number>((c) => (c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1), n));
  const chunk = (kind: string, data: Buffer): Buffer => {
    const body = Buffer.concat([Buffer.from(kind), data]);
    const crc = ~body.reduce((c, byte) => table[(c ^ byte) & 255]! ^ (c >>> 8), ~0) >>> 0;
    const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    check.writeUInt32BE(crc);
    return Buffer.concat([length, body, check]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(640, 0);
  head.writeUInt32BE(480, 4);
  head.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.concat(rows))), chunk("IEND", Buffer.alloc(0))]);
}

test.describe("a camera", () => {
  test.use({ example: "table1/case-3.toml" });

  test("of the file is looked through, with its photograph behind the robot and the errors of what it saw", async ({ page, viewer }) => {
    const disks = (JSON.parse(solve(viewer.file, (text) => text)) as { disks: Frame[] }).disks.map(({ position }) => position);
    const folder = dirname(viewer.file);
    writeFileSync(join(folder, "left.yml"), CAMERA);
    const pixels = disks.map(seen);
    // The tip was seen 9 pixels beside where the model has it.
    const rows = pixels.map(([u, v], k) => `${k + 1},${k + 1 === disks.length ? u + 9 : u},${v}`);
    writeFileSync(join(folder, "seen.csv"), `disk,u,v\n${rows.join("\n")}\n`);
    viewer.edit((text) => text.replace("[reference]", '[measured]\ntable = "seen.csv"\n[[measured.cameras]]\nname = "left"\nfile = "left.yml"\n[reference]'));
    const depth = disks.at(-1)![1]! + 0.6;
    // On the line of sight, which is slightly oblique and stretched by the distortion.
    await expect(page.locator("#measured")).toContainText(`${disks.length} markers`);
    const words = await page.locator("#measured").textContent();
    const most = Number(/([\d.]+) mm at most/.exec(words ?? "")?.[1]);
    expect(most).toBeGreaterThan(0.9 * 1e3 * ((9 * depth) / 900));
    expect(most).toBeLessThan(1.15 * 1e3 * ((9 * depth) / 900));

    await page.getByLabel("Calibrated camera").selectOption("Camera left");
    const choosing = page.waitForEvent("filechooser");
    await page.getByRole("button", { name: "Photograph…" }).click();
    await (await choosing).setFiles({ name: "left.png", mimeType: "image/png", buffer: photograph(pixels) });
    await page.waitForTimeout(600);
    await page.screenshot({ path: `${ARTEFACTS}/camera.png` });
    await axe(page);
    // The ring at the tip lies where a lens without distortion sees it, in a view that has all of the picture in its middle.
    const box = (await page.locator("#canvas").boundingBox())!;
    const ratio = Math.min(box.width / 640, box.height / 480);
    const ideal = ([x, y, z]: readonly number[]): [number, number] => {
      const pixel = [330 + (900 * x!) / (y! + 0.6), 250 + (910 * (0.1 - z!)) / (y! + 0.6)] as const;
      return [(box.width - 640 * ratio) / 2 + ratio * (pixel[0] + 0.5), (box.height - 480 * ratio) / 2 + ratio * (pixel[1] + 0.5)];
    };
    const handle = JSON.parse((await page.locator("#canvas").getAttribute("data-handle"))!) as [number, number];
    const tipAt = ideal(disks.at(-1)!);
    expect(Math.hypot(handle[0] - tipAt[0], handle[1] - tipAt[1])).toBeLessThan(0.1);
    // And the green square of the base is drawn there: the distortion has been taken out of the photograph.
    const found = await page.evaluate(([x, y]) => {
      const canvas = document.getElementById("canvas") as HTMLCanvasElement;
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [canvas.clientWidth, canvas.clientHeight];
      const context = copy.getContext("2d")!;
      context.drawImage(canvas, 0, 0, copy.width, copy.height);
      let [count, least, most, low, high] = [0, Infinity, -Infinity, Infinity, -Infinity];
      const [left, top, size] = [Math.round(x) - 16, Math.round(y) - 16, 32];
      const { data } = context.getImageData(left, top, size, size);
      for (let k = 0; k < size * size; k++) {
        if (data[4 * k + 1]! < 200 || data[4 * k]! > 90 || data[4 * k + 2]! > 90) continue;
        count++;
        const [u, v] = [left + (k % size) + 0.5, top + Math.floor(k / size) + 0.5];
        [least, most, low, high] = [Math.min(least, u), Math.max(most, u), Math.min(low, v), Math.max(high, v)];
      }
      return [count, (least + most) / 2 - x, (low + high) / 2 - y] as const;
    }, ideal(disks[0]!));
    expect(found[0]).toBeGreaterThan(8);
    expect(Math.hypot(found[1], found[2])).toBeLessThan(2);
    // Another direction of view leaves the camera.
    await page.getByRole("button", { name: "Isometric" }).click();
    await expect(page.getByLabel("Calibrated camera")).toHaveValue("");
    await expect(page.getByRole("button", { name: "Photograph…" })).toBeHidden();
  });
});

test.describe("rows that were measured", () => {
  test.use({ example: "motor-log/arm.toml" });

  test("are played with their markers and errors", async ({ page, viewer }) => {
    void viewer;
    const timeline = page.getByRole("group", { name: "Timeline" });
    await expect(page.locator("#measured")).toContainText("mm RMS");
    const last = await page.locator("#measured").textContent();
    const scrub = page.getByLabel("Place in the course");
    await scrub.focus();
    await scrub.press("Home");
    await scrub.press("ArrowRight");
    await expect(timeline.locator("output")).toHaveText(/^step 2 of \d+$/, { timeout: 60_000 });
    await expect(page.locator("#measured")).not.toHaveText(last!);
    // It moves far between rows, and the view makes room for it: nothing crosses its upper edge.
    await page.waitForTimeout(400);
    const colours = await page.evaluate(() => {
      const canvas = document.getElementById("canvas") as HTMLCanvasElement;
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [canvas.width, 3];
      const context = copy.getContext("2d")!;
      context.drawImage(canvas, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, 3);
      return new Set(Array.from({ length: data.length / 4 }, (_, k) => data.slice(4 * k, 4 * k + 3).join())).size;
    });
    expect(colours).toBe(1);
    await page.screenshot({ path: `${ARTEFACTS}/rows.png` });
  });
});
