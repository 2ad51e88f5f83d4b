import type { CDPSession, Locator, Page } from "@playwright/test";

import { expect, test } from "./viewer";

/** How long is measured, in s: `LATENCY_SECONDS=20 npx playwright test latency` on a machine that does nothing else. */
const SECONDS = Number(process.env["LATENCY_SECONDS"] ?? 2);

/** Of what the page notes: when what caused each request happened, and how long each picture took. */
interface Noted {
  caused: number;
  sent: Map<number, number>;
  times: number[];
}

/** Notes when the pointer or a key caused a request, and when the display had the picture that shows its answer. */
async function note(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const noted: Noted = { caused: 0, sent: new Map(), times: [] };
    Object.assign(window, { noted });
    // When the device had it, and not when the page came to hear it.
    for (const kind of ["pointermove", "keydown"]) window.addEventListener(kind, ({ timeStamp }) => void (noted.caused = timeStamp), { capture: true });
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (this: WebSocket, text: string): void {
      const { type, id } = JSON.parse(text) as { type: string; id: number };
      if (type === "solve") noted.sent.set(id, noted.caused);
      send.call(this, text);
    };
    // The browser says when it has presented a word that was not there before: one is added in the moment that the answer is drawn, and
    // is presented with it.
    new PerformanceObserver((list) => {
      for (const entry of list.getEntries() as (PerformanceEntry & { identifier: string; renderTime: number })[]) {
        const since = noted.sent.get(Number(entry.identifier));
        if (since !== undefined) noted.times.push(entry.renderTime - since);
        document.querySelector(`[elementtiming="${entry.identifier}"]`)?.remove();
      }
    }).observe({ type: "element", buffered: true });
    window.addEventListener("load", () => {
      const [view, space] = [document.getElementById("view")!, document.getElementById("space")!];
      new MutationObserver(() => {
        const word = document.createElement("p");
        word.setAttribute("elementtiming", view.dataset["frame"]!);
        word.textContent = "shown";
        word.style.cssText = "position: absolute; right: 0; bottom: 0; margin: 0; font-size: 8px; contain: strict; width: 3em; height: 1em";
        space.append(word);
      }).observe(view, { attributeFilter: ["data-frame"] });
    });
  });
}

/** Holds the thumb of a slider and moves it to and fro, with as many events as a mouse sends. */
async function drag(page: Page, cdp: CDPSession, slider: Locator): Promise<void> {
  const { x, y, width, height } = (await slider.boundingBox())!;
  const value = await slider.evaluate((input: HTMLInputElement) => (Number(input.value) - Number(input.min)) / (Number(input.max) - Number(input.min)));
  const thumb = { x: x + 8 + (width - 16) * value, y: y + height / 2 };
  await page.mouse.move(thumb.x, thumb.y);
  await page.mouse.down();
  const begun = Date.now();
  while (Date.now() - begun < 1e3 * SECONDS) {
    const at = x + width * (0.4 - 0.3 * Math.cos((Date.now() - begun) / 400));
    void cdp.send("Input.dispatchMouseEvent", { type: "mouseMoved", x: at, y: thumb.y, button: "left", buttons: 1 });
    await new Promise((done) => setTimeout(done, 8));
  }
  await page.mouse.up();
}

/** Presses keys at a slider now and then. */
async function press(page: Page, slider: Locator): Promise<void> {
  await slider.focus();
  const begun = Date.now();
  for (let k = 0; Date.now() - begun < 1e3 * SECONDS; k++) {
    await page.keyboard.press(k % 8 < 4 ? "ArrowRight" : "ArrowLeft");
    await page.waitForTimeout(120 + 30 * Math.random());
  }
}

for (const example of ["two-segment-arm.toml", "contact/among-bodies.toml"]) {
  test.describe(example, () => {
    test.use({ example });

    test("says how long it takes from a slider to its picture", async ({ page, viewer }) => {
      void viewer;
      await note(page);
      await page.reload();
      await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
      await page.waitForTimeout(1000);
      const cdp = await page.context().newCDPSession(page);
      const slider = page.locator('input[type="range"][data-name^="cable-"]').first();
      for (const dragged of [false, true]) {
        await page.evaluate(() => void ((window as unknown as { noted: Noted }).noted.times = []));
        if (dragged) await drag(page, cdp, slider);
        else await press(page, slider);
        await page.waitForTimeout(500);
        const times = (await page.evaluate(() => (window as unknown as { noted: Noted }).noted.times)).sort((a, b) => a - b);
        const [median, most] = [times[times.length >> 1]!, times[Math.floor(0.9 * times.length)]!];
        console.log(`${example}, ${dragged ? "dragged" : "one change at a time"}: ${median.toFixed(0)} ms at the median of ${times.length} pictures, ${most.toFixed(0)} ms for 9 of 10`);
        expect(times.length).toBeGreaterThan(2);
      }
    });
  });
}
