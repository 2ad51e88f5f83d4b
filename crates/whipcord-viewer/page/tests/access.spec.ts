import AxeBuilder from "@axe-core/playwright";

import { ARTEFACTS, expect, test } from "./viewer";

for (const [name, width, colorScheme] of [["wide", 1400, "light"], ["wide-dark", 1400, "dark"], ["narrow", 400, "light"]] as const) {
  test(`has no faults that a machine finds: ${name}`, async ({ page, viewer }) => {
    void viewer;
    await page.setViewportSize({ width, height: 860 });
    await page.emulateMedia({ colorScheme });
    await page.getByLabel("Colour by").selectOption("tension");
    await page.getByText("Save", { exact: true }).click();
    const { violations } = await new AxeBuilder({ page }).analyze();
    expect(violations.flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.html}`))).toEqual([]);
    await page.screenshot({ path: `${ARTEFACTS}/access-${name}.png` });
    // Nothing sticks out, and no row lies on another.
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
    const overlaps = await page.evaluate(() => {
      const all = [...document.querySelectorAll("header > *, #actions > *, #looks > *, .quantity > *, .choice > *, #readout td, #readout th, #readout dt, #readout dd")];
      const boxes = all.map((item) => ({ item, box: item.getBoundingClientRect() })).filter(({ item, box }) => box.width > 0 && item.checkVisibility());
      return boxes.flatMap(({ item, box: a }, i) =>
        boxes
          .slice(i + 1)
          .filter(({ item: other, box: b }) =>
            !item.contains(other) &&
            Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
            Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1,
          )
          .map(({ item: other }) => `${item.outerHTML} on ${other.outerHTML}`),
      );
    });
    expect(overlaps).toEqual([]);
  });
}

test("every control is reached by Tab, and is seen to be", async ({ page, viewer }) => {
  void viewer;
  // Those of a menu that is shut are not reached, and of a group of radio buttons the arrow keys reach those that are not chosen.
  await expect(page.locator("#charts .plot")).toHaveCount(3);
  const { all, count } = await page.evaluate(() => {
    const controls = [...document.querySelectorAll<HTMLElement>("button:enabled, input:enabled, select, summary, #canvas, [tabindex='0']")].filter(
      (item) => !item.matches("#save button, #save input, #refused input, dialog *, [hidden], [hidden] *, input[type=radio]:not(:checked)"),
    );
    // Parts of the page are made anew meanwhile: what is one control is known by what it is.
    const named = (item: HTMLElement): string =>
      [item.tagName, item.id, item.dataset["name"], item.getAttribute("type"), item.closest<HTMLElement>("[data-chart]")?.dataset["chart"], item.dataset["cable"], item.matches("button, summary") ? item.textContent : ""].join(" ");
    (window as unknown as { named: typeof named }).named = named;
    return { all: controls.map(named), count: controls.length };
  });
  expect(new Set(all).size).toBe(count);
  const seen = new Set<string>();
  await page.locator("body").press("Tab");
  for (let i = 0; i < count + 5; i++) {
    const focused = await page.evaluate(() => {
      const item = document.activeElement as HTMLElement;
      if (item === document.body) return undefined;
      const { named } = window as unknown as { named: (item: HTMLElement) => string };
      return { key: named(item), outline: getComputedStyle(item).outlineStyle, html: item.outerHTML };
    });
    if (focused) {
      seen.add(focused.key);
      // Of a switch with two sides the side has the outline.
      if (!focused.key.includes("radio")) expect(focused.outline, focused.html).not.toBe("none");
    }
    await page.keyboard.press("Tab");
  }
  expect(all.filter((item) => !seen.has(item))).toEqual([]);
});

test("the view is turned, moved and zoomed by the keyboard", async ({ page, viewer }) => {
  void viewer;
  const canvas = page.locator("#canvas");
  const handle = async (): Promise<string | null> => canvas.getAttribute("data-handle");
  await canvas.focus();
  await expect(canvas).toHaveAttribute("data-handle", /\d/);
  await page.keyboard.press("Home");
  await page.waitForTimeout(1000);
  const start = await handle();
  for (const key of ["Shift+ArrowLeft", "ArrowUp", "+", "-", "Shift+ArrowDown"]) {
    const before = await handle();
    await page.keyboard.press(key);
    await expect.poll(handle, { message: key }).not.toBe(before);
  }
  await page.keyboard.press("Home");
  await expect.poll(handle).toBe(start);
});
