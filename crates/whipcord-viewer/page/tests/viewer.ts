// A viewer of a robot file, for tests: `whipcord view` on a copy of the file.

import { type ChildProcess, spawn, spawnSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";

import { test as base, expect, type Page } from "@playwright/test";

export const ROOT = resolve(import.meta.dirname, "../../../..");
export const WHIPCORD = process.env["WHIPCORD"] ?? join(process.env["CARGO_TARGET_DIR"] ?? join(ROOT, "target"), "debug/whipcord");
export const ARTEFACTS = process.env["VIEWER_ARTEFACTS"] ?? join(ROOT, "target/viewer");

export class Viewer {
  readonly file: string;
  readonly url: string;
  /** What the console may say: by itself nothing. */
  tolerated = /(?!)/;
  #process: ChildProcess;
  readonly #folder: string;

  static async start(example: string): Promise<Viewer> {
    const folder = mkdtempSync(join(tmpdir(), "viewer-"));
    const source = join(ROOT, "examples", example);
    const file = join(folder, basename(example));
    // With the files that it names.
    cpSync(dirname(source), folder, { recursive: true });
    const { child, url } = await serve(file);
    return new Viewer(file, url, child, folder);
  }

  private constructor(file: string, url: string, child: ChildProcess, folder: string) {
    [this.file, this.url, this.#process, this.#folder] = [file, url, child, folder];
  }

  /** Ends the server. */
  async end(): Promise<void> {
    const ended = new Promise((done) => this.#process.once("exit", done));
    this.#process.kill();
    await ended;
  }

  /** Starts another at the same address. */
  async again(): Promise<void> {
    const { child } = await serve(this.file, "--port", new URL(this.url).port);
    this.#process = child;
  }

  read(): string {
    return readFileSync(this.file, "utf8");
  }

  /** Changes the file on disk. */
  edit(change: (text: string) => string): void {
    writeFileSync(this.file, change(this.read()));
  }

  stop(): void {
    this.#process.kill();
    rmSync(this.#folder, { recursive: true });
  }
}

async function serve(file: string, ...options: string[]): Promise<{ child: ChildProcess; url: string }> {
  const child = spawn(WHIPCORD, ["view", file, "--no-open", ...options], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise<string>((found, failed) => {
    child.stdout.once("data", (text: Buffer) => found(text.toString().trim()));
    child.once("error", failed);
    child.once("exit", (status) => failed(new Error(`whipcord view ended with ${status}`)));
  });
  child.removeAllListeners("exit");
  return { child, url };
}

/** The tip of a robot in m as `whipcord solve` has it: that of the file, with other text in it. */
export function tipBySolve(file: string, change: (text: string) => string, ...options: string[]): number[] {
  const answer = JSON.parse(solve(file, change, ...options)) as { disks: { position: number[] }[] };
  return answer.disks.at(-1)!.position;
}

/** What `whipcord solve --json` prints. */
export function solve(file: string, change: (text: string) => string, ...options: string[]): string {
  const folder = mkdtempSync(join(tmpdir(), "solve-"));
  const copy = join(folder, basename(file));
  cpSync(dirname(file), folder, { recursive: true });
  writeFileSync(copy, change(readFileSync(file, "utf8")));
  const solved = spawnSync(WHIPCORD, ["solve", copy, "--json", ...options], { encoding: "utf8" });
  rmSync(folder, { recursive: true });
  expect(solved.status, solved.stderr).toBe(0);
  return solved.stdout;
}

/** The tip in m that the page shows for a model. */
export async function tip(page: Page, model: string): Promise<number[]> {
  const text = await page.locator(`.answer[data-model="${model}"]`).getAttribute("data-tip");
  return JSON.parse(text ?? "[]") as number[];
}

export async function set(page: Page, name: string, value: string): Promise<void> {
  const box = page.locator(`input[type="number"][data-name="${name}"]`);
  await box.fill(value);
  await box.press("Enter");
}

export function near(found: readonly number[], expected: readonly number[], within: number): boolean {
  return found.length === 3 && found.every((c, i) => Math.abs(c - expected[i]!) <= within);
}

/** A page that is built anew and not yet embedded: `PAGE_BUILT=dist` has the browser take it in place of the one that is. */
export async function built(page: Page): Promise<void> {
  const folder = process.env["PAGE_BUILT"];
  if (folder === undefined) return;
  const types = { "": "text/html", "viewer.js": "text/javascript", "viewer.css": "text/css" };
  for (const [name, type] of Object.entries(types)) {
    const body = readFileSync(join(folder, name === "" ? "index.html" : name));
    await page.route((url) => url.hostname === "127.0.0.1" && url.pathname === `/${name}`, (route) => route.fulfill({ contentType: type, body }));
  }
}

/** A page that shows an example, and says nothing on its console. */
export const test = base.extend<{ example: string; viewer: Viewer }>({
  example: ["two-segment-arm.toml", { option: true }],
  viewer: async ({ example, page }, use) => {
    const viewer = await Viewer.start(example);
    const complaints: string[] = [];
    page.on("console", (message) => {
      if (message.type() === "error") complaints.push(message.text());
    });
    page.on("pageerror", (error) => complaints.push(String(error)));
    await built(page);
    await page.goto(viewer.url);
    await expect(page.locator("#view")).toHaveAttribute("data-frame", /\d+/);
    await use(viewer);
    viewer.stop();
    expect(complaints.filter((complaint) => !viewer.tolerated.test(complaint))).toEqual([]);
  },
});

export { expect };
