import { expect, test } from "./viewer";

/** How long is measured, in s: `LATENCY_SECONDS=20 npx playwright test latency` on a machine that does nothing else. */
const SECONDS = Number(process.env["LATENCY_SECONDS"] ?? 2);

for (const example of ["two-segment-arm.toml", "contact/among-bodies.toml"]) {
  test.describe(example, () => {
    test.use({ example });

    test("says how long it takes from a slider to its picture", async ({ page, viewer }) => {
      void viewer;
      // When each request was caused.
      await page.addInitScript(() => {
        const counted = window as unknown as { sent: Map<number, number>; moved: number };
        counted.sent = new Map();
        const own = WebSocket.prototype.send;
        WebSocket.prototype.send = function (this: WebSocket, text: string): void {
          const { type, id } = JSON.parse(text) as { type: string; id: number };
          if (type === "solve") counted.sent.set(id, counted.moved);
          own.call(this, text);
        };
      });
      await page.reload();
      await expect(page.locator("#canvas")).toHaveAttribute("data-handle", /\d/);
      await page.waitForTimeout(1000);
      for (const drags of [false, true]) {
        const { median, most, count } = await page.evaluate(async ([seconds, drags]) => {
          const counted = window as unknown as { sent: Map<number, number>; moved: number };
          const sliders = [...document.querySelectorAll<HTMLInputElement>('input[type="range"][data-name^="cable-"]')];
          const view = document.getElementById("view")!;
          const context = (document.getElementById("canvas") as HTMLCanvasElement).getContext("webgl2")!;
          const channel = new MessageChannel();
          const turn = (): Promise<unknown> => new Promise((done) => {
            channel.port1.onmessage = done;
            channel.port2.postMessage(0);
          });
          const times: number[] = [];
          let last = Promise.resolve();
          const watching = new MutationObserver(() => {
            const since = counted.sent.get(Number(view.dataset["frame"]))!;
            const fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0)!;
            context.flush();
            last = last.then(async () => {
              // Until it is drawn, and then until the next picture of the display is begun.
              while (context.getSyncParameter(fence, context.SYNC_STATUS) !== context.SIGNALED) await turn();
              await new Promise(requestAnimationFrame);
              times.push(performance.now() - since);
            });
          });
          watching.observe(view, { attributeFilter: ["data-frame"] });
          const begun = performance.now();
          for (let k = 0; performance.now() - begun < 1e3 * seconds; k++) {
            counted.moved = performance.now();
            sliders.forEach((slider, i) => {
              if (!drags && i !== k % sliders.length) return;
              slider.value = String(Number(slider.max) * (0.25 + 0.2 * Math.sin(((counted.moved - begun) / 1e3) * (1 + 0.3 * i))));
              slider.dispatchEvent(new Event("input"));
            });
            // While a slider is dragged it moves with each picture of the display; else it is pressed now and then.
            if (drags) await new Promise(requestAnimationFrame);
            else await new Promise((done) => setTimeout(done, 120 + 30 * Math.random()));
          }
          await new Promise((done) => setTimeout(done, 500));
          await last;
          watching.disconnect();
          times.sort((a, b) => a - b);
          return { median: times[times.length >> 1]!, most: times[Math.floor(0.9 * times.length)]!, count: times.length };
        }, [SECONDS, drags] as const);
        console.log(`${example}, ${drags ? "dragged" : "one change at a time"}: ${median.toFixed(0)} ms at the median of ${count} pictures, ${most.toFixed(0)} ms for 9 of 10`);
        expect(count).toBeGreaterThan(2);
      }
    });
  });
}
